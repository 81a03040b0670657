//! The impulse of one impact: Newton's restitution, Coulomb's friction, exact lever arms.
//!
//! Let `v = (v2 + ω2 × r2) − (v1 + ω1 × r1)` be the relative velocity at the contact. An impulse `j` adds `K j`
//! to it; for two bodies without joints
//! `K u = (m1⁻¹ + m2⁻¹) u + (I1⁻¹ (r1 × u)) × r1 + (I2⁻¹ (r2 × u)) × r2`.
//! With the effective inverse mass `k(u) = u · K u`, the normal impulse that takes `v·n` to `v'` is
//! `j = (v' − v·n) / k(n)`. Friction takes the sliding velocity towards 0, with an impulse of at most `μ j`, and of no
//! more than adds no energy to what the normal impulse leaves.

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

    /// The largest share of the friction that adds no energy to what the normal impulse leaves. That impulse may have
    /// stopped or turned round the slide, and friction would push along with it (Kane and Levinson, Dynamics, 1985): a
    /// heap of elastic bodies would fly apart, and a body on a slanted rail be driven back from its stop.
    ///
    /// The work of a friction `f j`, where the relative velocity is `v`, is `f j·v + f² j·(K j) / 2`.
    fn harmless_share(&self, v: Vector, normal: Vector, friction: Vector) -> Real {
        let gained = friction.dot(v + self.effect(normal));
        let spent = 0.5 * friction.dot(self.effect(friction));
        (-gained / spent.max(Real::MIN_POSITIVE)).clamp(0.0, 1.0)
    }
}
