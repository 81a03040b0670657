//! First contact of a medial mesh with cylinders and cones, plain or rounded, in exact rigid
//! motion: certified advancement. Source: conservative advancement (Mirtich 1996), with the bound of
//! [`super::turned`] in place of a computed distance.
//!
//! # Step
//! At time `t` the nearest sphere gives a direction `m`, which is then held fixed in the frame of the
//! cylinder, where its support `h(m)` is a constant. A corner `p = x − o`, seen from the centre `o` of
//! the cylinder that turns with `ω`, has in that frame the velocity `x′ − o′ − ω × p` and an acceleration
//! of at most
//! ```text
//! B = |x″| + |o″| + 2 ω |x′ − o′| + ω² |p|
//! ```
//! (frame, Coriolis, centrifugal), so the bound along `m` stays above `g + g′ s − B s²/2` for each
//! corner, up to the first root. The Lipschitz step, `g` over the largest relative speed of points of the two
//! bodies, is taken instead where it is longer.
//!
//! # Guarantee
//! That of [`crate::elementary`], with `D(t)` the signed distance of [`super::turned`]: it counts a
//! body inside the solid, and never falls below minus the largest radius. `upper = lower` for a
//! contact, and `D` there is at most the tolerance. All in double precision: positions are sums of
//! at most 16 rounded terms no larger than `scale`, the sum of all lengths in play, so that [`ULPS`]
//! ulps of it cover the bound. A tolerance below four times that slack is raised to it.

use super::turned::{Ball, NearBall, Place, Turned};
use crate::elementary::first_contact::motion_is_finite;
use crate::elementary::{InitialContact, Toi, ToiOptions, ToiStatus};
use crate::math::lane::Vec3;
use crate::math::motion::{PointPath, RigidMotion};
use crate::math::{Real, Vector};
use crate::medial::tree::Below;
use crate::medial::{MedialMesh, MedialSphere};
use crate::pair::Volumes;
use crate::pair::first_contact::Counts;
use parry3d::query::NonlinearRigidMotion;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Rounding slack in units of `f64::EPSILON × scale` (no unit); derived in the header, with a margin
/// of 4.
const ULPS: f64 = 64.0;

/// Smallest tolerance in units of the slack: one slack is lost in the bound, one in the test for
/// contact, and the last step needs room.
const TOLERANCE_PER_SLACK: f64 = 4.0;

/// Iterations of one primitive, in units of the cap asked for: a step costs a tenth of one of
/// [`crate::elementary::bracket`], and has no turning direction to lengthen it.
const CAP: u32 = 4;

/// Distance at which a node of the tree counts as met, in units of its radius: empirical, finer
/// costs more steps than it culls.
const NODE_TOLERANCE: f64 = 0.1;

/// Cap of the iterations of a node; what it has proven by then counts.
const NODE_STEPS: u32 = 16;

/// First contact of `mesh` with the nearest in time of `bodies`, which share one motion. Times in
/// the answer are fractions of the step; the second primitive index is that in `bodies`.
pub fn first_contact(
    mesh: &MedialMesh,
    motion1: &NonlinearRigidMotion,
    bodies: &[Turned],
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> (Toi, Counts) {
    let finite = motion_is_finite(motion1) && motion_is_finite(motion2) && seconds.is_finite();
    if !finite || !options.tolerance.is_finite() || !options.target_distance.is_finite() {
        return (Toi::bad_input(options), Counts::default());
    }
    let motions = RigidMotion::<f64>::pair(motion1, motion2, seconds.into());
    let pivots = motion1.local_center.length() + motion2.local_center.length();
    let mut search = Search {
        mesh,
        motions,
        pivots: pivots.into(),
        options,
        counts: Counts::default(),
        tolerance: options.tolerance.max(0.0).into(),
        status: ToiStatus::Separated,
        lower: 1.0,
        upper: 1.0,
        found: None,
    };
    for (i, body) in bodies.iter().enumerate() {
        search.body(body, i as u32);
    }
    // From the pair's frame to the world: it starts at the first body's origin and moves with the
    // second body's velocity.
    let elapsed = search.lower * f64::from(seconds);
    let origin = Vec3::<f64>::from_vector(motion1.start.translation)
        + Vec3::from_vector(motion2.linvel) * elapsed;
    (search.answer(bodies, origin), search.counts)
}

struct Search<'a> {
    mesh: &'a MedialMesh,
    motions: [RigidMotion<f64>; 2],
    /// Distances of the centres of rotation from the bodies' origins, summed.
    pivots: f64,
    options: &'a ToiOptions,
    counts: Counts,
    tolerance: f64,
    status: ToiStatus,
    lower: f64,
    upper: f64,
    found: Option<Found>,
}

#[derive(Clone, Copy)]
struct Found {
    near: NearBall,
    place: Place,
    primitives: [u32; 2],
}

/// How one volume is followed.
#[derive(Clone, Copy)]
struct Limits {
    start: f64,
    horizon: f64,
    target: f64,
    tolerance: f64,
    steps: u32,
}

