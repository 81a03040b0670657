//! rapier's sets of one world, as its step takes them.

use crate::math::Vector;
use crate::rapier::view::census::Census;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::filter_answers::FilterAnswers;
use crate::rapier::view::medial_colliders::Sets;
use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet,
    RigidBodySet, SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsPipeline};

/// Sets of one world: the arguments of [`PhysicsPipeline::step`] but for the parameters and what the user hooks in.
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
    pub fn sets<'s>(&'s self, parameters: &'s IntegrationParameters) -> Sets<'s> {
        Sets {
            gravity: self.gravity,
            parameters,
            bodies: self.bodies,
            colliders: self.colliders,
            impulse_joints: self.impulse_joints,
            multibody_joints: self.multibody_joints,
            narrow_phase: self.narrow_phase,
        }
    }

    /// The rules by which colliders respond to each other.
    pub fn rules<'s>(&'s self, verdicts: &'s FilterAnswers<'s>) -> Rules<'s> {
        Rules {
            bodies: self.bodies,
            colliders: self.colliders,
            impulse_joints: self.impulse_joints,
            multibody_joints: self.multibody_joints,
            verdicts,
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
