//! The impulse of one impact: Newton's restitution, Coulomb's friction, exact lever arms.
//!
//! Let `v = (v2 + ω2 × r2) − (v1 + ω1 × r1)` be the relative velocity at the contact. An impulse `j` adds `K j`
//! to it; for two bodies without joints
//! `K u = (m1⁻¹ + m2⁻¹) u + (I1⁻¹ (r1 × u)) × r1 + (I2⁻¹ (r2 × u)) × r2`.
//! With the effective inverse mass `k(u) = u · K u`, the normal impulse that takes `v·n` to `v'` is
//! `j = (v' − v·n) / k(n)`. Friction takes the sliding velocity towards 0, with an impulse of at most `μ j`, and of no
//! more than leaves the impact without a gain of energy.

use crate::math::{Real, Vector};
use rapier3d::dynamics::CoefficientCombineRule;
use rapier3d::geometry::Collider;

/// Restitution and friction of two colliders, by rapier's combine rules.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// Coefficient of restitution.
    pub restitution: Real,
    /// Coefficient of friction.
    pub friction: Real,
}

impl Material {
    /// The material of two colliders together.
    pub fn of(a: &Collider, b: &Collider) -> Self {
        let (a, b) = (a.material(), b.material());
        let combine = CoefficientCombineRule::combine;
        Self {
            restitution: combine(
                a.restitution,
                b.restitution,
                a.restitution_combine_rule,
                b.restitution_combine_rule,
            ),
            friction: combine(
                a.friction,
                b.friction,
                a.friction_combine_rule,
                b.friction_combine_rule,
            ),
        }
    }
}

/// A contact between two bodies that may move.
#[derive(Clone, Copy)]
pub struct Impact {
    /// Unit normal from the first to the second.
    pub normal: Vector,
    /// Change of the relative velocity at the contact by unit impulses along the world's axes on the second body, and
    /// their negatives on the first.
    pub response: [Vector; 3],
    /// Restitution and friction.
    pub material: Material,
    /// Whether something takes part in the impact that nothing moves: locked axes of one of the bodies, or a driven
    /// body on which one of them hangs by joints. It makes up for what the normal impulse takes, so that friction may
    /// add nothing either.
    pub is_guided: bool,
}

impl Impact {
    /// Relative speed along the normal that a unit impulse along it gives.
    pub fn resistance(&self) -> Real {
        self.normal.dot(self.effect(self.normal))
    }

    /// The impulse on the second body (the first gets its negative) after which the bodies part with
    /// `least` or faster. `None` if they do so already, or nothing can move.
    ///
    /// `v`: relative velocity at the contact, of the second body against the first.
    pub fn impulse(&self, v: Vector, least: Real) -> Option<Vector> {
        let normal_speed = v.dot(self.normal);
        let k = |u: Vector| u.dot(self.effect(u));
        let resistance = self.resistance();
        if normal_speed >= least || resistance <= Real::MIN_POSITIVE {
            return None;
        }
        let after = (-self.material.restitution * normal_speed).max(least);
        let push = (after - normal_speed) / resistance;
        let slide = v - self.normal * normal_speed;
        let speed = slide.length();
        let mut impulse = self.normal * push;
        if speed > Real::MIN_POSITIVE {
            let u = slide / speed;
            let stop = speed / k(u).max(Real::MIN_POSITIVE);
            let friction = u * -stop.min(self.material.friction * push);
            impulse += friction * self.harmless_share(v, impulse, friction);
        }
        impulse.is_finite().then_some(impulse)
    }

    /// Change of the relative velocity at the contact by an impulse.
    fn effect(&self, impulse: Vector) -> Vector {
        let [x, y, z] = self.response;
        x * impulse.x + y * impulse.y + z * impulse.z
    }

    /// The largest share of the friction with which the impact gains no energy. With restitution by
    /// Newton's law and lever arms, friction can push against the velocity that the normal impulse has
    /// just made (Kane and Levinson, Dynamics, 1985); a heap of elastic bodies then flies apart. Where one is guided,
    /// friction would drive it back from a slanted stop that the normal impulse has stopped it at.
    ///
    /// The work of an impulse `j` is `j·v + j·(K j) / 2`, so that of `normal + f friction` is a
    /// quadratic in `f`.
    fn harmless_share(&self, v: Vector, normal: Vector, friction: Vector) -> Real {
        let after_normal = v + self.effect(normal);
        let a = 0.5 * friction.dot(self.effect(friction));
        let b = friction.dot(after_normal);
        // A normal impulse that pushes bodies apart may add energy, friction none to it.
        let c = match self.is_guided {
            true => 0.0,
            false => (0.5 * normal.dot(v + after_normal)).min(0.0),
        };
        if a + b + c <= 0.0 {
            return 1.0;
        }
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        // The positive root, without cancellation; a > 0 where b is not, by the test above.
        let share = if b > 0.0 {
            -2.0 * c / (b + root)
        } else {
            (root - b) / (2.0 * a)
        };
        share.clamp(0.0, 1.0)
    }
}
