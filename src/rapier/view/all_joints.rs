//! All joints of a world: those between bodies, and those of multibodies.

use crate::math::{Real, Vector};
use crate::rapier::view::step_view::StepView;
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

/// Length by which a joint between two bodies is open, along the axes that it locks.
pub fn opening(view: &StepView, both: [usize; 2], joint: &GenericJoint) -> Real {
    let frames = [joint.local_frame1, joint.local_frame2];
    let [first, second] = [0, 1].map(|k| view.bodies[both[k]].motion.start * frames[k]);
    let off = first.inverse_transform_point(second.translation);
    let is_locked = |axis: usize| joint.locked_axes.bits() & (1 << axis) != 0;
    let along = |axis: usize| if is_locked(axis) { off[axis] } else { 0.0 };
    Vector::new(along(0), along(1), along(2)).length()
}
