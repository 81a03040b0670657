//! Puts bodies to where new joints of multibodies hold them. rapier does so within its step: a body that a new joint takes to
//! another place would seem to fly there, through all that is in between.

use crate::math::motion::chord;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use rapier3d::dynamics::{Multibody, MultibodyJointSet, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::ColliderSet;

/// How far a link is from where its joint holds it, in units of rapier's length unit, and by which angle, in radians (its chord), before
/// it counts as elsewhere. With 0 rounding would move links in each step, and they would never sleep.
const ELSEWHERE: Real = 1.0e-3;

/// Moves the links of multibodies that are not where their joints hold them, by the sum that rapier makes at the start of its
/// step. Only in worlds with medial colliders.
pub fn place_links(
    bodies: &mut RigidBodySet,
    multibodies: &mut MultibodyJointSet,
    colliders: &ColliderSet,
    length_unit: Real,
) {
    let suspected = multibodies.multibodies();
    let suspected = suspected.filter(|m| may_be_elsewhere(m, bodies, length_unit));
    let roots: Vec<_> = suspected.map(|m| m.root().rigid_body_handle()).collect();
    let mut shapes = colliders.iter().map(|(_, c)| c.shape());
    if roots.is_empty() || !shapes.any(|s| s.as_shape::<MedialMesh>().is_some()) {
        return;
    }
    for root in roots {
        let link = multibodies.rigid_body_link(root).copied();
        let Some(multibody) = link.and_then(|l| multibodies.get_multibody_mut(l.multibody)) else {
            continue;
        };
        multibody.forward_kinematics(bodies, true);
        let places = multibody.links().skip(1);
        let places = places.map(|link| (link.rigid_body_handle(), *link.local_to_world()));
        let places: Vec<(RigidBodyHandle, Pose)> = places.collect();
        let is_off = |(body, place): &(RigidBodyHandle, Pose)| {
            let body = bodies.get(*body);
            body.is_some_and(|body| is_elsewhere(body.position(), place, length_unit))
        };
        if !places.iter().any(is_off) {
            continue;
        }
        for (body, place) in places {
            if let Some(body) = bodies.get_mut(body) {
                body.set_position(place, false);
            }
        }
    }
}

/// Whether one of the links may be elsewhere, as far as its joint tells where it held it last: rapier leaves that one sub-step
/// behind.
fn may_be_elsewhere(multibody: &Multibody, bodies: &RigidBodySet, unit: Real) -> bool {
    let pose = |id: usize| -> Option<Pose> {
        let body = bodies.get(multibody.link(id)?.rigid_body_handle())?;
        Some(*body.position())
    };
    let is_off = |id: usize| -> Option<bool> {
        let link = multibody.link(id)?;
        let held = pose(link.parent_id()?)? * *link.local_to_parent();
        Some(is_elsewhere(&pose(id)?, &held, unit))
    };
    (1..multibody.num_links()).any(|id| is_off(id) == Some(true))
}

fn is_elsewhere(pose: &Pose, place: &Pose, unit: Real) -> bool {
    let way = pose.translation.distance(place.translation);
    way > ELSEWHERE * unit || chord(pose.rotation, place.rotation) > ELSEWHERE
}
