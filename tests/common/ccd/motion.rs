//! Two bodies over one step, in double precision: where their spheres are at a time, and a hull
//! that contains their whole path over an interval of time.
//!
//! Straight paths: `c(t) = c + t d`. Rigid motion: parry's `NonlinearRigidMotion`, read from its
//! documentation: with `o = start · local_center`, a point `x` of the body is at
//! `o + t v + Rot(t ω) (start · x − o)`. Differences of positions and of displacements are formed
//! first, so that far-away bodies lose no digits.

use super::distance::Corners;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// A sphere, on a straight path where that is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre at the start: in world space on a straight path, in the body's frame otherwise.
    pub center: Vector3<f64>,
    /// Radius.
    pub radius: f64,
    /// Change of the centre over the step; not used in rigid motion.
    pub displacement: Vector3<f64>,
}

/// Rigid motion as parry's, in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// Translation of the start pose.
    pub translation: Vector3<f64>,
    /// Quaternion of the start pose, `[x, y, z, w]`, used normalised.
    pub rotation: [f64; 4],
    /// Point of the body that it turns about, in its frame.
    pub local_center: Vector3<f64>,
    /// Velocity of that point, per second.
    pub linvel: Vector3<f64>,
    /// Angular velocity, radians per second.
    pub angvel: Vector3<f64>,
}

/// How both bodies move.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Every sphere's centre on its own straight path.
    Straight,
    /// Both bodies rigid, over a step of this many seconds.
    Rigid(Box<[Rigid; 2]>, f64),
}

/// Two primitives over one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// Spheres of the two bodies: 1 to 3 each.
    pub balls: [Vec<Ball>; 2],
    /// Their motion.
    pub motion: Motion,
}

impl Query {
    /// Applies `f` to every number.
    pub fn map(&mut self, f: &dyn Fn(f64) -> f64) {
        for ball in self.balls.iter_mut().flatten() {
            ball.center = ball.center.map(f);
            ball.radius = f(ball.radius);
            ball.displacement = ball.displacement.map(f);
        }
        if let Motion::Rigid(motions, seconds) = &mut self.motion {
            *seconds = f(*seconds);
            for motion in motions.iter_mut() {
                motion.translation = motion.translation.map(f);
                motion.rotation = motion.rotation.map(f);
                motion.local_center = motion.local_center.map(f);
                motion.linvel = motion.linvel.map(f);
                motion.angvel = motion.angvel.map(f);
            }
        }
    }

    /// Multiplies every length.
    pub fn scale(&mut self, factor: f64) {
        for ball in self.balls.iter_mut().flatten() {
            ball.center *= factor;
            ball.radius *= factor;
            ball.displacement *= factor;
        }
        if let Motion::Rigid(motions, _) = &mut self.motion {
            for motion in motions.iter_mut() {
                motion.translation *= factor;
                motion.local_center *= factor;
                motion.linvel *= factor;
            }
        }
    }

    /// Moves one body for the whole step.
    pub fn shift(&mut self, body: usize, by: Vector3<f64>) {
        match &mut self.motion {
            Motion::Straight => self.balls[body]
                .iter_mut()
                .for_each(|ball| ball.center += by),
            Motion::Rigid(motions, _) => motions[body].translation += by,
        }
    }

    /// Changes one body's displacement over the step, and leaves it in place at time `at`.
    pub fn speed_up(&mut self, body: usize, by: Vector3<f64>, at: f64) {
        match &mut self.motion {
            Motion::Straight => {
                self.balls[body]
                    .iter_mut()
                    .for_each(|ball| ball.displacement += by);
            }
            Motion::Rigid(motions, seconds) => motions[body].linvel += by / *seconds,
        }
        self.shift(body, -by * at);
    }

    /// Makes the step one of length zero.
    pub fn stop(&mut self) {
        match &mut self.motion {
            Motion::Straight => {
                let balls = self.balls.iter_mut().flatten();
                balls.for_each(|ball| ball.displacement = Vector3::zeros());
            }
            Motion::Rigid(_, seconds) => *seconds = 0.0,
        }
    }

