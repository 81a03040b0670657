//! [`MedialPipeline`] for games that keep rapier's sets themselves, as `examples/custom_loop.rs` does.

use crate::math::Vector;
use crate::parry::MedialDispatcher;
use crate::rapier::pipeline::MedialPipeline;
use crate::rapier::report::StepReport;
use crate::rapier::world::World;
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet,
    RigidBodySet, SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsPipeline};
use std::sync::Arc;

impl MedialPipeline {
    /// Prepares like [`Self::attach`], for games that keep rapier's sets themselves.
    pub fn attach_sets(&mut self, narrow_phase: &mut NarrowPhase) {
        self.is_attached = true;
        // The bodies in it are of another world, or of a later state of this one.
        self.state.moved = None;
        let dispatcher = MedialDispatcher::new(Arc::clone(&self.state.exchange));
        narrow_phase.set_query_dispatcher(dispatcher.chain(DefaultQueryDispatcher));
    }

    /// Steps like [`Self::step_with_events`], for games that keep rapier's sets themselves. It takes the arguments of
    /// [`PhysicsPipeline::step`], and before them rapier's pipeline itself.
    #[expect(
        clippy::too_many_arguments,
        reason = "the arguments of rapier's own step"
    )]
    pub fn step_sets(
        &mut self,
        pipeline: &mut PhysicsPipeline,
        gravity: Vector,
        parameters: &IntegrationParameters,
        islands: &mut IslandManager,
        broad_phase: &mut BroadPhaseBvh,
        narrow_phase: &mut NarrowPhase,
        bodies: &mut RigidBodySet,
        colliders: &mut ColliderSet,
        impulse_joints: &mut ImpulseJointSet,
        multibody_joints: &mut MultibodyJointSet,
        soft_bodies: &mut SoftBodySet,
        ccd_solver: &mut CCDSolver,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> StepReport {
        if !self.is_attached {
            self.attach_sets(narrow_phase);
        }
        let mut world = World {
            pipeline,
            gravity,
            islands,
            broad_phase,
            narrow_phase,
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            soft_bodies,
            ccd_solver,
        };
        self.state.step(&mut world, parameters, hooks, events)
    }
}
