//! Gives bodies more of rapier's sub-steps where joints hold what turns fast. In a sub-step a body moves straight
//! along its velocity, so that a joint opens by `½ h² |ω1 × (ω1 × r1) − ω2 × (ω2 × r2)|`, where `h` is the length
//! of the sub-step and `r` the vector from each centre of mass to the joint. Joints of multibodies stay closed, but
//! turn wrong instead.
//!
//! Bodies that joints tie to a strained joint get none. Where a joint is wide open, as where much more mass hangs on
//! light links than rapier's solver holds, many sub-steps would close it at once, and throw what it holds. Where a
//! joint presses its two bodies into each other, the joint and the contact gain energy in each sub-step: with twelve
//! more in a step chains of five links of rapier's own capsules get to 169 m/s instead of 16, in the mean of 20.

use crate::math::Real;
use crate::math::fast_hash::FastSet;
use crate::rapier::host::multibody_energy::FastMultibodies;
use crate::rapier::view::all_joints::for_each_joint;
use crate::rapier::view::groups::BodyGroups;
use crate::rapier::view::joint_opening::opening;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::{
    GenericJoint, ImpulseJointSet, IntegrationParameters, MultibodyJointSet, RigidBodyHandle,
    RigidBodySet,
};
use rapier3d::geometry::NarrowPhase;

/// Length by which a joint may open in a sub-step, in units of rapier's length unit. Chains of bars of 0.4 m, four
/// sub-steps a step, reach it at 12 rad/s.
const MOST_OPENING: Real = 5.0e-4;

/// Length from which a joint is wide open, in units of rapier's length unit. At 0.15 loads of 300 times the links' mass
/// are thrown, at 0.1 none of up to 1,000 times is.
const WIDE: Real = 0.1;

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
        contacts: &NarrowPhase,
        parameters: &IntegrationParameters,
        fast_multibodies: &FastMultibodies,
        bodies: &mut RigidBodySet,
    ) -> Self {
        let mut medial = vec![false; view.bodies.len()];
        for part in &view.colliders {
            medial[part.body] |= part.medial().is_some();
        }
        let unit = parameters.length_unit;
        let strained = Strained::find((view, contacts, bodies), (joints, multibodies), unit);
        let mut own = Vec::new();
        let add = |handles: [RigidBodyHandle; 2], joint: &GenericJoint| {
            let [Some(&a), Some(&b)] = handles.map(|h| view.index.get(&h)) else {
                return;
            };
            if !(medial[a] || medial[b]) || !joint.is_enabled() || fast_multibodies.rests(b) {
                return;
            }
            let needed = needed(view, [a, b], joint, parameters);
            let added = needed.saturating_sub(parameters.num_solver_iterations);
            let added = added.min(MOST_ADDED);
            let free = |k: &usize| view.bodies[[a, b][*k]].mobility == Mobility::Free;
            if let Some(k) = (0..2).find(free)
                && let Some(body) = bodies.get_mut(handles[k])
                && added > body.additional_solver_iterations()
                && !strained.holds([a, b][k])
            {
                own.push((handles[k], body.additional_solver_iterations()));
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

/// Bodies that hang together by joints, and which of them have a joint that is wide open, or presses its bodies into
/// each other.
struct Strained {
    groups: BodyGroups,
    strained: FastSet<usize>,
}

impl Strained {
    fn find(
        (view, contacts, bodies): (&StepView, &NarrowPhase, &RigidBodySet),
        (joints, multibodies): (&ImpulseJointSet, &MultibodyJointSet),
        unit: Real,
    ) -> Self {
        let mut groups = BodyGroups::default();
        let mut strained = Vec::new();
        for_each_joint(joints, multibodies, |handles, joint| {
            let [Some(&a), Some(&b)] = handles.map(|h| view.index.get(&h)) else {
                return;
            };
            let is_free = |k: &usize| view.bodies[*k].mobility == Mobility::Free;
            if is_free(&a) && is_free(&b) {
                groups.join([a, b]);
            }
            let is_wide = || opening(view, [a, b], joint) > WIDE * unit;
            let is_pressed = || joint.contacts_enabled() && overlap(contacts, bodies, handles);
            if joint.is_enabled() && (is_wide() || is_pressed()) {
                strained.extend([a, b].into_iter().filter(is_free));
            }
        });
        let strained = strained.into_iter();
        let strained = strained.map(|body| groups.of(body)).collect();
        Self { groups, strained }
    }

    /// Whether a body hangs together with such a joint.
    fn holds(&self, body: usize) -> bool {
        self.strained.contains(&self.groups.of(body))
    }
}

/// Whether colliders of two bodies overlap.
fn overlap(contacts: &NarrowPhase, bodies: &RigidBodySet, both: [RigidBodyHandle; 2]) -> bool {
    let [Some(a), Some(b)] = both.map(|handle| bodies.get(handle)) else {
        return false;
    };
    let pairs = a
        .colliders()
        .iter()
        .flat_map(|c| b.colliders().iter().map(move |d| (*c, *d)));
    let mut pairs = pairs.filter_map(|(c, d)| contacts.contact_pair(c, d));
    pairs.any(|pair| {
        pair.find_deepest_contact()
            .is_some_and(|(_, c)| c.dist < 0.0)
    })
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
    // An opening of NaN gives none.
    (opening / (MOST_OPENING * parameters.length_unit)).sqrt() as usize
}
