//! Joints in an impact: what holds bodies together hands an impulse on at once.
//!
//! An impulse on one body of a chain moves them all, by the inverse mass of the chain: with the inverse masses `W`
//! of the free bodies and the Jacobian `G` of the locked axes of their joints, a wrench `f` changes velocities by
//!
//! `W f − W Gᵀ (G W Gᵀ)⁻¹ G W f`,
//!
//! which keeps `G v` (Featherstone, Rigid Body Dynamics Algorithms, 2008, 3.2). Joints of bodies and of
//! multibodies are the same here. For the rest of the step each body then moves to where its joints let it, and not
//! along its velocity, which would open them. Limits and motors act in rapier's next step; joints that the user made
//! soft are left to it.

use super::impulse::Inertia;
use super::motion::{Kind, shortest};
use super::snapshot::Snapshot;
use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Rotation, Vector};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rapier3d::dynamics::{
    GenericJoint, ImpulseJointSet, JointEnabled, MultibodyJointSet, RigidBodyHandle,
    SpringCoefficients,
};

/// Joints that hand an impulse on, the nearest to what is struck. The factorisation takes the cube of them: 24 take
/// a third of a millisecond.
pub const MOST_JOINTS: usize = 24;

/// Relative addition to the diagonal of `G W Gᵀ`, which is singular where joints close a loop: above the rounding of
/// the Jacobians in single precision.
const REGULAR: f64 = 1.0e-4;

/// Turn of the fastest body, in radians, in one step of [`System::integrate`], and the most steps.
const STEP_TURN: Real = 0.25;
const MOST_STEPS: Real = 8.0;

/// Times that joints are closed in such a step: each leaves about a quarter of the opening.
const CLOSING_STEPS: usize = 8;

/// Opening that is left, a length or an angle in radians.
const CLOSED: f64 = 1.0e-5;

/// Opening, a length or an angle, from which joints count as not closed: what is this far off says nothing of where
/// bodies go, which then go straight, and rapier's next step closes the joints.
const UNCLOSED: f64 = 1.0e-2;

/// Linear and angular velocity, or force and torque, at a body's centre of mass.
pub type Twist = [Vector; 2];

/// A joint between two bodies of a [`Snapshot`].
struct Joint {
    bodies: [usize; 2],
    /// In the frame of each body.
    frames: [Pose; 2],
    /// Which of the six axes of the first frame are locked, linear ones first.
    locked: u8,
}

/// The joints of a world.
#[derive(Default)]
pub struct Joints {
    all: Vec<Joint>,
    of_body: FastMap<usize, Vec<usize>>,
}

impl Joints {
    /// Those between bodies of a snapshot.
    pub fn new(
        snapshot: &Snapshot,
        impulse_joints: &ImpulseJointSet,
        multibody_joints: &MultibodyJointSet,
    ) -> Self {
        let mut joints = Self::default();
        for (_, joint) in impulse_joints.iter() {
            let rigid = joint.data.softness == SpringCoefficients::joint_defaults();
            if rigid && joint.data.enabled == JointEnabled::Enabled {
                joints.add(snapshot, [joint.body1(), joint.body2()], &joint.data);
            }
        }
        for multibody in multibody_joints.multibodies() {
            for link in multibody.links() {
                if let Some(parent) = link.parent_id().and_then(|id| multibody.link(id)) {
                    let bodies = [parent.rigid_body_handle(), link.rigid_body_handle()];
                    joints.add(snapshot, bodies, &link.joint.data);
                }
            }
        }
        joints
    }

    fn add(&mut self, snapshot: &Snapshot, bodies: [RigidBodyHandle; 2], joint: &GenericJoint) {
        let [Some(&a), Some(&b)] = bodies.map(|h| snapshot.index.get(&h)) else {
            return;
        };
        for body in [a, b] {
            self.of_body.entry(body).or_default().push(self.all.len());
        }
        self.all.push(Joint {
            bodies: [a, b],
            frames: [joint.local_frame1, joint.local_frame2],
            locked: joint.locked_axes.bits(),
        });
    }

