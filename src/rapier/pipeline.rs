//! [`MedialPipeline`]: what is done before and after rapier's step, as calls in order. The work itself is in the
//! other files of this folder.

use super::effects::{Effect, Effects, MedialOptions, Wanted};
use super::emit::{Once, Scene, Told};
use super::events::Outcome;
use super::first_contact::Work;
use super::items;
use super::links;
use super::placed::Placed;
use super::prepared::{Prepared, asker, lowered};
use super::recycled::Recycled;
use super::report::StepReport;
use super::speculative::Speculators;
use super::substeps::Substeps;
use super::tuning::Tuning;
use super::verdicts::Verdicts;
use super::world::World;
use crate::batch::Batch;
use crate::math::{Real, Vector};
use crate::parry::{Answers, MedialDispatcher};
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet,
    RigidBodySet, SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderHandle, ColliderSet, NarrowPhase};
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsPipeline, PhysicsWorld};
use std::collections::HashSet;
use std::sync::Arc;
use web_time::Instant;

/// Steps a world with medial colliders: call [`Self::step`] in place of `world.step()`. Use one pipeline for
/// each world.
///
/// Before rapier's step it computes the contacts between medial colliders that are near each other. After the
/// step it finds fast bodies that met within it, of which at least one is medial, and resolves these
/// impacts: see [`Effects`]. What it does to the world besides is said at [`Self::attach`].
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
    pub(super) batch: Batch,
    pub(super) answers: Arc<Answers>,
    pub(super) recycled: Recycled,
    pub(super) effects: Wanted,
    pub(super) tuning: Tuning,
    pub(super) budget: u64,
    pub(super) told: Told,
    pub(super) placed: Placed,
    /// What the last step was prepared with, if nothing moved in it.
    pub(super) kept: Option<Prepared>,
    is_attached: bool,
}

impl Default for MedialPipeline {
    /// A pipeline with the default options.
    fn default() -> Self {
        Self::new(MedialOptions::default())
    }
}

impl MedialPipeline {
    /// A pipeline for one world. Opens a GPU if [`MedialOptions::backend`] asks for one. If there is none, the CPU
    /// does its work, and [`BatchReport::error`](crate::batch::BatchReport::error) of [`Self::batch`] says why. In a
    /// browser, where a GPU cannot be opened like this, use [`Self::with_batch`].
    pub fn new(options: MedialOptions) -> Self {
        Self::with_batch(options, Batch::new(options.backend))
    }

    /// A pipeline that uses a backend opened before; [`MedialOptions::backend`] is ignored.
    pub fn with_batch(options: MedialOptions, batch: Batch) -> Self {
        let mut effects = Wanted::default();
        effects.scene = options.effects;
        Self {
            batch,
            answers: Arc::default(),
            recycled: Recycled::default(),
            effects,
            tuning: Tuning::default(),
            budget: options.budget,
            told: Told::default(),
            placed: Placed::default(),
            kept: None,
            is_attached: false,
        }
    }

    /// The backend, whose report says what it has done, and why a GPU was not used.
    pub fn batch(&self) -> &Batch {
        &self.batch
    }

    /// Uses another backend from now on, and returns the one used so far. Call it between two steps. The world goes on
    /// in the same way, bit by bit.
    pub fn replace_batch(&mut self, batch: Batch) -> Batch {
        std::mem::replace(&mut self.batch, batch)
    }

    /// Has a GPU in a browser work on the contacts of the next step, and waits for its answers without blocking
    /// the page. Await it between two steps, after your changes to the world: pairs that change later are
    /// computed on the CPU. Outside browsers each step does this by itself.
    #[cfg(feature = "gpu")]
    pub async fn prepare(&mut self, world: &PhysicsWorld) {
        let parameters = lowered(&world.integration_parameters);
        let sets = items::Sets {
            parameters: &parameters,
            ..items::Sets::of(world)
        };
        let next = super::candidates::expect(sets, &self.recycled);
        self.batch.submit_async(&next).await;
        self.batch.ready().await;
    }

