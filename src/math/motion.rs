//! Rigid motion over one step in the pair's own frame, and how far its points leave straight paths.
//!
//! A point at offset `ρ` from the centre of rotation moves as
//! `c(t) = p + v t + ρ∥ + ρ⊥ cos ωt + (a × ρ) sin ωt` with axis `a`, so its acceleration has the
//! length `ω²|ρ⊥|` and its jerk `ω³|ρ⊥|` at all times. The chord of a path with acceleration at
//! most `A` is never further from it than `A/8` over a step of length 1 (the sagitta).

use super::lane::{Scalar, Vec3};
use super::{Real, Rotation, Vector};
use parry3d::query::NonlinearRigidMotion;

/// How far a point at distance 1 from the centre moves by the turn from one rotation to another, at most: `2 sin(θ/2)`
/// for an angle `θ`. Computed from its sine, since a cosine in single precision tells no angle below a thousandth from
/// 0.
pub fn chord(from: Rotation, to: Rotation) -> Real {
    let turn = from.inverse() * to;
    2.0 * Vector::new(turn.x, turn.y, turn.z).length()
}

/// A rigid motion over a step; times are fractions of the step, in `[0, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct RigidMotion<S> {
    /// Position of the centre of rotation at the start, in the pair's frame.
    center: Vec3<S>,
    /// Displacement of the centre over the step, a length.
    displacement: Vec3<S>,
    /// Unit axis of rotation; any unit vector when there is none.
    axis: Vec3<S>,
    /// Angle turned in the step, in radians, ≥ 0.
    angle: S,
    /// Columns of the rotation at the start.
    columns: [Vec3<S>; 3],
    /// Change of the columns over a step of straight paths; zero where the motion is rigid.
    drift: [Vec3<S>; 3],
    /// Centre of rotation in the body's frame.
    local_center: Vec3<S>,
    /// Sizes of the numbers that `center` is a sum of: they may cancel, their rounding does not.
    terms: S,
}

/// Path of one point of a [`RigidMotion`].
#[derive(Clone, Copy, Debug)]
pub struct PointPath<S> {
    base: Vec3<S>,
    displacement: Vec3<S>,
    across: Vec3<S>,
    turned: Vec3<S>,
    angle: S,
    /// Sizes of the numbers that positions are sums of, but for the displacement.
    terms: S,
    /// Length of the acceleration: `ω²|ρ⊥|`.
    pub acceleration: S,
    /// Length of the jerk: `ω³|ρ⊥|`.
    pub jerk: S,
}

/// Pose of a body at one time of its motion.
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    /// Position of the centre of rotation.
    pub center: Vec3<S>,
    /// Columns of the rotation.
    columns: [Vec3<S>; 3],
    /// Centre of rotation in the body's frame.
    local_center: Vec3<S>,
}

impl<S: Scalar> Frame<S> {
    /// Arm from the centre of rotation to a point given in the body's frame, world axes.
    #[inline]
    pub fn arm(&self, local: Vec3<S>) -> Vec3<S> {
        rotate(&self.columns, local - self.local_center)
    }

    /// A point given in the body's frame.
    pub fn point(&self, local: Vec3<S>) -> Vec3<S> {
        self.center + self.arm(local)
    }

    /// The point of the body's frame that is at a place, where the motion is rigid.
    pub fn local(&self, place: Vec3<S>) -> Vec3<S> {
        self.local_center + self.local_direction(place - self.center)
    }

    /// The direction of the body's frame that points along one, where the motion is rigid.
    pub fn local_direction(&self, n: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = &self.columns;
        Vec3::new(x.dot(n), y.dot(n), z.dot(n))
    }

    /// Upper bound on the angle of the rotation between two poses, in radians: `2 tan(θ/2)`, infinite at a half turn.
    /// The difference of two rotations has the Frobenius norm `2√2 sin(θ/2)`.
    pub fn angle_at_most(&self, other: &Self) -> S {
        let off = |k: usize| (self.columns[k] - other.columns[k]).length_sq();
        let square = (off(0) + off(1) + off(2)) * S::splat(0.125);
        let rest = (S::one() - square).max(S::zero());
        (square / rest).sqrt() * S::splat(2.0)
    }

