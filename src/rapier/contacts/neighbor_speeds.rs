//! Bounds how fast the neighbours of a collider may push it within a step, to know how far away its contacts must
//! be looked for. The velocities of a pair do not tell what a third body does to it, since the solver passes a push
//! on from contact to contact. There is no such bound for what joints pass on.

use crate::math::Real;
use crate::medial::MedialMesh;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::motion::velocities;
use crate::rapier::view::participants::enabled;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::geometry::Collider;

/// Bodies that a push goes through in a step. A chain of equal balls would hand it on for ever; a heap
/// shares it out.
const MAX_HOPS: usize = 3;

/// Moving colliders that are not medial: their boxes, as far as contacts are looked for, and bounds on the
/// speed of their points.
pub fn others<'a>(sets: &'a Sets) -> impl Iterator<Item = (Aabb, Real)> + 'a {
    let moving = |collider: &Collider| {
        let handle = collider.parent()?;
        let body = sets.bodies.get(handle)?;
        if collider.is_sensor() || collider.shape().as_shape::<MedialMesh>().is_some() {
            return None;
        }
        let [linear, angular] = velocities(body, sets.parameters.dt);
        let aabb = collider.compute_aabb();
        let arm = (aabb.center() - body.center_of_mass()).length() + aabb.half_extents().length();
        let speed = match is_tied(sets, handle) {
            true => Real::MAX,
            false => linear.length() + angular.length() * arm,
        };
        let margin = sets.parameters.prediction_distance() + collider.contact_skin();
        (speed > 0.0).then(|| (aabb.loosened(margin), speed))
    };
    enabled(sets.bodies, sets.colliders, sets.participants).filter_map(move |(_, c)| moving(c))
}

/// Whether a body is held by joints, which hand on what is not near.
pub fn is_tied(sets: &Sets, body: RigidBodyHandle) -> bool {
    sets.impulse_joints.attached_joints(body).next().is_some()
        || sets.multibody_joints.rigid_body_link(body).is_some()
}

/// Largest speed that gets to each of some colliders, of these speeds, over at most [`MAX_HOPS`] pairs that are near
/// each other.
pub fn neighbor_speed_bounds(speeds: &[Real], near: &[[usize; 2]]) -> Vec<Real> {
    let mut reached = speeds.to_vec();
    for _ in 0..MAX_HOPS {
        let before = reached.clone();
        for &[i, j] in near {
            reached[i] = reached[i].max(before[j]);
            reached[j] = reached[j].max(before[i]);
        }
    }
    reached
}