    /// Sets the effects of one collider. An effect left at [`Effect::Auto`] follows the scene's setting, so
    /// [`Effects::default`] removes the collider's own settings. If two colliders of a pair differ in an effect,
    /// `On` wins over `Off`.
    pub fn set_effects(&mut self, collider: ColliderHandle, effects: Effects) {
        self.effects.set(collider, effects);
        self.kept = None;
    }

    /// Other constants of the event loop, to measure what they do.
    #[doc(hidden)]
    pub fn set_tuning(&mut self, tuning: Tuning) {
        self.tuning = tuning;
        self.kept = None;
    }

    /// Prepares a world to be stepped by this pipeline: the narrow phase (the part of rapier that computes contacts)
    /// asks this pipeline first, and parry after that. A query dispatcher that you set yourself is replaced; nothing else
    /// of the world changes. A pipeline that was attached to nothing attaches itself in its first step; call this after
    /// the world was loaded or its narrow phase replaced.
    pub fn attach(&mut self, world: &mut PhysicsWorld) {
        self.attach_sets(&mut world.narrow_phase);
    }

    /// Does the same as [`Self::attach`] for games that keep rapier's sets themselves.
    pub fn attach_sets(&mut self, narrow_phase: &mut NarrowPhase) {
        self.is_attached = true;
        let dispatcher = MedialDispatcher::new(Arc::clone(&self.answers));
        narrow_phase.set_query_dispatcher(dispatcher.chain(DefaultQueryDispatcher));
    }

    /// Steps the world by `world.integration_parameters.dt`: call it in place of `world.step()`. The report
    /// counts what was done; [`StepReport::events`], [`StepReport::continuous_queries`] and [`StepReport::frozen`] tell
    /// most.
    ///
    /// While there are medial colliders, `integration_parameters.normalized_contact_recycle_distance`, the distance that a
    /// pair may move before rapier computes its contacts anew, counts as
    /// [`RECYCLE_DISTANCE`](super::RECYCLE_DISTANCE) if it is larger. This holds for all bodies.
    pub fn step(&mut self, world: &mut PhysicsWorld) -> StepReport {
        self.step_with_events(world, &(), &())
    }

    /// Does the same as [`Self::step`] with your physics hooks and your handler of collision and contact force events.
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