    /// Rows of the matrix that does so: where the axes and the origin go.
    pub fn rows(&self) -> [[S; 4]; 3] {
        let [x, y, z] = &self.columns;
        let origin = self.point(Vec3::zero());
        let row = |of: fn(&Vec3<S>) -> S| [of(x), of(y), of(z), of(&origin)];
        [row(|v| v.x), row(|v| v.y), row(|v| v.z)]
    }
}

/// Position, velocity and acceleration of a point, per step.
#[derive(Clone, Copy, Debug)]
pub struct PointState<S> {
    /// Position.
    pub position: Vec3<S>,
    /// Velocity, per step.
    pub velocity: Vec3<S>,
    /// Acceleration, per step squared.
    pub acceleration: Vec3<S>,
}

impl<S: Scalar> RigidMotion<S> {
    /// Two motions in a common frame that has its origin at the first body's and does not rotate,
    /// and moves with the second body's linear velocity. Positions and velocities are subtracted
    /// before anything else, so that large coordinates cost no digits.
    pub fn pair(
        motion1: &NonlinearRigidMotion,
        motion2: &NonlinearRigidMotion,
        seconds: S,
    ) -> [Self; 2] {
        let v = Vec3::<S>::from_vector;
        let offset = v(motion2.start.translation) - v(motion1.start.translation);
        let drift = (v(motion1.linvel) - v(motion2.linvel)) * seconds;
        [
            Self::new(motion1, Vec3::zero(), drift, seconds),
            Self::new(motion2, offset, Vec3::zero(), seconds),
        ]
    }

    /// One motion in world space.
    pub fn alone(motion: &NonlinearRigidMotion, seconds: S) -> Self {
        let v = Vec3::<S>::from_vector;
        let origin = v(motion.start.translation);
        Self::new(motion, origin, v(motion.linvel) * seconds, seconds)
    }

    fn new(
        motion: &NonlinearRigidMotion,
        origin: Vec3<S>,
        displacement: Vec3<S>,
        seconds: S,
    ) -> Self {
        let columns = rotation_columns::<S>(motion.start.rotation);
        let local_center = Vec3::from_vector(motion.local_center);
        let omega = Vec3::<S>::from_vector(motion.angvel) * seconds;
        let angle = omega.length();
        let turning = S::splat(S::TINY).lt(angle);
        let inverse = S::one() / S::select(turning, angle, S::one());
        let any = Vec3::new(S::one(), S::zero(), S::zero());
        Self {
            center: origin + rotate(&columns, local_center),
            displacement,
            axis: Vec3::select(turning, omega * inverse, any),
            angle: S::select(turning, angle, S::zero()),
            columns,
            drift: [Vec3::zero(); 3],
            local_center,
            terms: origin.length() + local_center.length(),
        }
    }

    /// The motion in which each point goes straight from where this one starts it to where it ends
    /// (paper, Eq. 1): affine, not rigid, and a turning body shrinks half-way.
    pub fn straightened(&self) -> Self {
        let turned = self.sin_cos(S::one());
        Self {
            angle: S::zero(),
            drift: self
                .columns
                .map(|column| self.turn(column, turned) - column),
            ..*self
        }
    }

    /// Path of a point given in the body's frame.
    #[inline]
    pub fn point(&self, local: Vec3<S>) -> PointPath<S> {
        let rho = rotate(&self.columns, local - self.local_center);
        let along = self.axis * self.axis.dot(rho);
        let across = rho - along;
        let acceleration = self.angle * self.angle * across.length();
        PointPath {
            base: self.center + along,
            displacement: self.displacement + rotate(&self.drift, local - self.local_center),
            across,
            turned: self.axis.cross(rho),
            angle: self.angle,
            terms: self.terms + rho.length(),
            acceleration,
            jerk: acceleration * self.angle,
        }
    }

    /// A direction given in the body's frame, turned until the time of [`Self::sin_cos`].
    pub fn direction(&self, local: Vec3<S>, turned: (S, S)) -> Vec3<S> {
        self.turn(rotate(&self.columns, local), turned)
    }

