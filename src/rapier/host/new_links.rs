//! Puts bodies to where new joints of multibodies hold them. rapier does so within its step: a body that a new joint
//! takes to another place would seem to fly there, through all that is in between.

use crate::math::fast_hash::FastMap;
use crate::math::motion::chord;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use rapier3d::dynamics::{
    IntegrationParameters, JointAxesMask, Multibody, MultibodyJointSet, RigidBodyHandle,
    RigidBodySet,
};
use rapier3d::geometry::ColliderSet;

/// How far a link is from where its joint holds it, in units of rapier's length unit, and by which angle, in radians
/// (its chord), before it counts as elsewhere: more than rounding. Larger, and a link that a joint puts this far into
/// the ground counts as flown there, and is held in it.
const ELSEWHERE: Real = 1.0e-3;

/// Joints of multibodies with medial colliders as the last step left them, by their second bodies.
#[derive(Default)]
pub struct KnownLinks(FastMap<RigidBodyHandle, Hold>);

/// How a joint holds its second body: the first one, the axes that it locks, and the place in the first one's frame.
#[derive(Clone, Copy, PartialEq)]
struct Hold(RigidBodyHandle, JointAxesMask, Pose);

impl KnownLinks {
    /// Moves the links of multibodies with medial colliders to where their joints hold them, by the sum that rapier
    /// makes at the start of its step, where a joint is new or was changed since the last step. Links whose root was
    /// moved are left to rapier.
    pub fn place_new(
        &self,
        bodies: &mut RigidBodySet,
        multibodies: &mut MultibodyJointSet,
        colliders: &ColliderSet,
        parameters: &IntegrationParameters,
    ) {
        let is_new = |(body, hold): (RigidBodyHandle, Hold)| self.0.get(&body) != Some(&hold);
        let changed = multibodies
            .multibodies()
            .filter(|m| is_medial(m, bodies, colliders) && holds(m).any(is_new));
        let changed: Vec<_> = changed.map(|m| m.root().rigid_body_handle()).collect();
        for root in changed {
            let link = multibodies.rigid_body_link(root).copied();
            if let Some(multibody) = link.and_then(|l| multibodies.get_multibody_mut(l.multibody)) {
                place(multibody, bodies, parameters);
            }
        }
    }

    /// Remembers how a step leaves the joints.
    pub fn note(
        &mut self,
        bodies: &RigidBodySet,
        multibodies: &MultibodyJointSet,
        colliders: &ColliderSet,
    ) {
        let medial = multibodies.multibodies();
        let medial = medial.filter(|m| is_medial(m, bodies, colliders));
        self.0 = medial.flat_map(holds).collect();
    }
}

/// Whether a link has a medial collider.
fn is_medial(multibody: &Multibody, bodies: &RigidBodySet, colliders: &ColliderSet) -> bool {
    let bodies = multibody
        .links()
        .filter_map(|link| bodies.get(link.rigid_body_handle()));
    let mut handles = bodies.flat_map(|body| body.colliders());
    handles.any(|h| {
        let shape = colliders.get(*h).map(|c| c.shape());
        shape.is_some_and(|s| s.as_shape::<MedialMesh>().is_some())
    })
}

/// How the joints of a multibody hold their second bodies.
fn holds(multibody: &Multibody) -> impl Iterator<Item = (RigidBodyHandle, Hold)> {
    multibody.links().filter_map(|link| {
        let parent = multibody.link(link.parent_id()?)?.rigid_body_handle();
        let locked = link.joint.data.locked_axes;
        let place = link.joint.body_to_parent();
        Some((link.rigid_body_handle(), Hold(parent, locked, place)))
    })
}

/// Moves the links of a multibody if one of them is not where its joint holds it. rapier leaves links behind a root
/// that it moves, by no more than the root moves in a step.
fn place(multibody: &mut Multibody, bodies: &mut RigidBodySet, parameters: &IntegrationParameters) {
    multibody.forward_kinematics(bodies, true);
    let Some(root) = bodies.get(multibody.root().rigid_body_handle()) else {
        return;
    };
    let turn = ELSEWHERE + root.angvel().length() * parameters.dt;
    let way = ELSEWHERE * parameters.length_unit + root.linvel().length() * parameters.dt;
    let center = root.center_of_mass();
    let places = multibody.links().skip(1);
    let places = places.map(|link| (link.rigid_body_handle(), *link.local_to_world()));
    let places: Vec<(RigidBodyHandle, Pose)> = places.collect();
    let is_elsewhere = |(body, place): &(RigidBodyHandle, Pose)| {
        bodies.get(*body).is_some_and(|body| {
            let pose = body.position();
            let arm = place.translation.distance(center);
            pose.translation.distance(place.translation) > way + turn * arm
                || chord(pose.rotation, place.rotation) > turn
        })
    };
    if places.iter().any(is_elsewhere) {
        for (body, place) in places {
            if let Some(body) = bodies.get_mut(body) {
                body.set_position(place, false);
            }
        }
    }
}