    /// The same start and end on straight paths, as the paper assumes.
    pub fn straightened(&self) -> Self {
        let Motion::Rigid(motions, seconds) = &self.motion else {
            return self.clone();
        };
        let place = |i: usize| {
            let ends = |ball: &Ball| {
                let [start, end] = [0.0, *seconds].map(|t| motions[i].place(&ball.center, t));
                Ball {
                    center: start,
                    radius: ball.radius,
                    displacement: end - start,
                }
            };
            self.balls[i].iter().map(ends).collect()
        };
        Self {
            balls: [place(0), place(1)],
            motion: Motion::Straight,
        }
    }
}

impl Rigid {
    fn start(&self) -> UnitQuaternion<f64> {
        let [x, y, z, w] = self.rotation;
        UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
    }

    /// Where a point of the body is after some seconds, in world space.
    pub fn place(&self, point: &Vector3<f64>, seconds: f64) -> Vector3<f64> {
        let start = self.start();
        let turn = UnitQuaternion::from_scaled_axis(self.angvel * seconds);
        let center = self.translation + start * self.local_center;
        center + self.linvel * seconds + turn * (start * (point - self.local_center))
    }
}

/// One body, ready to be placed: offsets from a centre that moves straight, turned.
struct Body {
    offsets: [Vector3<f64>; 3],
    displacements: [Vector3<f64>; 3],
    radii: [f64; 3],
    count: usize,
    turn: Vector3<f64>,
}

/// A query prepared for evaluation.
pub struct Paths {
    bodies: [Body; 2],
    /// Centre of the first body less that of the second, at the start and its change.
    center: Vector3<f64>,
    shift: Vector3<f64>,
    /// Sizes of what `center` is a sum of.
    terms: f64,
}

