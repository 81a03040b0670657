//! How long one primitive (1 to 3 interpolated spheres) is certainly apart from a cylinder or cone in exact rigid
//! motion, step by step until they touch. Source: conservative advancement (Mirtich 1996), with the bound of
//! [`crate::parry::partners::axisymmetric`] in place of a computed distance.
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
//! Where faces and edges meet, the distance has a kink, and another direction takes over at once: that of a face that
//! rolls over a rim turns with the face, that of two edges with neither. So `m` may turn with any `ν` as well: with
//! that of the primitive, or as it has turned since the step before. In that frame `ν` stands for `ω` above, and a
//! point `q` of the body, from its centre, moves with `(ω − ν) × q` and an acceleration of at most `(|ω × ν| + |ω −
//! ν|²) |q|`: its support along `m` is at most `h(m + s m × (ω − ν))` and half of that times `s²`. The bound is concave
//! in `s`, so between two times it is above its chord.
//!
//! # Rounding
//! Positions are sums of at most 16 rounded terms no larger than `scale`, the sum of all lengths in
//! play, so that `ULPS` ulps of it cover the bound. A tolerance below [`CHASE_TOLERANCE_PER_SLACK`] times
//! that slack is raised to it.

use crate::math::lane::Vec3;
use crate::math::motion::{PointPath, RigidMotion};
use crate::math::sphere::Ball;
use crate::parry::partners::axisymmetric::{AxisFrame, Axisymmetric, NearBall, unit};

/// Rounding slack in units of `f64::EPSILON × scale` (no unit); derived in the header, with a margin
/// of 4.
const ULPS: f64 = 64.0;

/// Smallest tolerance in units of the slack: one slack is lost in the bound, one in the test for
/// contact, and the last step needs room.
pub const CHASE_TOLERANCE_PER_SLACK: f64 = 4.0;

/// Chords that narrow down when a direction that turns no longer keeps the two apart. Not tuned; only speed depends on
/// it.
const CHORDS: usize = 4;

/// Ratio of the times at which such a direction is tried, until one is found at which it fails. Not tuned; only speed
/// depends on it.
const WIDER: f64 = 4.0;

/// Limits of the time and the distance within which one volume is followed.
#[derive(Clone, Copy)]
pub struct ChaseLimits {
    /// Time until which the two are known to be free.
    pub start: f64,
    /// Contacts from here on are of no interest.
    pub horizon: f64,
    /// Signed distance that counts as contact, a length.
    pub target: f64,
    /// Distance from the target within which contact is told, a length.
    pub tolerance: f64,
    /// Cap of the iterations.
    pub steps: u32,
}

/// Knowledge of one volume: how far it is proven free.
pub struct Advance {
    /// Time before which there is no contact.
    pub lower: f64,
    /// Whether the two are within the tolerance of contact at `lower`.
    pub met: bool,
    /// Proven free up to the horizon.
    pub separated: bool,
    /// Iterations taken.
    pub steps: u32,
    /// Rounding slack, a length.
    pub slack: f64,
    /// Nearest sphere at `lower`, its radius with the body's border.
    pub near: NearBall,
    /// Placement of the body at that time.
    pub place: AxisFrame,
}

/// One corner sphere of the primitive, on its way.
#[derive(Clone, Copy)]
struct Corner {
    path: PointPath<f64>,
    /// Radius of the sphere, with the body's border.
    radius: f64,
    /// Bound of its speed against the body's centre.
    speed: f64,
}

/// Spheres and a body on their way, the spheres seen from the body's centre.
struct Chase<'a> {
    motions: &'a [RigidMotion<f64>; 2],
    body: &'a Axisymmetric,
    corners: [Corner; 3],
    count: usize,
    /// Path of the body's centre.
    pivot: PointPath<f64>,
    /// Axis of the body, in its frame.
    axis: Vec3<f64>,
    /// Bound of the speed of any sphere against any point of the body.
    speed: f64,
}

/// State of a [`Chase`] at a time.
struct Moment {
    place: AxisFrame,
    balls: [Ball; 3],
    /// Velocities of the spheres against the body's centre.
    rates: [Vec3<f64>; 3],
    /// Rounding slack, a length.
    slack: f64,
}