    /// The free bodies that joints tie to some bodies, these first, and the joints between them.
    fn tied(&self, snapshot: &Snapshot, from: &[usize]) -> (Vec<usize>, Vec<&Joint>) {
        let (mut bodies, mut joints) = (from.to_vec(), Vec::new());
        let mut next = 0;
        while next < bodies.len() {
            let body = bodies[next];
            next += 1;
            if snapshot.bodies[body].kind != Kind::Free {
                continue;
            }
            for &j in self.of_body.get(&body).into_iter().flatten() {
                if joints.len() < MOST_JOINTS && !joints.contains(&j) {
                    joints.push(j);
                    let far = self.all[j].bodies.into_iter().find(|b| *b != body);
                    bodies.extend(far.filter(|b| !bodies.contains(b)));
                }
            }
        }
        (bodies, joints.into_iter().map(|j| &self.all[j]).collect())
    }

    /// What moves when some bodies are struck at `time`, with the inertia of each.
    pub fn system(
        &self,
        snapshot: &Snapshot,
        from: &[usize],
        time: Real,
        inertia: impl Fn(usize) -> Inertia,
    ) -> System<'_> {
        let (bodies, joints) = self.tied(snapshot, from);
        let pose = |b: &usize| snapshot.bodies[*b].motion_from(time).start;
        let mut system = System {
            inertias: bodies.iter().map(|b| inertia(*b)).collect(),
            centers: bodies
                .iter()
                .map(|b| snapshot.bodies[*b].mass.local_com)
                .collect(),
            poses: bodies.iter().map(pose).collect(),
            bodies,
            joints,
            rows: Vec::new(),
            factor: None,
        };
        system.factor();
        system
    }

    /// Gives bodies that joints tie to some bodies the motions from `time` to the end of the step, `dt`, that joints
    /// let them make, and lets their velocities follow, which together gain no energy. `inertia`: of each body,
    /// infinite where nothing moves it. Returns the bodies whose motion that changes.
    pub fn close(
        &self,
        snapshot: &mut Snapshot,
        from: &[usize],
        [time, dt]: [Real; 2],
        inertia: impl Fn(&Snapshot, usize) -> Inertia,
    ) -> Vec<usize> {
        let tied = from.iter().any(|b| self.of_body.contains_key(b));
        if !tied || time >= dt {
            return Vec::new();
        }
        let mut system = self.system(snapshot, from, time, |b| inertia(snapshot, b));
        let motion = |b: &usize| {
            let m = &snapshot.bodies[*b].motion;
            [m.linvel, m.angvel]
        };
        let before: Vec<Twist> = system.bodies.iter().map(motion).collect();
        let start = system.poses.clone();
        let after = system.integrate(&before, dt - time);
        if !system.openings().iter().all(|o| o.abs() <= UNCLOSED) {
            return Vec::new();
        }
        for &b in &system.bodies {
            if snapshot.bodies[b].kind == Kind::Free {
                snapshot.bodies[b].advance(time);
            }
        }
        let own: Vec<Twist> = system
            .bodies
            .iter()
            .map(|b| snapshot.bodies[*b].velocity)
            .collect();
        let mut end: Vec<Twist> = own.clone();
        for (k, twist) in end.iter_mut().enumerate() {
            add(twist, after[k], 1.0);
            add(twist, before[k], -1.0);
        }
        // Joints that are closed in a short time give their bodies the speed that it takes.
        let inertias = &system.inertias;
        let energy = |twists: &[Twist], poses: &[Pose]| -> f64 {
            let of = |(k, inertia): (usize, &Inertia)| {
                // Its inertia is that of the start.
                let back = start[k].rotation * poses[k].rotation.inverse();
                inertia.energy([twists[k][0], back * twists[k][1]])
            };
            inertias.iter().enumerate().map(of).sum()
        };
        let (had, has) = (energy(&own, &start), energy(&end, &system.poses));
        let share = if has > had { (had / has).sqrt() } else { 1.0 };
        let mut moved = Vec::new();
        for (k, &b) in system.bodies.iter().enumerate() {
            if !system.inertias[k].is_infinite() {
                let gained = [0, 1].map(|i| end[k][i] * share as Real - own[k][i]);
                snapshot.bodies[b].aim(system.poses[k], gained, dt - time);
                moved.push(b);
            }
        }
        moved
    }
}

