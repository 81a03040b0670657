//! How far joints are open: what rapier's solver has not closed yet.

use crate::math::{Real, Vector};
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::GenericJoint;

/// Length by which a joint between two bodies is open, along the axes that it locks.
pub fn opening(view: &StepView, both: [usize; 2], joint: &GenericJoint) -> Real {
    let frames = [joint.local_frame1, joint.local_frame2];
    let [first, second] = [0, 1].map(|k| view.bodies[both[k]].motion.start * frames[k]);
    let off = first.inverse_transform_point(second.translation);
    let is_locked = |axis: usize| joint.locked_axes.bits() & (1 << axis) != 0;
    let along = |axis: usize| if is_locked(axis) { off[axis] } else { 0.0 };
    Vector::new(along(0), along(1), along(2)).length()
}