    /// A vector turned about the axis.
    fn turn(&self, rho: Vec3<S>, (sin, cos): (S, S)) -> Vec3<S> {
        let along = self.axis * self.axis.dot(rho);
        along + (rho - along) * cos + self.axis.cross(rho) * sin
    }

    /// Pose of the body at `t`, as a frame.
    pub fn frame(&self, t: S) -> Frame<S> {
        let turned = self.sin_cos(t);
        Frame {
            center: self.center + self.displacement * t,
            columns: [0, 1, 2].map(|k| self.turn(self.columns[k], turned) + self.drift[k] * t),
            local_center: self.local_center,
        }
    }

    /// Whether it keeps the shape of a body, as all do that are not [`Self::straightened`].
    pub fn is_rigid(&self) -> bool {
        self.drift.iter().all(|d| d.taxicab() <= S::zero())
    }

    /// Place and velocity of the centre of rotation at `t`.
    pub fn center_at(&self, t: S) -> [Vec3<S>; 2] {
        [self.center + self.displacement * t, self.displacement]
    }

    /// Length of the acceleration of a point, given its [`Frame::arm`] at any time, per step squared.
    pub fn acceleration(&self, arm: Vec3<S>) -> S {
        self.angle * self.angle * self.axis.cross(arm).length()
    }

    /// Angular velocity, in radians per step.
    pub fn angular_velocity(&self) -> Vec3<S> {
        self.axis * self.angle
    }

    /// Sizes of the numbers that the centre of rotation is a sum of.
    pub fn terms(&self) -> S {
        self.terms
    }

    /// Angle turned in the step, in radians.
    pub fn angle(&self) -> S {
        self.angle
    }

    /// Sine and cosine of the angle turned until `t`.
    #[inline(always)]
    pub fn sin_cos(&self, t: S) -> (S, S) {
        (self.angle * t).sin_cos()
    }
}

impl<S: Scalar> PointPath<S> {
    /// State at `t`, given the motion's [`RigidMotion::sin_cos`] at `t`.
    #[inline(always)]
    pub fn at(&self, t: S, (sin, cos): (S, S)) -> PointState<S> {
        let offset = self.across * cos + self.turned * sin;
        let swing = self.turned * cos - self.across * sin;
        PointState {
            position: self.base + self.displacement * t + offset,
            velocity: self.displacement + swing * self.angle,
            acceleration: -(offset * (self.angle * self.angle)),
        }
    }
}

impl<S: Scalar> PointPath<S> {
    /// Bound of the relative speed of two points, per step.
    pub fn speed_with(&self, other: &Self) -> S {
        (self.displacement - other.displacement).length() + self.swing() + other.swing()
    }

    /// Largest speed that the rotation alone gives.
    fn swing(&self) -> S {
        self.angle * self.across.length()
    }

    /// Sizes of the numbers that positions are sums of, but for the displacement: of the body's origin
    /// in the pair's frame, of its centre of rotation in its own, and of the arm from there.
    pub fn terms(&self) -> S {
        self.terms
    }
}

/// Columns of a rotation matrix, from a quaternion normalised in `S`.
pub(crate) fn rotation_columns<S: Scalar>(q: Rotation) -> [Vec3<S>; 3] {
    let [x, y, z, w] = [q.x, q.y, q.z, q.w].map(S::from_real);
    let two = S::splat(2.0) / (x * x + y * y + z * z + w * w);
    let one = S::one();
    [
        Vec3::new(
            one - two * (y * y + z * z),
            two * (x * y + w * z),
            two * (x * z - w * y),
        ),
        Vec3::new(
            two * (x * y - w * z),
            one - two * (x * x + z * z),
            two * (y * z + w * x),
        ),
        Vec3::new(
            two * (x * z + w * y),
            two * (y * z - w * x),
            one - two * (x * x + y * y),
        ),
    ]
}

#[inline(always)]
fn rotate<S: Scalar>(columns: &[Vec3<S>; 3], v: Vec3<S>) -> Vec3<S> {
    columns[0] * v.x + columns[1] * v.y + columns[2] * v.z
}