/// What is known of one volume.
struct Advance {
    /// Free before; where it is met, if `met`.
    lower: f64,
    met: bool,
    /// Proven free up to the horizon.
    separated: bool,
    slack: f64,
    near: NearBall,
    place: Place,
}

/// A node of the tree by the time until which it is free.
#[derive(PartialEq)]
struct Entry(f64, u32);
impl Eq for Entry {}
impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

impl Search<'_> {
    /// Best-first over the tree, by the time until which each node is proven free.
    fn body(&mut self, body: &Turned, index: u32) {
        let mut heap = BinaryHeap::new();
        for root in 0..self.mesh.roots() {
            self.push(&mut heap, body, root, 0.0);
        }
        while let Some(Reverse(Entry(time, node))) = heap.pop() {
            if time > self.upper || self.status == ToiStatus::Overlapping {
                return;
            }
            match self.mesh.below(node) {
                Below::Nodes(i, j) => {
                    self.push(&mut heap, body, i, time);
                    self.push(&mut heap, body, j, time);
                }
                Below::Primitive(i) => self.leaf(body, [i, index], time),
            }
        }
    }

    fn push(&mut self, heap: &mut BinaryHeap<Reverse<Entry>>, body: &Turned, node: u32, time: f64) {
        self.counts.nodes += 1;
        let (center, radius) = self.mesh.bound(node);
        let limits = Limits {
            start: time,
            horizon: self.upper,
            target: self.options.target_distance.into(),
            tolerance: self.tolerance + NODE_TOLERANCE * f64::from(radius),
            steps: NODE_STEPS,
        };
        let ball = (Vec3::from_vector(center), f64::from(radius));
        let advance = self.advance(body, &[ball], &limits);
        if !advance.separated {
            heap.push(Reverse(Entry(advance.lower, node)));
        }
    }

    fn leaf(&mut self, body: &Turned, primitives: [u32; 2], time: f64) {
        self.counts.tests += 1;
        let (spheres, share) = Volumes::primitive(self.mesh, primitives[0]);
        let balls = spheres.map(|s| (Vec3::from_vector(s.center), f64::from(s.radius)));
        let balls = &balls[..share.spheres.clamp(1, 3)];
        let mut limits = Limits {
            start: time,
            horizon: self.upper,
            target: self.options.target_distance.into(),
            tolerance: self.tolerance,
            steps: CAP.saturating_mul(self.options.max_iterations),
        };
        if let InitialContact::Deepen { by } = self.options.initial_contact {
            let at_start = Limits {
                start: 0.0,
                steps: 1,
                ..limits
            };
            let start = self.advance(body, balls, &at_start).near.distance();
            if start <= limits.target + limits.tolerance {
                limits.start = 0.0;
                limits.target = start - f64::from(by) - limits.tolerance;
            }
        }
        let advance = self.advance(body, balls, &limits);
        if advance.separated {
            return;
        }
        self.tolerance = self.tolerance.max(TOLERANCE_PER_SLACK * advance.slack);
        let sooner = self.found.is_none() || advance.lower < self.lower;
        self.lower = self.lower.min(advance.lower);
        let overlap = advance.met
            && advance.lower <= 0.0
            && advance.near.distance() < limits.target - advance.slack;
        if sooner || overlap {
            self.found = Some(Found {
                near: advance.near,
                place: advance.place,
                primitives,
            });
            self.status = match (advance.met, overlap) {
                (true, true) => ToiStatus::Overlapping,
                (true, false) => ToiStatus::Contact,
                (false, _) => ToiStatus::Unresolved,
            };
        }
        if advance.met {
            self.upper = self.upper.min(advance.lower);
        }
    }

    /// Follows 1 to 3 interpolated spheres until they meet the body.
    fn advance(&self, body: &Turned, balls: &[Ball], limits: &Limits) -> Advance {
        let [motion1, motion2] = &self.motions;
        let border = f64::from(body.border);
        let pivot = motion2.point(Vec3::from_vector(body.center));
        let axis = Vec3::from_vector(body.axis);
        let spin = motion2.angular_velocity();
        let corners: [Corner; 3] = std::array::from_fn(|i| {
            let (center, radius) = balls[i.min(balls.len() - 1)];
            let path = motion1.point(center);
            Corner {
                path,
                radius: radius + border,
                speed: path.speed_with(&pivot),
            }
        });
        let corners = &corners[..balls.len().min(3)];
        let largest = |size: fn(&Corner) -> f64| corners.iter().map(size).fold(0.0, f64::max);
        // No point of the body moves faster against its centre than this.
        let own = motion2.angle() * body.reach();
        let speed = (largest(|c| c.speed) + own).max(f64::MIN_POSITIVE);
        let mut known = Advance {
            lower: limits.start,
            met: false,
            separated: false,
            slack: 0.0,
            near: body.nearest(
                &Place {
                    origin: Vec3::zero(),
                    axis,
                },
                &[],
            ),
            place: Place {
                origin: Vec3::zero(),
                axis,
            },
        };
        for _ in 0..limits.steps {
            let t = known.lower;
            let turned = [motion1.sin_cos(t), motion2.sin_cos(t)];
            let center = pivot.at(t, turned[1]);
            let place = Place {
                origin: center.position,
                axis: unit(motion2.direction(axis, turned[1])),
            };
            let states = corners.iter().map(|c| c.path.at(t, turned[0]));
            let mut at = [(Vec3::zero(), 0.0); 3];
            let mut rates = [Vec3::zero(); 3];
            for (i, (state, c)) in states.zip(corners).enumerate() {
                let p = state.position - center.position;
                at[i] = (p, c.radius);
                rates[i] = state.velocity - center.velocity - spin.cross(p);
            }
            let at = &at[..corners.len()];
            let distances = at.iter().map(|b| b.0.length());
            let far = distances.fold(0.0, f64::max);
            let arms = largest(|c| c.path.arm()) + pivot.arm() + self.pivots;
            let size = body.reach() + largest(|c| c.radius) + far + speed + arms;
            known.slack = ULPS * f64::EPSILON * size;
            known.near = body.nearest(&place, at);
            known.place = place;
            let tolerance = limits.tolerance.max(TOLERANCE_PER_SLACK * known.slack);
            if known.near.distance() - limits.target <= tolerance - known.slack {
                known.met = true;
                return known;
            }
            let m = known.near.direction;
            let support = body.support(&place, m);
            let left = limits.horizon - t;
            let mut least = f64::MAX;
            let mut step = f64::MAX;
            for ((p, corner), rate) in at.iter().zip(corners).zip(rates) {
                let gap = m.dot(p.0) - p.1 - support - limits.target - known.slack;
                least = least.min(gap);
                let turn = motion2.angle();
                let farthest = p.0.length() + corner.speed * left;
                let bend = corner.path.acceleration
                    + pivot.acceleration
                    + 2.0 * turn * corner.speed
                    + turn * turn * farthest;
                step = step.min(first_root(gap, m.dot(rate), bend));
            }
            // The zero direction: the distance is never below minus the largest radius.
            if -largest(|c| c.radius) - limits.target > known.slack {
                step = f64::MAX;
            }
            let step = step.max(least / speed) * (1.0 - 8.0 * f64::EPSILON);
            let next = (t + step) * (1.0 - 4.0 * f64::EPSILON);
            if step > 0.0 && next >= limits.horizon {
                known.separated = true;
                known.lower = limits.horizon;
                return known;
            }
            if next.is_nan() || next <= t {
                return known;
            }
            known.lower = next;
        }
        known
    }

    fn answer(&self, bodies: &[Turned], origin: Vec3<f64>) -> Toi {
        let separated = Toi::separated(self.options);
        let tolerance = self.tolerance as Real;
        let Some(found) = self.found else {
            return Toi {
                tolerance,
                ..separated
            };
        };
        let exact = self.lower;
        let mut lower = exact as Real;
        if f64::from(lower) > exact {
            lower = lower.next_down();
        }
        let unresolved = self.status == ToiStatus::Unresolved;
        let border = bodies
            .get(found.primitives[1] as usize)
            .map_or(0.0, |b| b.border);
        let NearBall { ball, apart, .. } = found.near;
        // A centre inside the body has no direction of its own: away from the body's centre.
        let out = [found.near.direction, ball.0, found.place.axis]
            .into_iter()
            .find(|v| v.length_sq() > 0.0)
            .map_or(Vec3::zero(), unit);
        let world = |p: Vec3<f64>| (p + found.place.origin + origin).to_vector();
        let foot = ball.0 - out * apart;
        let points = [
            ball.0 - out * (ball.1 - f64::from(border)),
            foot + out * f64::from(border),
        ];
        let normal: Vector = (-out).to_vector();
        Toi {
            status: self.status,
            lower,
            upper: if unresolved {
                self.upper as Real
            } else {
                lower
            },
            tolerance,
            normal,
            spheres: [
                MedialSphere::new(world(ball.0), ball.1 as Real - border),
                MedialSphere::new(world(foot), border),
            ],
            points: points.map(world),
            primitives: found.primitives,
            ..separated
        }
    }
}

#[derive(Clone, Copy)]
struct Corner {
    path: PointPath<f64>,
    /// Of the sphere, with the body's border.
    radius: f64,
    /// Bound of its speed against the body's centre.
    speed: f64,
}

fn unit(v: Vec3<f64>) -> Vec3<f64> {
    let length = v.length();
    if length > 0.0 { v * (1.0 / length) } else { v }
}

/// First `s > 0` with `gap + rate s − bend s²/2 ≤ 0`; 0 where `gap` is not positive.
fn first_root(gap: f64, rate: f64, bend: f64) -> f64 {
    if gap.is_nan() || gap <= 0.0 {
        return 0.0;
    }
    let root = (rate * rate + 2.0 * bend * gap).sqrt();
    if rate < 0.0 {
        2.0 * gap / (root - rate)
    } else if bend > 0.0 {
        (rate + root) / bend
    } else {
        f64::MAX
    }
}
