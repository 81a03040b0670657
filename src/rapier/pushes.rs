//! How fast what is near a collider may push it within a step. The velocities of a pair do not tell what a
//! third body does to it, and the solver hands a push on from contact to contact. Of what joints hand on
//! no bound is known.

use super::items::Sets;
use super::motion::velocities;
use crate::math::Real;
use crate::medial::MedialMesh;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::geometry::Collider;

/// Bodies that a push goes through in a step. A chain of equal balls would hand it on for ever; a heap
/// shares it out.
const HANDED_ON: usize = 3;

/// What pushes, and is pushed.
#[derive(Clone, Copy)]
pub struct Pusher {
    /// Bound on the speed of its points.
    pub speed: Real,
    /// Its restitution.
    pub restitution: Real,
}

/// Moving colliders that are not medial, with their boxes, as far as contacts are looked for.
pub fn others<'a>(sets: &'a Sets) -> impl Iterator<Item = (Aabb, Pusher)> + 'a {
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
        let pusher = Pusher {
            speed,
            restitution: collider.restitution(),
        };
        (speed > 0.0).then(|| (aabb.loosened(margin), pusher))
    };
    sets.colliders
        .iter_enabled()
        .filter_map(move |(_, c)| moving(c))
}

/// Whether a body is held by joints, which hand on what is not near.
pub fn is_tied(sets: &Sets, body: RigidBodyHandle) -> bool {
    sets.impulse_joints.attached_joints(body).next().is_some()
        || sets.multibody_joints.rigid_body_link(body).is_some()
}

/// For each of some colliders the largest speed that gets to it over at most [`HANDED_ON`] pairs that are
/// near each other. What is much lighter than what strikes it leaves at `1 + e` times its speed, where the
/// pair's restitution `e` is at most the sum of both, by any of rapier's rules, and 1.
pub fn pushed(pushers: &[Pusher], near: &[[usize; 2]]) -> Vec<Real> {
    let mut reached: Vec<Real> = pushers.iter().map(|p| p.speed).collect();
    let bounce = |[i, j]: [usize; 2]| {
        let both = pushers[i].restitution + pushers[j].restitution;
        1.0 + both.clamp(0.0, 1.0)
    };
    for hop in 0..HANDED_ON {
        let before = reached.clone();
        for &[i, j] in near {
            let bounced = if hop == 0 { bounce([i, j]) } else { 1.0 };
            reached[i] = reached[i].max(bounced * before[j]);
            reached[j] = reached[j].max(bounced * before[i]);
        }
    }
    reached
}
