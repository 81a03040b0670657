//! Gives bodies more of rapier's sub-steps where joints hold what turns fast. In a sub-step a body moves straight
//! along its velocity, so that a joint opens by `½ h² |ω1 × (ω1 × r1) − ω2 × (ω2 × r2)|`, where `h` is the length
//! of the sub-step and `r` the vector from each centre of mass to the joint. Joints of multibodies stay closed, but
//! turn wrong instead.

use crate::math::Real;
use crate::rapier::host::multibody_energy::WildMultibodies;
use crate::rapier::view::all_joints::for_each_joint;
use crate::rapier::view::motion::Kind;
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::{
    GenericJoint, ImpulseJointSet, IntegrationParameters, MultibodyJointSet, RigidBodyHandle,
    RigidBodySet,
};

/// Length by which a joint may open in a sub-step, in units of rapier's length unit. Chains of bars of 0.4 m, four
/// sub-steps a step, reach it at 12 rad/s.
const MOST_OPENING: Real = 5.0e-4;

/// Sub-steps that are added at most.
const MOST_ADDED: usize = 28;

/// Bodies that have more sub-steps for the length of a step, and how many more they had before.
pub struct Substeps(Vec<(RigidBodyHandle, usize)>);

impl Substeps {
    /// Sets those of medial bodies that joints hold, or of what they are tied to: rapier has the whole component take
    /// them.
    pub fn set(
        view: &StepView,
        (joints, multibodies): (&ImpulseJointSet, &MultibodyJointSet),
        parameters: &IntegrationParameters,
        wild: &WildMultibodies,
        bodies: &mut RigidBodySet,
    ) -> Self {
        let mut medial = vec![false; view.bodies.len()];
        for part in &view.parts {
            medial[part.body] |= part.medial().is_some();
        }
        let mut own = Vec::new();
        let add = |handles: [RigidBodyHandle; 2], joint: &GenericJoint| {
            let [Some(&a), Some(&b)] = handles.map(|h| view.index.get(&h)) else {
                return;
            };
            if !(medial[a] || medial[b]) || !joint.is_enabled() || wild.rests(b) {
                return;
            }
            let needed = needed(view, [a, b], joint, parameters);
            let added = needed.saturating_sub(parameters.num_solver_iterations);
            let added = added.min(MOST_ADDED);
            let free = [a, b].map(|k| view.bodies[k].kind == Kind::Free);
            if let Some(handle) = (0..2).find(|k| free[*k]).map(|k| handles[k])
                && let Some(body) = bodies.get_mut(handle)
                && added > body.additional_solver_iterations()
            {
                own.push((handle, body.additional_solver_iterations()));
                body.set_additional_solver_iterations(added);
            }
        };
        for_each_joint(joints, multibodies, add);
        Self(own)
    }

    /// Gives the bodies back what they had.
    pub fn restore(self, bodies: &mut RigidBodySet) {
        for (handle, had) in self.0.into_iter().rev() {
            if let Some(body) = bodies.get_mut(handle) {
                body.set_additional_solver_iterations(had);
            }
        }
    }
}

/// Sub-steps in a step with which a joint between two bodies opens by no more than it may.
fn needed(
    view: &StepView,
    both: [usize; 2],
    joint: &GenericJoint,
    parameters: &IntegrationParameters,
) -> usize {
    let frames = [joint.local_frame1, joint.local_frame2];
    let [a, b] = [0, 1].map(|k| {
        let motion = &view.bodies[both[k]].motion;
        let arm = motion.start.rotation * (frames[k].translation - motion.local_center);
        motion.angvel.cross(motion.angvel.cross(arm))
    });
    let opening = 0.5 * (a - b).length() * parameters.dt * parameters.dt;
    // Of an opening that is no number none.
    (opening / (MOST_OPENING * parameters.length_unit)).sqrt() as usize
}