    /// Does the same as [`Self::step_with_events`] for games that keep rapier's sets themselves. It takes the
    /// arguments of [`PhysicsPipeline::step`], the pipeline first.
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
        let mut rest = *parameters;
        let mut report = StepReport::default();
        let answers = Arc::clone(&self.answers);
        let verdicts = Verdicts::new(hooks, &answers);
        let can_stop = !world.has_links_or_particles();
        loop {
            let may_stop = can_stop && report.stops < self.tuning.max_stops;
            let (done, stopped) = self.part(&mut world, &rest, &verdicts, events, may_stop);
            report.add(&done);
            let Some(time) = stopped else {
                self.send_early(world.sets(parameters), &mut report);
                return report;
            };
            report.stops += 1;
            rest.dt -= time;
        }
    }

    /// A step, or what of it comes before the world stops; the second result is when.
    fn part(
        &mut self,
        world: &mut World,
        parameters: &IntegrationParameters,
        verdicts: &Verdicts,
        events: &dyn EventHandler,
        may_stop: bool,
    ) -> (StepReport, Option<Real>) {
        let before = self.batch.report().clone();
        // Filters are asked before rapier has moved colliders to where the user put their bodies.
        world
            .bodies
            .propagate_modified_body_positions_to_colliders(world.colliders);
        let census = world.census();
        let lowered = lowered(parameters);
        let parameters = if census.medial > 0 {
            &lowered
        } else {
            parameters
        };
        let mut report = StepReport::default();
        let mut work = Work::default();
        let kept = self.kept.take().filter(|kept| kept.holds_in(&census));
        let is_kept = kept.is_some();
        let mut prepared = kept.unwrap_or_else(|| {
            self.prepare_step(
                world,
                parameters,
                (census, may_stop),
                verdicts,
                (&mut report, &mut work),
            )
        });
        let clock = Instant::now();
        self.answers.take_counts();
        self.answers.take_depth();
        let snapshot = &mut prepared.snapshot;
        let unit = parameters.length_unit;
        let speculators =
            (!is_kept).then(|| Speculators::set(snapshot, &self.effects, unit, world.bodies));
        let substeps = (!is_kept).then(|| {
            let joints = (&*world.impulse_joints, &*world.multibody_joints);
            Substeps::set(snapshot, joints, parameters, &prepared.whirls, world.bodies)
        });
        prepared.whirls.bring_to_rest(world.multibody_joints);
        report.speculative = speculators.as_ref().map_or(0, Speculators::count);
        report.batch_seconds += clock.elapsed().as_secs_f64();

        let off = |e: &Effects| e.continuous == Effect::Off;
        let takes_all = !self.effects.any(off) && !census.any_modified;
        // Fixed partners are the event loop's as all others are; rapier's own sweeps would stop bodies before.
        let sweeps = takes_all && !world.has_links_or_particles();
        self.answers.sweep_elsewhere(sweeps);

        let clock = Instant::now();
        let once = Once::new(events, &mut self.told);
        world.step(parameters, verdicts, &once);
        report.step_seconds = clock.elapsed().as_secs_f64();
        self.answers.sweep_elsewhere(false);
        self.answers.let_none_pass();
        self.answers.mute(HashSet::new());
        speculators
            .into_iter()
            .for_each(|s| s.restore(world.bodies));
        substeps.into_iter().for_each(|s| s.restore(world.bodies));

        let clock = Instant::now();
        let moved = census.medial > 0 && world.islands.num_active_bodies() > 0;
        let outcome = if census.still.is_some() && !moved {
            Outcome::default()
        } else {
            snapshot.follow(parameters, world.bodies, world.colliders);
            let rules = world.rules(verdicts);
            let whirls = std::mem::take(&mut prepared.whirls);
            whirls.take_back(snapshot, &rules, world.narrow_phase, parameters.dt);
            super::events::resolve(
                snapshot,
                asker(
                    &self.effects,
                    (self.tuning, self.budget),
                    parameters,
                    may_stop,
                ),
                rules,
                (
                    world.narrow_phase,
                    prepared.depth.max(self.answers.take_depth()),
                ),
                &mut self.placed,
                &mut self.batch,
                &mut work,
            )
        };
        for &(index, struck) in &outcome.changed {
            snapshot.bodies[index].write_back(struck, world.bodies);
        }
        if !outcome.changed.is_empty() {
            links::write_back(
                snapshot,
                &outcome.changed,
                world.bodies,
                world.multibody_joints,
            );
            world
                .bodies
                .propagate_modified_body_positions_to_colliders(world.colliders);
        }
        if !is_kept || snapshot.followed {
            self.placed.end(snapshot, world.colliders);
        }
        let scene = Scene {
            dt: parameters.dt,
            bodies: world.bodies,
            colliders: world.colliders,
            narrow_phase: world.narrow_phase,
        };
        once.finish(&mut self.told, &outcome.impulses, scene);
        if census.all > 0 {
            report.medial_colliders = items::count(world.colliders);
        }
        report.continuous_jobs = outcome.jobs;
        report.events = outcome.events;
        report.frozen = outcome.frozen;
        report.waiting = outcome.waiting;
        report.event_seconds = clock.elapsed().as_secs_f64();
        for ids in self.answers.take_missed() {
            self.recycled.forget(ids);
        }
        report.add_answered(&self.answers.take_counts());
        report.add_searched(&work);
        report.add_sent(&before, self.batch.report());
        self.kept = (!prepared.snapshot.followed).then_some(prepared);
        (report, outcome.stopped)
    }
}