impl<'a> Chase<'a> {
    fn new(motions: &'a [RigidMotion<f64>; 2], body: &'a Axisymmetric, balls: &[Ball]) -> Self {
        let [motion1, motion2] = motions;
        let pivot = motion2.point(Vec3::from_vector(body.center));
        let corners: [Corner; 3] = std::array::from_fn(|i| {
            let Ball { center, radius } = balls[i.min(balls.len() - 1)];
            let path = motion1.point(center);
            Corner {
                path,
                radius: radius + f64::from(body.border),
                speed: path.speed_with(&pivot),
            }
        });
        let mut chase = Self {
            motions,
            body,
            corners,
            count: balls.len().min(3),
            pivot,
            axis: Vec3::from_vector(body.axis),
            speed: 0.0,
        };
        // No point of the body moves faster against its centre than this.
        let own = motion2.angle() * body.reach();
        chase.speed = (chase.largest(|c| c.speed) + own).max(f64::MIN_POSITIVE);
        chase
    }

    fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    fn largest(&self, size: fn(&Corner) -> f64) -> f64 {
        self.corners().iter().map(size).fold(0.0, f64::max)
    }

    fn at(&self, t: f64) -> Moment {
        let [motion1, motion2] = self.motions;
        let turned = [motion1.sin_cos(t), motion2.sin_cos(t)];
        let center = self.pivot.at(t, turned[1]);
        let mut balls = [Ball::new(Vec3::zero(), 0.0); 3];
        let mut rates = [Vec3::zero(); 3];
        for (i, c) in self.corners().iter().enumerate() {
            let state = c.path.at(t, turned[0]);
            let p = state.position - center.position;
            balls[i] = Ball::new(p, c.radius);
            rates[i] = state.velocity - center.velocity;
        }
        let distances = balls[..self.count].iter().map(|b| b.center.length());
        let far = distances.fold(0.0, f64::max);
        let arms = self.largest(|c| c.path.terms()) + self.pivot.terms();
        let size = self.body.reach() + self.largest(|c| c.radius) + far + self.speed + arms;
        Moment {
            place: AxisFrame {
                origin: center.position,
                axis: unit(motion2.direction(self.axis, turned[1])),
            },
            balls,
            rates,
            slack: ULPS * f64::EPSILON * size,
        }
    }

    /// Bound of a corner's acceleration seen from the body's centre within the time `left`, in a frame that turns by
    /// the angle `turn` in the step.
    fn bend(&self, corner: &Corner, p: Vec3<f64>, turn: f64, left: f64) -> f64 {
        let farthest = p.length() + corner.speed * left;
        corner.path.acceleration
            + self.pivot.acceleration
            + 2.0 * turn * corner.speed
            + turn * turn * farthest
    }

    /// Least gap of the spheres above the target along the direction `m` from the body, and a time up to which no gap
    /// closes within `left`, if `m` turns with the body.
    fn step(&self, moment: &Moment, m: Vec3<f64>, target: f64, left: f64) -> (f64, f64) {
        let support = self.body.support(&moment.place, m);
        let (turn, spin) = (self.motions[1].angle(), self.motions[1].angular_velocity());
        let (mut least, mut step) = (f64::MAX, f64::MAX);
        for ((p, corner), rate) in moment.balls.iter().zip(self.corners()).zip(moment.rates) {
            let gap = m.dot(p.center) - p.radius - support - target - moment.slack;
            least = least.min(gap);
            let rate = m.dot(rate - spin.cross(p.center));
            step = step.min(first_root(
                gap,
                rate,
                self.bend(corner, p.center, turn, left),
            ));
        }
        // The zero direction: the distance is never below minus the largest radius.
        if -self.largest(|c| c.radius) - target > moment.slack {
            step = f64::MAX;
        }
        (least, step)
    }