/// A locked axis: the opening of the joint, and its change by the twists of both bodies.
struct Row {
    /// Places in [`System::bodies`].
    bodies: [usize; 2],
    jacobian: [Twist; 2],
    /// A length or an angle.
    opening: Real,
}

/// Bodies tied by joints, at some poses.
pub struct System<'a> {
    /// Indices in the snapshot.
    pub bodies: Vec<usize>,
    inertias: Vec<Inertia>,
    /// Centres of mass in the frames of the bodies.
    centers: Vec<Vector>,
    poses: Vec<Pose>,
    joints: Vec<&'a Joint>,
    rows: Vec<Row>,
    /// Of `G W Gᵀ`.
    factor: Option<Cholesky<f64, Dyn>>,
}

fn dot(a: Twist, b: Twist) -> f64 {
    f64::from(a[0].dot(b[0]) + a[1].dot(b[1]))
}

impl System<'_> {
    /// Change of the velocities of all bodies by wrenches on some of them.
    pub fn change(&self, wrenches: &[(usize, Twist)]) -> Vec<Twist> {
        let mut change = vec![[Vector::ZERO; 2]; self.bodies.len()];
        for (body, wrench) in wrenches {
            if let Some(k) = self.bodies.iter().position(|b| b == body) {
                add(&mut change[k], self.inertias[k].apply(*wrench), 1.0);
            }
        }
        let along = |row: &Row| {
            let of = |k: usize| dot(row.jacobian[k], change[row.bodies[k]]);
            of(0) + of(1)
        };
        let held = self.solve(self.rows.iter().map(along).collect());
        self.subtract(&held, &mut change);
        change
    }

    /// Takes `W Gᵀ λ` from twists.
    fn subtract(&self, lambda: &[f64], twists: &mut [Twist]) {
        for (row, lambda) in self.rows.iter().zip(lambda) {
            for (k, jacobian) in row.bodies.into_iter().zip(row.jacobian) {
                add(
                    &mut twists[k],
                    self.inertias[k].apply(jacobian),
                    -*lambda as Real,
                );
            }
        }
    }

    fn solve(&self, right: Vec<f64>) -> Vec<f64> {
        match &self.factor {
            Some(factor) => factor.solve(&DVector::from_vec(right)).as_slice().to_vec(),
            None => vec![0.0; right.len()],
        }
    }

    fn factor(&mut self) {
        let rows = self.joints.iter().flat_map(|j| self.rows_of(j));
        self.rows = rows.filter(|r| self.is_movable(r)).collect();
        let rows = &self.rows;
        let weighted: Vec<[Twist; 2]> = rows
            .iter()
            .map(|r| [0, 1].map(|k| self.inertias[r.bodies[k]].apply(r.jacobian[k])))
            .collect();
        let mut matrix = DMatrix::zeros(rows.len(), rows.len());
        for (i, a) in rows.iter().enumerate() {
            for (j, b) in rows.iter().enumerate().take(i + 1) {
                let mut sum = 0.0;
                for (k, body) in a.bodies.into_iter().enumerate() {
                    for (l, other) in b.bodies.into_iter().enumerate() {
                        if body == other {
                            sum += dot(a.jacobian[k], weighted[j][l]);
                        }
                    }
                }
                (matrix[(i, j)], matrix[(j, i)]) = (sum, sum);
            }
        }
        for i in 0..rows.len() {
            matrix[(i, i)] = matrix[(i, i)] * (1.0 + REGULAR) + f64::from(Real::MIN_POSITIVE);
        }
        self.factor = (!rows.is_empty()).then(|| Cholesky::new(matrix)).flatten();
    }

    fn rows_of(&self, joint: &Joint) -> Vec<Row> {
        let places = joint
            .bodies
            .map(|b| self.bodies.iter().position(|o| *o == b));
        let [Some(a), Some(b)] = places else {
            return Vec::new();
        };
        let frames = [0, 1].map(|k| self.poses[[a, b][k]] * joint.frames[k]);
        let center = |k: usize| self.poses[k] * self.centers[k];
        let at = frames[1].translation;
        let arms = [a, b].map(|k| at - center(k));
        let locked = |i: u8| joint.locked & (1 << i) != 0;
        let axis = |i: u8| frames[0].rotation * Vector::AXES[usize::from(i)];
        let linear = (0..3).filter(|i| locked(*i)).map(|i| {
            let n = axis(i);
            Row {
                bodies: [a, b],
                jacobian: [[-n, -arms[0].cross(n)], [n, arms[1].cross(n)]],
                opening: (at - frames[0].translation).dot(n),
            }
        });
        let turned = turned(frames.map(|f| f.rotation), joint.locked >> 3);
        let angular = (0..3).filter(|i| locked(i + 3)).map(|i| {
            let n = axis(i);
            Row {
                bodies: [a, b],
                jacobian: [[Vector::ZERO, -n], [Vector::ZERO, n]],
                opening: turned.dot(n),
            }
        });
        linear.chain(angular).collect()
    }

    /// Moves the bodies by some velocities for some seconds, joints closed, and returns the velocities they end with:
    /// the RATTLE scheme (Andersen 1983), which keeps energy where joints turn velocities.
    fn integrate(&mut self, twists: &[Twist], seconds: Real) -> Vec<Twist> {
        let mut twists = twists.to_vec();
        let turn = twists.iter().map(|t| t[1].length()).fold(0.0, Real::max) * seconds;
        let steps = (turn / STEP_TURN).ceil().clamp(1.0, MOST_STEPS);
        let h = seconds / steps;
        for _ in 0..steps as usize {
            let before = self.poses.clone();
            self.displace(&twists, h);
            for _ in 0..CLOSING_STEPS {
                let openings = self.openings();
                if openings.iter().all(|o| o.abs() <= CLOSED) {
                    break;
                }
                let mut moves = vec![[Vector::ZERO; 2]; self.bodies.len()];
                self.subtract(&self.solve(openings), &mut moves);
                self.displace(&moves, 1.0);
            }
            for (k, twist) in twists.iter_mut().enumerate() {
                if !self.inertias[k].is_infinite() {
                    *twist = self.twist(k, &before[k], h);
                }
            }
            self.factor();
            let along = |row: &Row| {
                let of = |k: usize| dot(row.jacobian[k], twists[row.bodies[k]]);
                of(0) + of(1)
            };
            let held = self.solve(self.rows.iter().map(along).collect());
            self.subtract(&held, &mut twists);
        }
        twists
    }

    /// How far each locked axis is open at the poses now.
    fn openings(&self) -> Vec<f64> {
        let rows = self.joints.iter().flat_map(|j| self.rows_of(j));
        let openings = rows.filter(|r| self.is_movable(r));
        openings.map(|r| f64::from(r.opening)).collect()
    }

    fn is_movable(&self, row: &Row) -> bool {
        row.bodies.iter().any(|k| !self.inertias[*k].is_infinite())
    }

    /// Moves all bodies by some twists for some seconds.
    fn displace(&mut self, twists: &[Twist], seconds: Real) {
        for (k, [slide, turn]) in twists.iter().enumerate() {
            let center = self.poses[k] * self.centers[k] + *slide * seconds;
            let rotation = Rotation::from_scaled_axis(*turn * seconds) * self.poses[k].rotation;
            let rotation = rotation.normalize();
            self.poses[k] = Pose::from_parts(center - rotation * self.centers[k], rotation);
        }
    }

    /// The velocities that took a body from another pose to where it is, in some seconds.
    fn twist(&self, k: usize, from: &Pose, seconds: Real) -> Twist {
        let (center, to) = (self.centers[k], &self.poses[k]);
        let turn = shortest(to.rotation * from.rotation.inverse()).to_scaled_axis();
        [(*to * center - *from * center) / seconds, turn / seconds]
    }
}

fn add(twist: &mut Twist, more: Twist, factor: Real) {
    twist[0] += more[0] * factor;
    twist[1] += more[1] * factor;
}

/// By how much the second frame is turned against the first round the locked axes, world frame, for small turns.
fn turned(rotations: [Rotation; 2], locked: u8) -> Vector {
    let [first, second] = rotations;
    if (locked & 7).count_ones() == 2 {
        let free = (0..3).find(|i| locked & (1 << i) == 0).unwrap_or(0);
        let axis = Vector::AXES[free];
        return (first * axis).cross(second * axis);
    }
    let between = first.inverse() * second;
    let sign = if between.w < 0.0 { -2.0 } else { 2.0 };
    first * (Vector::new(between.x, between.y, between.z) * sign)
}
