//! Bodies tied together by joints, to which an impulse is given as a whole, and which move on as a whole.
//!
//! With the inverse masses `W` of the free bodies and the Jacobian `G` of the locked axes of their joints, a wrench `f`
//! changes velocities by
//!
//! `W f − W Gᵀ (G W Gᵀ)⁻¹ G W f`,
//!
//! which keeps `G v` (Featherstone, Rigid Body Dynamics Algorithms, 2008, 3.2). The motion in time follows the RATTLE
//! scheme (Andersen 1983), which keeps energy while joints turn velocities.

use crate::math::fast_hash::FastMap;
use crate::math::tolerance::ROUNDING_ULPS;
use crate::math::{Pose, Real, Rotation, Vector};
use crate::rapier::joints::limits::Limit;
use crate::rapier::joints::rows::{Joint, JointEnds, JointRow, Twist, dot};
use crate::rapier::joints::skyline::{Skyline, ranks};
use crate::rapier::view::inertia::Inertia;
use crate::rapier::view::link_angles::shortest;
use crate::rapier::view::step_view::StepView;

/// Relative addition to the diagonal of `G W Gᵀ`, which is singular where joints close a loop: above the rounding of
/// the Jacobians in single precision.
const REGULAR: f64 = 1.0e-4;

/// Times that joints are closed in a piece of a motion: each leaves about a quarter of the opening.
const CLOSING_STEPS: usize = 8;

/// Share of the opening that a closing step may leave. If it leaves more, as of light links on long levers, the
/// directions along which joints close are found anew at the present poses; until then they are those of the piece's
/// start.
const SLOW: f64 = 0.5;

/// Opening that is left, in units of rapier's length unit or in radians; of bodies far from each other more, by the
/// rounding of their poses.
const CLOSED: f64 = 1.0e-5;

/// Rounding of a pose in single precision, relative to its distance from the origin.
const ROUNDING: f64 = ROUNDING_ULPS * Real::EPSILON as f64;

/// Bodies tied by joints, at some poses.
pub struct System<'a> {
    /// Indices in the view.
    pub bodies: Vec<usize>,
    inertias: Vec<Inertia>,
    /// Centres of mass in the frames of the bodies.
    centers: Vec<Vector>,
    /// rapier's length unit.
    pub(super) unit: Real,
    /// Point that is taken from all positions, which are the more exact for it.
    origin: Vector,
    start: Vec<Pose>,
    pub(super) poses: Vec<Pose>,
    /// Ways of the centres of mass, and turns, since the start.
    pub(super) moved: Vec<(Vector, Rotation)>,
    /// Joints with the places of their bodies.
    pub(super) joints: Vec<(&'a Joint, [usize; 2])>,
    /// Limits at which joints stop in a piece of the motion, and places of these joints.
    pub(super) stops: Vec<(usize, Limit)>,
    /// Rows of `G`, and of `G W`.
    rows: Vec<JointRow>,
    weighted: Vec<[Twist; 2]>,
    /// Factor of `G W Gᵀ`, and the order of its rows: those of branches before those of their stem, branch by branch.
    factor: Option<Skyline>,
    order: Vec<usize>,
    /// Ranks of the bodies in that order.
    ranks: Vec<usize>,
}

