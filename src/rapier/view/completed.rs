//! Completes the view of a step that left out bystanders (`participants.rs`) after rapier's step, where rapier woke
//! one, or something may get to one.

use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Vector};
use crate::rapier::view::motion::Body;
use crate::rapier::view::step_view::{StepCollider, StepView};
use crate::rapier::view::still_colliders::StillColliders;
use parry3d::query::NonlinearRigidMotion;
use rapier3d::dynamics::{IntegrationParameters, MultibodyJointSet, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::{ColliderHandle, ColliderSet};

impl StepView {
    /// Extends this view to the whole world. Bodies and colliders that took part keep their motions; the bystanders are
    /// those of `whole`, a view made after rapier's step, with sleeping bodies put back to the poses before it, which
    /// `still` has.
    pub fn complete(
        &mut self,
        mut whole: Self,
        still: &StillColliders,
        parameters: &IntegrationParameters,
        sets: (&RigidBodySet, &ColliderSet),
        multibodies: &MultibodyJointSet,
    ) {
        for body in &mut whole.bodies {
            if let Some(pose) = body.handle.and_then(|h| still.pose(h)) {
                sleep_at(body, pose);
            }
        }
        for part in &mut whole.colliders {
            let pose = whole.bodies[part.body].start * part.offset;
            part.aabb = part.shape.compute_aabb(&pose);
        }
        whole.follow(parameters, sets, multibodies);
        let known = |handle: Option<RigidBodyHandle>| self.index.get(&handle?).copied();
        for body in &mut whole.bodies {
            if let Some(k) = known(body.handle) {
                body.clone_from(&self.bodies[k]);
            }
        }
        let parts = self.colliders.iter().map(|part| (part.handle, part));
        let parts: FastMap<ColliderHandle, &StepCollider> = parts.collect();
        for part in &mut whole.colliders {
            if let Some(known) = parts.get(&part.handle) {
                let body = part.body;
                part.clone_from(known);
                part.body = body;
            }
        }
        *self = whole;
    }
}

/// Makes a body what it was when it slept at a pose, before rapier's step.
fn sleep_at(body: &mut Body, pose: Pose) {
    body.awake = false;
    body.motion = NonlinearRigidMotion {
        local_center: body.motion.local_center,
        ..NonlinearRigidMotion::constant_position(pose)
    };
    body.start = pose;
    body.velocity_before = [Vector::ZERO; 2];
    body.pull = Vector::ZERO;
}
