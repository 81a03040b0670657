//! [`Inertia`]: how a body resists impulses, with its locked axes.

use crate::math::{Real, Vector};
use crate::rapier::view::motion::Body;
use parry3d::math::AngularInertia;
use rapier3d::dynamics::LockedAxes;

/// Resistance to an impulse: inverse mass along the world's axes and inverse inertia, world frame.
#[derive(Clone, Copy)]
pub struct Inertia {
    mass: Vector,
    angular: AngularInertia,
}

impl Inertia {
    /// Inertia of a body that nothing moves.
    pub const INFINITE: Self = Self {
        mass: Vector::ZERO,
        angular: AngularInertia {
            m11: 0.0,
            m12: 0.0,
            m13: 0.0,
            m22: 0.0,
            m23: 0.0,
            m33: 0.0,
        },
    };

    /// Inertia of a free body where it is now, as if it had no locked axes.
    pub fn unlocked(body: &Body) -> Self {
        Self {
            mass: Vector::splat(body.mass.inv_mass),
            angular: body.mass.world_inv_inertia(&body.motion.start.rotation),
        }
    }

    /// Inertia of a free body where it is now.
    pub fn of(body: &Body) -> Self {
        let mut i = Self::unlocked(body).angular;
        if body.locked.contains(LockedAxes::ROTATION_LOCKED_X) {
            (i.m11, i.m12, i.m13) = (0.0, 0.0, 0.0);
        }
        if body.locked.contains(LockedAxes::ROTATION_LOCKED_Y) {
            (i.m12, i.m22, i.m23) = (0.0, 0.0, 0.0);
        }
        if body.locked.contains(LockedAxes::ROTATION_LOCKED_Z) {
            (i.m13, i.m23, i.m33) = (0.0, 0.0, 0.0);
        }
        Self {
            mass: body.inverse_mass,
            angular: i,
        }
    }

    /// Change of linear and angular velocity by an impulse and an impulsive torque at the centre of mass.
    pub fn apply(&self, [impulse, torque]: [Vector; 2]) -> [Vector; 2] {
        [self.mass * impulse, self.angular * torque]
    }

    /// Mass along the world's axes; 0 where nothing moves it.
    pub fn masses(&self) -> Vector {
        let mass = |inverse: Real| if inverse > 0.0 { 1.0 / inverse } else { 0.0 };
        Vector::new(mass(self.mass.x), mass(self.mass.y), mass(self.mass.z))
    }

    /// Kinetic energy at these velocities, of what can move; of turning none where an axis is locked.
    pub fn energy(&self, [linear, angular]: [Vector; 2]) -> f64 {
        let per = |v: Real, inverse: Real| if inverse > 0.0 { v * v / inverse } else { 0.0 };
        let m = self.mass;
        let slide = per(linear.x, m.x) + per(linear.y, m.y) + per(linear.z, m.z);
        let spin = angular.dot(self.angular.inverse_unchecked() * angular);
        let spin = if spin.is_finite() { spin } else { 0.0 };
        0.5 * f64::from(slide + spin)
    }

    /// Whether nothing moves it.
    pub fn is_infinite(&self) -> bool {
        self.mass == Vector::ZERO && self.angular == Self::INFINITE.angular
    }
}