/// Rounding of any value below, in units of [`Paths::reach`]. A corner is a sum of 5 rounded
/// terms, each a product of at most 6 rounded factors (the turned offsets); a bound of the distance
/// adds 18 weighted corners. Each operation loses at most 2⁻⁵³ of the reach; 64 × 2⁻⁵² is above
/// the total of 5 + 6 + 2 × 18 of them.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Paths {
    /// Prepares a query.
    pub fn new(query: &Query) -> Self {
        let zero = Vector3::zeros();
        match &query.motion {
            Motion::Straight => {
                let origin = query.balls[1][0].center;
                let body = |balls: &[Ball]| {
                    let mut body = Body::new(balls, zero);
                    for (k, ball) in balls.iter().enumerate() {
                        body.offsets[k] = ball.center - origin;
                        body.displacements[k] = ball.displacement;
                    }
                    body
                };
                let bodies = [body(&query.balls[0]), body(&query.balls[1])];
                Self {
                    bodies,
                    center: zero,
                    shift: zero,
                    terms: 0.0,
                }
            }
            Motion::Rigid(motions, seconds) => {
                let mut arms = [zero; 2];
                let mut bodies = [0, 1].map(|i| Body::new(&query.balls[i], zero));
                for i in 0..2 {
                    let motion = &motions[i];
                    let start = motion.start();
                    arms[i] = start * motion.local_center;
                    bodies[i].turn = motion.angvel * *seconds;
                    for (k, ball) in query.balls[i].iter().enumerate() {
                        bodies[i].offsets[k] = start * (ball.center - motion.local_center);
                    }
                }
                Self {
                    bodies,
                    center: (motions[0].translation - motions[1].translation) + (arms[0] - arms[1]),
                    shift: (motions[0].linvel - motions[1].linvel) * *seconds,
                    terms: arms[0].norm()
                        + arms[1].norm()
                        + (motions[0].translation - motions[1].translation).norm(),
                }
            }
        }
    }

    /// Corners at time `t`.
    pub fn at(&self, t: f64) -> Corners {
        let mut corners = Corners::new();
        self.push(t, 0.0, &mut corners);
        corners
    }

    /// Corners whose hull contains the corners at all times from `start` to `end`: those at both
    /// ends, grown by how far a path may leave its chord. A path with acceleration at most `A`
    /// leaves it by at most `A h² / 8` (and an arc by at most its radius, `2ρ` for both bounds).
    pub fn over(&self, start: f64, end: f64) -> Corners {
        let h = end - start;
        let sagitta: f64 = self
            .bodies
            .iter()
            .map(|body| body.acceleration() * h * h / 8.0)
            .sum();
        let mut corners = Corners::new();
        self.push(start, sagitta, &mut corners);
        self.push(end, sagitta, &mut corners);
        corners
    }

    /// Velocity of the difference of two interpolated spheres at `t`; `weights` in the order of
    /// the corners.
    pub fn velocity(&self, t: f64, weights: &[f64]) -> Vector3<f64> {
        let rates = [0, 1].map(|i| {
            let body = &self.bodies[i];
            let turned = body.turned(t);
            [0, 1, 2].map(|k| body.displacements[k] + body.turn.cross(&turned[k]))
        });
        let mut velocity = self.shift;
        let columns = self.bodies[1].count;
        for i in 0..self.bodies[0].count {
            for j in 0..columns {
                velocity += (rates[0][i] - rates[1][j]) * weights[i * columns + j];
            }
        }
        velocity
    }

    /// Whether no sphere of either body has a radius.
    pub fn is_thin(&self) -> bool {
        self.bodies
            .iter()
            .flat_map(|body| body.radii)
            .all(|radius| radius == 0.0)
    }

    /// How many spheres each body has.
    pub fn counts(&self) -> [usize; 2] {
        self.bodies.each_ref().map(|body| body.count)
    }

    /// How much any value computed here may be wrong by rounding.
    pub fn rounding(&self) -> f64 {
        let reach = self.bodies.iter().map(Body::reach).sum::<f64>();
        ROUNDING * (reach + self.terms + self.shift.norm())
    }

    fn push(&self, t: f64, grow: f64, corners: &mut Corners) {
        let placed = [0, 1].map(|i| {
            let body = &self.bodies[i];
            let turned = body.turned(t);
            [0, 1, 2].map(|k| turned[k] + body.displacements[k] * t)
        });
        let center = self.center + self.shift * t;
        for i in 0..self.bodies[0].count {
            for j in 0..self.bodies[1].count {
                let radius = self.bodies[0].radii[i] + self.bodies[1].radii[j];
                corners.push(center + (placed[0][i] - placed[1][j]), radius + grow);
            }
        }
    }
}

impl Body {
    fn new(balls: &[Ball], zero: Vector3<f64>) -> Self {
        let mut radii = [0.0; 3];
        for (radius, ball) in radii.iter_mut().zip(balls) {
            *radius = ball.radius;
        }
        Self {
            offsets: [zero; 3],
            displacements: [zero; 3],
            radii,
            count: balls.len(),
            turn: zero,
        }
    }

    fn turned(&self, t: f64) -> [Vector3<f64>; 3] {
        if self.turn == Vector3::zeros() {
            return self.offsets;
        }
        let rotation = UnitQuaternion::from_scaled_axis(self.turn * t);
        self.offsets.map(|offset| rotation * offset)
    }

    /// Bound of a sphere's acceleration: `ω² ρ⊥ = |ω × (ω × ρ)|`.
    fn acceleration(&self) -> f64 {
        let of = |offset: &Vector3<f64>| self.turn.cross(offset).norm() * self.turn.norm();
        self.offsets[..self.count]
            .iter()
            .map(of)
            .fold(0.0, f64::max)
    }

    fn reach(&self) -> f64 {
        (0..self.count)
            .map(|k| self.offsets[k].norm() + self.displacements[k].norm() + self.radii[k])
            .fold(0.0, f64::max)
    }
}