impl<'a> System<'a> {
    /// Bodies, each with its inertia, where they are at `time`.
    pub fn new(
        view: &StepView,
        time: Real,
        (bodies, inertias): (Vec<usize>, Vec<Inertia>),
        joints: Vec<&'a Joint>,
    ) -> Self {
        let pose = |b: &usize| view.bodies[*b].motion_from(time).start;
        let origin = bodies.first().map_or(Vector::ZERO, |b| pose(b).translation);
        let relative = |pose: Pose| Pose::from_parts(pose.translation - origin, pose.rotation);
        let center = |b: &usize| view.bodies[*b].mass.local_com;
        let start: Vec<Pose> = bodies.iter().map(|b| relative(pose(b))).collect();
        let places: FastMap<usize, usize> = bodies.iter().copied().zip(0..).collect();
        let place = |body: usize| places.get(&body).copied();
        let placed = |j: &'a Joint| Some((j, [place(j.bodies[0])?, place(j.bodies[1])?]));
        let joints: Vec<_> = joints.into_iter().filter_map(placed).collect();
        let mut system = Self {
            inertias,
            centers: bodies.iter().map(center).collect(),
            unit: view.unit,
            origin,
            poses: start.clone(),
            start,
            moved: vec![(Vector::ZERO, Rotation::IDENTITY); bodies.len()],
            ranks: ranks(bodies.len(), joints.iter().map(|joint| joint.1)),
            joints,
            bodies,
            stops: Vec::new(),
            rows: Vec::new(),
            weighted: Vec::new(),
            factor: None,
            order: Vec::new(),
        };
        system.factor();
        system
    }

    /// The same bodies, moved as another system of them is.
    pub fn moved_as(mut self, other: &Self) -> Self {
        self.poses.clone_from(&other.poses);
        self.moved.clone_from(&other.moved);
        self.factor();
        self
    }

    /// Whether nothing moves a body.
    pub fn is_infinite(&self, k: usize) -> bool {
        self.inertias[k].is_infinite()
    }

    /// Whether any joint holds any body.
    pub fn holds(&self) -> bool {
        !self.rows.is_empty()
    }

    /// Way of a body's centre of mass, and its turn.
    pub fn moved(&self, k: usize) -> (Vector, Rotation) {
        self.moved[k]
    }

    /// Change of the velocities of all bodies by wrenches on some of them.
    pub fn change(&self, wrenches: &[(usize, Twist)]) -> Vec<Twist> {
        let mut change = vec![[Vector::ZERO; 2]; self.bodies.len()];
        for (body, wrench) in wrenches {
            if let Some(k) = self.bodies.iter().position(|b| b == body) {
                add(&mut change[k], self.inertias[k].apply(*wrench), 1.0);
            }
        }
        self.hold(&mut change);
        change
    }

    /// Takes from twists what joints do not let them have.
    pub fn hold(&self, twists: &mut [Twist]) {
        let rates = self.rows.iter().map(|r| r.along(twists)).collect();
        self.subtract(rates, twists);
    }

    /// Takes `W Gᵀ (G W Gᵀ)⁻¹ b` from twists.
    fn subtract(&self, b: Vec<f64>, twists: &mut [Twist]) {
        let Some(factor) = &self.factor else {
            return;
        };
        let mut lambda: Vec<f64> = self.order.iter().map(|i| b[*i]).collect();
        factor.solve(&mut lambda);
        let mut held = b;
        for (i, lambda) in self.order.iter().zip(lambda) {
            held[*i] = lambda;
        }
        for ((row, weighted), held) in self.rows.iter().zip(&self.weighted).zip(held) {
            for (k, weighted) in row.bodies.into_iter().zip(weighted) {
                add(&mut twists[k], *weighted, -held as Real);
            }
        }
    }

