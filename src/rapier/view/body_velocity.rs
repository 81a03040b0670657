//! Velocities of a body as rapier has them at the start of a step, and what forces add to them.

use crate::math::{Real, Vector};
use crate::rapier::view::link_angles::shortest;
use rapier3d::dynamics::{RigidBody, RigidBodyType};

/// Acceleration of a dynamic body by gravity and the user's forces: none along axes that are locked.
pub fn forces_per_mass(body: &RigidBody, gravity: Vector) -> Vector {
    let inverse_mass = body.mass_properties().effective_inv_mass;
    let free = inverse_mass.map(|inverse| if inverse > 0.0 { 1.0 } else { 0.0 });
    gravity * free * body.gravity_scale() + body.user_force() * inverse_mass
}

/// Linear and angular velocity of a body. A fixed body that was built with a velocity stands, as in rapier.
pub fn velocity(body: &RigidBody) -> [Vector; 2] {
    match body.is_fixed() {
        true => [Vector::ZERO; 2],
        false => [body.linvel(), body.angvel()],
    }
}

/// Linear and angular velocity with which a body starts into a step of `dt` seconds. Of a body that is
/// driven by its position rapier computes them only in its step.
pub fn velocities(body: &RigidBody, dt: Real) -> [Vector; 2] {
    if body.body_type() != RigidBodyType::KinematicPositionBased {
        return velocity(body);
    }
    let (start, end) = (body.position(), body.next_position());
    let com = body.mass_properties().local_mprops.local_com;
    let turn = shortest(end.rotation * start.rotation.inverse());
    [*end * com - *start * com, turn.to_scaled_axis()].map(|moved| moved / dt)
}