    /// The time for which no sphere closes its gap along `m` within `left`, if `m` turns with the angular velocity
    /// `spin`; found to within a few chords.
    fn step_turning(
        &self,
        moment: &Moment,
        (m, spin): (Vec3<f64>, Vec3<f64>),
        target: f64,
        left: f64,
    ) -> f64 {
        let (turn, of_body) = (spin.length(), self.motions[1].angular_velocity());
        let (against, aside) = (of_body - spin, of_body.cross(spin));
        let swing = m.cross(against);
        let swerve = (aside.length() + against.length_sq()) * self.body.reach();
        // How far each corner ends along `m`, how fast that changes, and the bound of its acceleration.
        let mut ends = [(f64::MAX, 0.0, 0.0); 3];
        let corners = moment.balls.iter().zip(self.corners()).zip(moment.rates);
        for (end, ((p, corner), rate)) in ends.iter_mut().zip(corners) {
            let rate = m.dot(rate - spin.cross(p.center));
            let bend = self.bend(corner, p.center, turn, left) + swerve;
            *end = (m.dot(p.center) - p.radius, rate, bend);
        }
        let ends = &ends[..self.count];
        // A time, and the least gap then.
        let gap = |s: f64| {
            let at = ends
                .iter()
                .map(|end| end.0 + end.1 * s - 0.5 * end.2 * s * s);
            let support = self.body.support(&moment.place, m + swing * s);
            (
                s,
                at.fold(f64::MAX, f64::min) - support - target - moment.slack,
            )
        };
        let mut free = gap(0.0);
        if free.1.is_nan() || free.1 <= 0.0 {
            return 0.0;
        }
        let bend = ends
            .iter()
            .map(|end| end.2)
            .fold(f64::MIN_POSITIVE, f64::max);
        let mut closed = gap((2.0 * free.1 / bend).sqrt().min(left));
        while closed.1 > 0.0 {
            if closed.0 >= left || closed.0 <= 0.0 {
                return closed.0;
            }
            free = closed;
            closed = gap((WIDER * free.0).min(left));
        }
        let chord = |free: (f64, f64), closed: (f64, f64)| {
            free.0 + (closed.0 - free.0) * (free.1 / (free.1 - closed.1))
        };
        for _ in 0..CHORDS {
            for middle in [false, true] {
                let time = match middle {
                    true => 0.5 * (free.0 + closed.0),
                    false => chord(free, closed),
                };
                match gap(time) {
                    end if end.1 > 0.0 => free = end,
                    end => closed = end,
                }
            }
        }
        chord(free, closed)
    }
}

/// Follows 1 to 3 interpolated spheres until they meet the body.
pub fn follow(
    motions: &[RigidMotion<f64>; 2],
    body: &Axisymmetric,
    balls: &[Ball],
    limits: &ChaseLimits,
) -> Advance {
    let chase = Chase::new(motions, body, balls);
    let place = AxisFrame {
        origin: Vec3::zero(),
        axis: chase.axis,
    };
    let mut known = Advance {
        lower: limits.start,
        met: false,
        separated: false,
        steps: 0,
        slack: 0.0,
        near: body.nearest(&place, &[]),
        place,
    };
    let mut before: Option<(f64, Vec3<f64>)> = None;
    while known.steps < limits.steps {
        known.steps += 1;
        let t = known.lower;
        let moment = chase.at(t);
        known.slack = moment.slack;
        known.near = body.nearest(&moment.place, &moment.balls[..chase.count]);
        known.place = moment.place;
        let tolerance = limits
            .tolerance
            .max(CHASE_TOLERANCE_PER_SLACK * known.slack);
        if known.near.distance() - limits.target <= tolerance - known.slack {
            known.met = true;
            return known;
        }
        let left = limits.horizon - t;
        let (least, step) = chase.step(&moment, known.near.direction, limits.target, left);
        let mut step = step.max(least / chase.speed);
        // The distance of a single ball has no kink.
        if chase.count > 1 {
            let m = known.near.direction;
            let since = before.replace((t, m));
            let lately = since.map(|(then, old)| old.cross(m) * (1.0 / (t - then)));
            let spins = [Some(motions[0].angular_velocity()), lately];
            for spin in spins.into_iter().flatten() {
                if step < left {
                    step = step.max(chase.step_turning(&moment, (m, spin), limits.target, left));
                }
            }
        }
        let step = step * (1.0 - 8.0 * f64::EPSILON);
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