    /// Finds the rows at the poses now, and factors `G W Gᵀ`.
    pub(super) fn factor(&mut self) {
        self.rows = self.rows_now();
        let inertias = &self.inertias;
        let weighted = |r: &JointRow| [0, 1].map(|k| inertias[r.bodies[k]].apply(r.jacobian[k]));
        self.weighted = self.rows.iter().map(weighted).collect();
        self.order = (0..self.rows.len()).collect();
        let rank = |i: &usize| self.rows[*i].bodies.iter().map(|k| self.ranks[*k]).min();
        self.order.sort_by_key(rank);
        let mut matrix = Skyline::default();
        // The first row in that order that moves each body, if there was one yet.
        let mut firsts = vec![usize::MAX; self.bodies.len()];
        for (at, &i) in self.order.iter().enumerate() {
            let row = &self.rows[i];
            let free = (0..2).filter(|k| !self.inertias[row.bodies[*k]].is_infinite());
            for k in free.clone() {
                firsts[row.bodies[k]] = firsts[row.bodies[k]].min(at);
            }
            let first = free.clone().map(|k| firsts[row.bodies[k]]).min();
            let first = first.unwrap_or(at);
            let entries = matrix.push_row(first);
            for (&j, entry) in self.order[first..=at].iter().zip(entries.iter_mut()) {
                let (other, weighted) = (self.rows[j].bodies, &self.weighted[j]);
                for k in free.clone() {
                    for l in (0..2).filter(|l| other[*l] == row.bodies[k]) {
                        *entry += dot(row.jacobian[k], weighted[l]);
                    }
                }
            }
            let diagonal = &mut entries[at - first];
            *diagonal = *diagonal * (1.0 + REGULAR) + f64::from(Real::MIN_POSITIVE);
        }
        self.factor = (!self.rows.is_empty()).then(|| matrix.factor()).flatten();
    }

    /// The rows of all joints that hold what moves at the poses now, those of stops last.
    fn rows_now(&self) -> Vec<JointRow> {
        let locked = (0..self.joints.len())
            .flat_map(|j| self.ends(j, &self.poses).locked(self.joints[j].0.locked));
        let stops = self.stops.iter();
        let stops = stops.map(|(j, limit)| self.ends(*j, &self.poses).limited(limit));
        let rows = locked.chain(stops);
        rows.filter(|r| self.is_movable(r)).collect()
    }

    /// Ends of a joint at some poses.
    pub(super) fn ends(&self, joint: usize, poses: &[Pose]) -> JointEnds {
        let (joint, bodies) = self.joints[joint];
        JointEnds {
            bodies,
            frames: [0, 1].map(|k| poses[bodies[k]] * joint.frames[k]),
            centers: bodies.map(|k| poses[k] * self.centers[k]),
        }
    }

    /// Moves the bodies by some velocities for some seconds, until joints are open by `targets`, and returns the
    /// velocities they end with.
    pub fn integrate(&mut self, twists: &[Twist], seconds: Real, targets: &[f64]) -> Vec<Twist> {
        let size = self
            .poses
            .iter()
            .map(|p| p.translation.length())
            .fold(0.0, Real::max);
        let closed = CLOSED.max(ROUNDING * f64::from(size / self.unit));
        self.displace(twists, seconds);
        let mut twists = twists.to_vec();
        let mut before = f64::INFINITY;
        for _ in 0..CLOSING_STEPS {
            let (left, most) = self.left_open(targets);
            if most <= closed {
                break;
            }
            if most > SLOW * before {
                self.factor();
            }
            before = most;
            let mut moves = vec![[Vector::ZERO; 2]; self.bodies.len()];
            self.subtract(left, &mut moves);
            self.displace(&moves, 1.0);
        }
        if before.is_finite() {
            for (k, twist) in twists.iter_mut().enumerate() {
                if !self.is_infinite(k) {
                    let (way, turn) = self.moved[k];
                    *twist = [way, shortest(turn).to_scaled_axis()].map(|moved| moved / seconds);
                }
            }
        }
        self.factor();
        self.hold(&mut twists);
        twists
    }

    /// How far each locked axis is open at the poses now.
    pub fn openings(&self) -> Vec<f64> {
        let rows = self.rows_now();
        rows.iter().map(|r| f64::from(r.opening)).collect()
    }

    /// Differences of all openings from their targets (lengths, or angles in radians), and the largest of them in units
    /// of rapier's length unit or in radians.
    pub fn left_open(&self, targets: &[f64]) -> (Vec<f64>, f64) {
        let (mut left, mut most) = (Vec::new(), 0.0);
        for (row, target) in self.rows_now().iter().zip(targets) {
            let off = f64::from(row.opening) - target;
            let unit = if row.is_angle { 1.0 } else { self.unit.into() };
            // A joint whose opening is NaN is not closed.
            let size = off.abs() / unit;
            most = f64::max(most, if size.is_nan() { f64::INFINITY } else { size });
            left.push(off);
        }
        (left, most)
    }

