//! All joints of a world: those between bodies, and those of multibodies.

use rapier3d::dynamics::{GenericJoint, ImpulseJointSet, MultibodyJointSet, RigidBodyHandle};

/// Calls `take` on each joint, with the two bodies that it holds; of a multibody's link its parent comes first.
pub fn for_each_joint(
    joints: &ImpulseJointSet,
    multibodies: &MultibodyJointSet,
    mut take: impl FnMut([RigidBodyHandle; 2], &GenericJoint),
) {
    for (_, joint) in joints.iter() {
        take([joint.body1(), joint.body2()], &joint.data);
    }
    for multibody in multibodies.multibodies() {
        for link in multibody.links() {
            if let Some(parent) = link.parent_id().and_then(|id| multibody.link(id)) {
                let handles = [parent, link].map(|l| l.rigid_body_handle());
                take(handles, &link.joint.data);
            }
        }
    }
}
