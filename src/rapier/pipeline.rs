//! [`MedialPipeline`]: what a user calls in place of rapier's step. `pipeline_for_sets.rs` takes rapier's sets one by
//! one, `step.rs` has the step itself.

use crate::batch::Batch;
use crate::rapier::effects::{Effects, MedialOptions};
use crate::rapier::report::StepReport;
use crate::rapier::state::PipelineState;
use crate::rapier::tuning::Tuning;
use rapier3d::geometry::ColliderHandle;
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsWorld};

/// Steps a world with medial colliders: call [`Self::step`] in place of `world.step()`. Use one pipeline for
/// each world.
///
/// Before rapier's step it computes the contacts between medial colliders that are near each other. After rapier's
/// step it finds pairs of fast bodies that met within the step, at least one of them medial, and resolves these
/// impacts: see [`Effects`]. [`Self::attach`] and [`Self::step`] say what else changes in the world.
///
/// In a world that is stepped without a pipeline, medial colliders still have contacts, computed by parry as for
/// its compound shapes, but fast bodies pass through each other.
///
/// ```
/// use rapier3d::prelude::*;
/// use rapier3d_medial::prelude::*;
///
/// let mut world = PhysicsWorld::new();
/// let mut pipeline = MedialPipeline::new(MedialOptions::default());
/// world.insert_collider(ColliderBuilder::cuboid(9.0, 0.1, 9.0), None);
/// let ring = ColliderBuilder::medial_mesh(MedialMesh::torus(0.5, 0.1, 16)?);
/// let body = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 1.0, 0.0));
/// let (body, _) = world.insert(body, ring);
/// for _ in 0..60 {
///     pipeline.step(&mut world);
/// }
/// # assert!((0.1..0.4).contains(&world.bodies[body].translation().y));
/// # Ok::<(), rapier3d_medial::MeshError>(())
/// ```
pub struct MedialPipeline {
    pub(crate) state: PipelineState,
    pub(super) is_attached: bool,
}

impl Default for MedialPipeline {
    /// A pipeline with the default options.
    fn default() -> Self {
        Self::new(MedialOptions::default())
    }
}

impl MedialPipeline {
    /// A pipeline for one world. It opens a GPU if [`MedialOptions::backend`] asks for one. If there is none, the CPU
    /// does the GPU's work, and [`BatchReport::error`](crate::batch::BatchReport::error) of [`Self::batch`] says why.
    /// In a browser, where a GPU cannot be opened like this, use [`Self::with_batch`].
    pub fn new(options: MedialOptions) -> Self {
        Self::with_batch(options, Batch::new(options.backend))
    }

    /// A pipeline that uses a backend opened before; [`MedialOptions::backend`] is ignored.
    pub fn with_batch(options: MedialOptions, batch: Batch) -> Self {
        Self {
            state: PipelineState::new(options, batch),
            is_attached: false,
        }
    }

    /// The backend, whose report says what it has done, and why a GPU was not used.
    pub fn batch(&self) -> &Batch {
        &self.state.batch
    }

    /// Uses another backend from now on, and returns the one used so far. Call it between two steps. The world goes on
    /// in the same way, bit by bit.
    pub fn replace_batch(&mut self, batch: Batch) -> Batch {
        std::mem::replace(&mut self.state.batch, batch)
    }

    /// Sets the effects of one collider. An effect left at [`Effect::Auto`](crate::Effect::Auto) follows the scene's
    /// setting, so [`Effects::default`] removes the collider's own settings. If the two colliders of a pair have
    /// different settings for an effect, `On` wins over `Off`. A handle that the world does not have is ignored. The
    /// settings are not part of a saved world.
    pub fn set_effects(&mut self, collider: ColliderHandle, effects: Effects) {
        self.state.settings.effects.set(collider, effects);
        self.state.kept = None;
    }

    /// Sets other constants of the event loop, to measure what they do.
    #[doc(hidden)]
    pub fn set_tuning(&mut self, tuning: Tuning) {
        self.state.settings.tuning = tuning;
        self.state.kept = None;
    }

    /// Prepares a world to be stepped by this pipeline: the narrow phase (the part of rapier that computes contacts)
    /// asks this pipeline first, and parry after that. A query dispatcher that you have set yourself is replaced;
    /// nothing else in the world changes. For a new world you need not call this: a pipeline that is not attached yet
    /// attaches itself in its first step. Call it after the world was loaded, or put back to an earlier state as
    /// netcode does, or its narrow phase was replaced, and only then: bodies that you have moved since the last step
    /// are taken for moved by impacts.
    pub fn attach(&mut self, world: &mut PhysicsWorld) {
        self.attach_sets(&mut world.narrow_phase);
    }

    /// Steps the world by `world.integration_parameters.dt`: call it in place of `world.step()`. The report
    /// counts what was done; [`StepReport::events`], [`StepReport::continuous_queries`] and [`StepReport::frozen`] tell
    /// most.
    ///
    /// `integration_parameters.normalized_contact_recycle_distance` is the distance that a pair may move before
    /// rapier computes its contacts anew. While there are medial colliders, the step uses
    /// [`RECYCLE_DISTANCE`](crate::rapier::RECYCLE_DISTANCE) in its place if yours is larger. This holds for all
    /// bodies, but where at most one in nine of the moving pairs has a medial collider: the contacts of these pairs
    /// are then computed in each step, and the others go by your distance. Medial bodies that joints hold and that
    /// turn fast get more solver iterations for the step (`docs/host.md`).
    pub fn step(&mut self, world: &mut PhysicsWorld) -> StepReport {
        self.step_with_events(world, &(), &())
    }

    /// Steps like [`Self::step`], with your physics hooks and your handler of collision and contact force events.
    /// Impacts within the step are reported to the handler too.
    pub fn step_with_events(
        &mut self,
        world: &mut PhysicsWorld,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> StepReport {
        self.step_sets(
            &mut world.physics_pipeline,
            world.gravity,
            &world.integration_parameters,
            &mut world.islands,
            &mut world.broad_phase,
            &mut world.narrow_phase,
            &mut world.bodies,
            &mut world.colliders,
            &mut world.impulse_joints,
            &mut world.multibody_joints,
            &mut world.soft_bodies,
            &mut world.ccd_solver,
            hooks,
            events,
        )
    }
}
