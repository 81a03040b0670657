//! rapier's sets of one world, as its step takes them.

use crate::math::{Pose, Vector};
use crate::rapier::host::multibody_coordinates;
use crate::rapier::impacts::outcome::Outcome;
use crate::rapier::view::census::Census;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::filter_answers::FilterAnswers;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet, RigidBody,
    RigidBodyHandle, RigidBodySet, SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsPipeline};

/// rapier's sets of a world, to be changed by its step: the arguments of [`PhysicsPipeline::step`] but for the
/// parameters and what the user hooks in.
pub struct World<'a> {
    pub pipeline: &'a mut PhysicsPipeline,
    pub gravity: Vector,
    pub islands: &'a mut IslandManager,
    pub broad_phase: &'a mut BroadPhaseBvh,
    pub narrow_phase: &'a mut NarrowPhase,
    pub bodies: &'a mut RigidBodySet,
    pub colliders: &'a mut ColliderSet,
    pub impulse_joints: &'a mut ImpulseJointSet,
    pub multibody_joints: &'a mut MultibodyJointSet,
    pub soft_bodies: &'a mut SoftBodySet,
    pub ccd_solver: &'a mut CCDSolver,
}

impl World<'_> {
    /// The sets that contacts are found in.
    pub fn sets<'s>(
        &'s self,
        parameters: &'s IntegrationParameters,
        participants: Option<&'s Participants>,
    ) -> Sets<'s> {
        Sets {
            gravity: self.gravity,
            parameters,
            bodies: self.bodies,
            colliders: self.colliders,
            impulse_joints: self.impulse_joints,
            multibody_joints: self.multibody_joints,
            narrow_phase: self.narrow_phase,
            participants,
        }
    }

    /// The rules by which colliders respond to each other.
    pub fn rules<'s>(&'s self, filter_answers: &'s FilterAnswers<'s>) -> Rules<'s> {
        Rules {
            bodies: self.bodies,
            colliders: self.colliders,
            impulse_joints: self.impulse_joints,
            multibody_joints: self.multibody_joints,
            filter_answers,
        }
    }

    /// Joints between bodies, and those of multibodies.
    pub fn joints(&self) -> (&ImpulseJointSet, &MultibodyJointSet) {
        (self.impulse_joints, self.multibody_joints)
    }

    /// The census of the world.
    pub fn census(&self) -> Census {
        Census::take(self.bodies, self.colliders, self.joints(), self.soft_bodies)
    }

    /// Whether it has multibodies or soft bodies, which cannot be set back to where they were within a step.
    pub fn has_links_or_particles(&self) -> bool {
        self.multibody_joints.multibodies().next().is_some() || !self.soft_bodies.is_empty()
    }

    /// Writes what impacts did to bodies and multibodies to rapier's sets; returns the bodies that are elsewhere now.
    /// Queries between steps find their colliders there. Colliders of these and no others are marked as moved: by that
    /// a loaded world knows them ([`crate::rapier::host::sleep_timers::moved_before`]).
    pub fn write_back(
        &mut self,
        view: &StepView,
        outcome: &Outcome,
        parameters: &IntegrationParameters,
    ) -> Vec<RigidBodyHandle> {
        if outcome.changed.is_empty() {
            return Vec::new();
        }
        let handles = view.bodies.iter().filter_map(|body| body.handle);
        let poses = handles.filter_map(|h| Some((h, *self.bodies.get(h)?.position())));
        let poses: Vec<_> = poses.collect();
        for &(index, struck) in &outcome.changed {
            view.bodies[index].write_back(struck, self.bodies);
        }
        let links = &mut *self.multibody_joints;
        multibody_coordinates::write_back(view, &outcome.changed, self.bodies, links);
        self.bodies
            .propagate_modified_body_positions_to_colliders(self.colliders);
        let is_elsewhere = |(h, pose): &(RigidBodyHandle, Pose)| {
            let body = self.bodies.get(*h);
            body.is_some_and(|body| body.position() != pose)
        };
        let moved = poses.into_iter().filter(is_elsewhere);
        let moved: Vec<RigidBodyHandle> = moved.map(|(handle, _)| handle).collect();
        for body in &moved {
            self.update_boxes(*body, parameters);
        }
        moved
    }

    /// Tells rapier's broad phase where the colliders of a body are.
    fn update_boxes(&mut self, body: RigidBodyHandle, parameters: &IntegrationParameters) {
        let colliders = self.bodies.get(body).map_or(&[][..], RigidBody::colliders);
        for handle in colliders {
            let collider = self.colliders.get(*handle).filter(|c| c.is_enabled());
            let aabb = collider.map(|c| c.compute_broad_phase_aabb(parameters, self.bodies));
            if let Some(aabb) = aabb.filter(|b| b.mins.is_finite() && b.maxs.is_finite()) {
                self.broad_phase.set_aabb(parameters, *handle, aabb);
            }
        }
    }

    /// Takes rapier's step.
    pub fn step(
        &mut self,
        parameters: &IntegrationParameters,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) {
        self.pipeline.step(
            self.gravity,
            parameters,
            self.islands,
            self.broad_phase,
            self.narrow_phase,
            self.bodies,
            self.colliders,
            self.impulse_joints,
            self.multibody_joints,
            self.soft_bodies,
            self.ccd_solver,
            hooks,
            events,
        );
    }
}
