//! Bounds how fast the neighbours of a collider may push it within a step, to know how far away its contacts must
//! be looked for. The velocities of a pair do not tell what a third body does to it, since the solver passes a push
//! on from contact to contact. There is no such bound for what joints pass on.

use crate::math::Real;
use crate::medial::MedialMesh;
use crate::rapier::view::body_velocity::velocities;
use crate::rapier::view::medial_colliders::{MedialCollider, Sets};
use crate::rapier::view::participants::enabled;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::geometry::Collider;

/// Pairs that a push goes through in a step, to the third neighbour. A chain of equal balls would hand it on for ever;
/// a heap shares it out.
const MAX_HOPS: usize = 3;

/// A collider's bounds on the push that it may give its neighbours in a step.
#[derive(Clone, Copy)]
pub struct Neighbor {
    /// Bound on the speed of its points.
    speed: Real,
    /// Whether a push goes through it: nothing moves what is fixed or kinematic.
    is_movable: bool,
}

impl Neighbor {
    /// A medial collider.
    pub fn medial(sets: &Sets, collider: &MedialCollider) -> Self {
        let own = collider.speed();
        Self::new(sets, collider.body, collider.is_dynamic, own)
    }

    /// A collider whose points are no faster than `own` by the velocities of its body.
    fn new(sets: &Sets, body: Option<RigidBodyHandle>, is_dynamic: bool, own: Real) -> Self {
        let is_tied = is_dynamic && body.is_some_and(|body| is_tied(sets, body));
        Self {
            speed: if is_tied { Real::MAX } else { own },
            is_movable: is_dynamic,
        }
    }
}

/// Moving colliders that are not medial: their boxes, as far as contacts are looked for.
pub fn others<'a>(sets: &'a Sets) -> impl Iterator<Item = (Aabb, Neighbor)> + 'a {
    let moving = |collider: &Collider| {
        let handle = collider.parent()?;
        let body = sets.bodies.get(handle)?;
        if collider.is_sensor() || collider.shape().as_shape::<MedialMesh>().is_some() {
            return None;
        }
        let [linear, angular] = velocities(body, sets.parameters.dt);
        let aabb = collider.compute_aabb();
        let arm = (aabb.center() - body.center_of_mass()).length() + aabb.half_extents().length();
        let own = linear.length() + angular.length() * arm;
        let neighbor = Neighbor::new(sets, Some(handle), body.is_dynamic(), own);
        let margin = sets.parameters.prediction_distance() + collider.contact_skin();
        (neighbor.speed > 0.0).then(|| (aabb.loosened(margin), neighbor))
    };
    enabled(sets.bodies, sets.colliders, sets.participants).filter_map(move |(_, c)| moving(c))
}

/// Whether a body is held by joints, which hand on what is not near.
fn is_tied(sets: &Sets, body: RigidBodyHandle) -> bool {
    sets.impulse_joints.attached_joints(body).next().is_some()
        || sets.multibody_joints.rigid_body_link(body).is_some()
}

/// Largest speed that gets to each of some colliders, over at most [`MAX_HOPS`] pairs that are near each other.
pub fn neighbor_speed_bounds(neighbors: &[Neighbor], near: &[[usize; 2]]) -> Vec<Real> {
    let mut reached: Vec<Real> = neighbors.iter().map(|neighbor| neighbor.speed).collect();
    for _ in 0..MAX_HOPS {
        let before = reached.clone();
        for &[i, j] in near {
            for [to, from] in [[i, j], [j, i]] {
                if neighbors[to].is_movable {
                    reached[to] = reached[to].max(before[from]);
                }
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::{Neighbor, neighbor_speed_bounds};

    #[test]
    fn a_push_gets_to_the_third_neighbor_and_through_nothing_fixed() {
        let [fast, slow] = [8.0, 0.0].map(|speed| Neighbor {
            speed,
            is_movable: true,
        });
        let fixed = Neighbor {
            is_movable: false,
            ..slow
        };
        let row = [fast, slow, slow, slow, slow];
        let near: Vec<[usize; 2]> = (1..row.len()).map(|k| [k, k - 1]).collect();
        let reached = neighbor_speed_bounds(&row, &near);
        assert_eq!(reached, [8.0, 8.0, 8.0, 8.0, 0.0]);
        let reached = neighbor_speed_bounds(&[fast, fixed, slow, slow, slow], &near);
        assert_eq!(reached, [8.0, 0.0, 0.0, 0.0, 0.0]);
        // A collider that moves by itself pushes, and is not pushed.
        let mover = Neighbor {
            speed: 2.0,
            ..fixed
        };
        let reached = neighbor_speed_bounds(&[fast, mover, slow, slow, slow], &near);
        assert_eq!(reached, [8.0, 2.0, 2.0, 2.0, 2.0]);
    }
}