    /// How far each is where rapier's step ended.
    pub fn openings_in_the_end(&mut self, view: &StepView) -> Vec<f64> {
        let pose = |b: &usize| {
            let end = view.bodies[*b].end;
            Pose::from_parts(end.translation - self.origin, end.rotation)
        };
        let ends = self.bodies.iter().map(pose).collect();
        let now = std::mem::replace(&mut self.poses, ends);
        let openings = self.openings();
        self.poses = now;
        openings
    }

    /// Scales the velocities that bodies end with so that they have no more energy than those they had: joints that are
    /// closed in a short time give their bodies the speed that it takes. Energy is that in the frame of what nothing
    /// moves, or else of the common centre of mass.
    pub fn take_no_energy(&self, own: &[Twist], end: &mut [Twist]) {
        let center = |poses: &[Pose], k: usize| poses[k] * self.centers[k];
        let holder = (0..own.len()).find(|k| self.is_infinite(*k));
        let frame = |poses: &[Pose], k: usize| match holder {
            Some(h) => {
                let [slide, turn] = own[h];
                [
                    slide + turn.cross(center(poses, k) - center(poses, h)),
                    turn,
                ]
            }
            None => [self.common_velocity(own), Vector::ZERO],
        };
        let frames: [Vec<Twist>; 2] = [&self.start, &self.poses]
            .map(|poses| (0..own.len()).map(|k| frame(poses, k)).collect());
        let energy = |twists: &[Twist], poses: &[Pose], frame: &[Twist]| -> f64 {
            let of = |(k, inertia): (usize, &Inertia)| {
                // The inertia is that of the start.
                let back = self.start[k].rotation * poses[k].rotation.inverse();
                let [slide, turn] = [0, 1].map(|i| twists[k][i] - frame[k][i]);
                inertia.energy([slide, back * turn])
            };
            self.inertias.iter().enumerate().map(of).sum()
        };
        let had = energy(own, &self.start, &frames[0]);
        let has = energy(end, &self.poses, &frames[1]);
        if has > had {
            let share = (had / has).sqrt() as Real;
            for (twist, still) in end.iter_mut().zip(&frames[1]) {
                *twist = [0, 1].map(|i| still[i] + (twist[i] - still[i]) * share);
            }
        }
    }

    /// Velocity of the common centre of mass; along axes on which a body is locked, of the others.
    fn common_velocity(&self, own: &[Twist]) -> Vector {
        let (mut masses, mut momentum) = (Vector::ZERO, Vector::ZERO);
        for (inertia, twist) in self.inertias.iter().zip(own) {
            let mass = inertia.masses();
            masses += mass;
            momentum += mass * twist[0];
        }
        momentum / masses.max(Vector::splat(Real::MIN_POSITIVE))
    }

    fn is_movable(&self, row: &JointRow) -> bool {
        row.bodies.iter().any(|k| !self.is_infinite(*k))
    }

    /// Moves all bodies by some twists for some seconds.
    pub(super) fn displace(&mut self, twists: &[Twist], seconds: Real) {
        for (k, [slide, turn]) in twists.iter().enumerate() {
            let turn = Rotation::from_scaled_axis(*turn * seconds);
            let center = self.poses[k] * self.centers[k] + *slide * seconds;
            let rotation = (turn * self.poses[k].rotation).normalize();
            self.poses[k] = Pose::from_parts(center - rotation * self.centers[k], rotation);
            let moved = &mut self.moved[k];
            *moved = (moved.0 + *slide * seconds, (turn * moved.1).normalize());
        }
    }
}

fn add(twist: &mut Twist, more: Twist, factor: Real) {
    twist[0] += more[0] * factor;
    twist[1] += more[1] * factor;
}
