//! Puts bodies to where new joints of multibodies hold them. rapier does so within its step: a body that a new joint takes to
//! another place would seem to fly there, through all that is in between.

use crate::math::fast_hash::FastMap;
use crate::math::motion::chord;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use rapier3d::dynamics::{Multibody, MultibodyJointSet, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::ColliderSet;

/// How far a link is from where its joint holds it, in units of rapier's length unit, and by which angle, in radians (its
/// chord), before it counts as elsewhere: more than rounding.
const ELSEWHERE: Real = 1.0e-3;

/// Joints of multibodies with medial colliders in the last step, by their second bodies: the first body, and the frames of the
/// joint in both.
#[derive(Default)]
pub struct KnownLinks(FastMap<RigidBodyHandle, (RigidBodyHandle, [Pose; 2])>);

impl KnownLinks {
    /// Moves the links of multibodies with medial colliders and new or changed joints to where the joints hold them, by the sum
    /// that rapier makes at the start of its step. Links whose root was moved are left to rapier.
    pub fn place_new(
        &mut self,
        bodies: &mut RigidBodySet,
        multibodies: &mut MultibodyJointSet,
        colliders: &ColliderSet,
        length_unit: Real,
    ) {
        let medial = multibodies
            .multibodies()
            .filter(|multibody| is_medial(multibody, bodies, colliders));
        let mut known = FastMap::default();
        let mut changed = Vec::new();
        for multibody in medial {
            let mut is_new = false;
            for (body, joint) in joints(multibody) {
                is_new |= self.0.get(&body) != Some(&joint);
                known.insert(body, joint);
            }
            changed.extend(is_new.then(|| multibody.root().rigid_body_handle()));
        }
        self.0 = known;
        for root in changed {
            let link = multibodies.rigid_body_link(root).copied();
            if let Some(multibody) = link.and_then(|l| multibodies.get_multibody_mut(l.multibody)) {
                place(multibody, bodies, length_unit);
            }
        }
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

/// Joints of a multibody, each with its second body.
fn joints(
    multibody: &Multibody,
) -> impl Iterator<Item = (RigidBodyHandle, (RigidBodyHandle, [Pose; 2]))> {
    multibody.links().filter_map(|link| {
        let parent = multibody.link(link.parent_id()?)?;
        let joint = &link.joint.data;
        let frames = [joint.local_frame1, joint.local_frame2];
        Some((
            link.rigid_body_handle(),
            (parent.rigid_body_handle(), frames),
        ))
    })
}

/// Moves the links of a multibody if one of them is not where its joint holds it.
fn place(multibody: &mut Multibody, bodies: &mut RigidBodySet, unit: Real) {
    multibody.forward_kinematics(bodies, true);
    let places = multibody.links().skip(1);
    let places = places.map(|link| (link.rigid_body_handle(), *link.local_to_world()));
    let places: Vec<(RigidBodyHandle, Pose)> = places.collect();
    let is_elsewhere = |(body, place): &(RigidBodyHandle, Pose)| {
        bodies.get(*body).is_some_and(|body| {
            let pose = body.position();
            pose.translation.distance(place.translation) > ELSEWHERE * unit
                || chord(pose.rotation, place.rotation) > ELSEWHERE
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
