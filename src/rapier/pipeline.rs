//! [`MedialPipeline`]: the hook round rapier's step. Calls in order, nothing else.

use super::effects::{Effect, Effects, MedialOptions, Wanted};
use super::emit::{Once, Scene, Told};
use super::first_contact::{Asker, Work};
use super::items::{self, Sets};
use super::pairs::Rules;
use super::placed::Placed;
use super::recycled::{RECYCLE_DISTANCE, Recycled};
use super::report::StepReport;
use super::snapshot::Snapshot;
use super::speculative::Speculators;
use super::substeps::Substeps;
use super::tuning::Tuning;
use super::verdicts::Verdicts;
use super::{candidates, hanging, links, muting};
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

/// Steps a world whose medial colliders meet each other: finds their near pairs, computes all
/// contacts in one batch, and hands them to rapier's narrow phase as it asks for them. After rapier's
/// step it resolves the first contacts of fast bodies, of which one at least is medial, on the motion
/// of the step: see [`Effects`].
///
/// One pipeline per world. A world stepped without one still has contacts, through parry's own
/// composite shapes.
#[derive(Default)]
pub struct MedialPipeline {
    batch: Batch,
    answers: Arc<Answers>,
    recycled: Recycled,
    effects: Wanted,
    tuning: Tuning,
    pub(super) told: Told,
    placed: Placed,
}

impl MedialPipeline {
    /// A pipeline for one world. Opens a device where the backend asks for one; without it the CPU
    /// serves, and [`Self::batch`] says why. In a browser use [`Self::with_batch`].
    pub fn new(options: MedialOptions) -> Self {
        Self::with_batch(options, Batch::new(options.backend))
    }

    /// A pipeline whose batches go to a backend that was opened before, whatever the options say of it.
    pub fn with_batch(options: MedialOptions, batch: Batch) -> Self {
        let mut pipeline = Self {
            batch,
            ..Self::default()
        };
        pipeline.effects.scene = options.effects;
        pipeline
    }

    /// The backend: what it has done since it was opened, and why it was not used where it was not.
    pub fn batch(&self) -> &Batch {
        &self.batch
    }

    /// Has batches computed elsewhere from now on, and gives back the backend before; between two steps.
    /// The world goes on the same, bit by bit.
    pub fn replace_batch(&mut self, batch: Batch) -> Batch {
        std::mem::replace(&mut self.batch, batch)
    }

    /// For a browser, between two steps: asks the device about the contacts of the next one and waits
    /// for its answers without blocking. Elsewhere each step asks for the next one by itself, and waits
    /// only when it comes. What is changed in the world after that goes to the CPU.
    #[cfg(feature = "gpu")]
    pub async fn prepare(&mut self, world: &PhysicsWorld) {
        let next = candidates::expect(Sets::of(world), &self.recycled);
        self.batch.submit_async(&next).await;
        self.batch.ready().await;
    }

    /// What a collider calls for, whatever the scene does; [`Effects::default`] leaves it to the scene.
    /// Of two colliders that differ, the one that has an effect on decides.
    pub fn set_effects(&mut self, collider: ColliderHandle, effects: Effects) {
        self.effects.set(collider, effects);
    }

    /// Other constants of the event loop, to measure what they do.
    #[doc(hidden)]
    pub fn set_tuning(&mut self, tuning: Tuning) {
        self.tuning = tuning;
    }

    /// Prepares a world to be stepped: its narrow phase asks this pipeline for contacts first, and
    /// `normalized_contact_recycle_distance` is lowered to [`RECYCLE_DISTANCE`] if it is above, for all bodies.
    /// Nothing else of the world changes. Call it once, and again after the narrow phase was replaced (a
    /// world that was loaded).
    pub fn attach(&mut self, world: &mut PhysicsWorld) {
        self.attach_sets(&mut world.integration_parameters, &mut world.narrow_phase);
    }

    /// As [`Self::attach`], for a world kept in sets of your own.
    pub fn attach_sets(
        &mut self,
        parameters: &mut IntegrationParameters,
        narrow_phase: &mut NarrowPhase,
    ) {
        let dispatcher = MedialDispatcher::new(Arc::clone(&self.answers));
        narrow_phase.set_query_dispatcher(dispatcher.chain(DefaultQueryDispatcher));
        let distance = &mut parameters.normalized_contact_recycle_distance;
        *distance = distance.min(RECYCLE_DISTANCE);
    }

    /// Steps the world: call it in place of `world.step()`. The report counts what was done;
    /// [`StepReport::events`], [`StepReport::continuous_queries`] and [`StepReport::frozen`] tell most.
    pub fn step(&mut self, world: &mut PhysicsWorld) -> StepReport {
        self.step_with_events(world, &(), &())
    }

    /// Steps the world with the user's hooks and events.
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

    /// As [`PhysicsPipeline::step`], for a world kept in sets of your own.
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
        let mut rest = *parameters;
        let mut report = StepReport::default();
        // Links and particles cannot be set back to where they were at a stop.
        let answers = Arc::clone(&self.answers);
        let verdicts = Verdicts::new(hooks, &answers);
        let can_stop = multibody_joints.multibodies().next().is_none() && soft_bodies.is_empty();
        loop {
            let may_stop = can_stop && report.stops < self.tuning.max_stops;
            let (done, stopped) = self.part(
                pipeline,
                gravity,
                &rest,
                islands,
                broad_phase,
                narrow_phase,
                bodies,
                colliders,
                impulse_joints,
                multibody_joints,
                soft_bodies,
                ccd_solver,
                &verdicts,
                events,
                may_stop,
            );
            report.add(&done);
            let Some(time) = stopped else {
                let sets = Sets {
                    gravity,
                    parameters,
                    bodies,
                    colliders,
                    impulse_joints,
                    multibody_joints,
                    narrow_phase,
                };
                self.send_early(sets, &mut report);
                return report;
            };
            report.stops += 1;
            rest.dt -= time;
        }
    }

    /// The poses are final: a device has the time until the next step for its contacts.
    fn send_early(&mut self, sets: Sets, report: &mut StepReport) {
        if !self.batch.has_device() {
            return;
        }
        let before = self.batch.report().clone();
        let next = candidates::expect(sets, &self.recycled);
        self.batch.submit(&next);
        report.add_sent(&before, self.batch.report());
    }

    /// A step, or what of it comes before the world stops; the second result is when.
    #[expect(clippy::too_many_arguments, reason = "as above")]
    fn part(
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
        verdicts: &Verdicts,
        events: &dyn EventHandler,
        may_stop: bool,
    ) -> (StepReport, Option<Real>) {
        let mut report = StepReport::default();
        let before = self.batch.report().clone();
        let clock = Instant::now();
        let medial = items::make_unique(bodies, colliders);
        self.effects.clean(colliders);
        let asker = Asker {
            effects: &self.effects,
            dt: parameters.dt,
            unit: parameters.length_unit,
            tuning: self.tuning,
            may_stop,
        };
        let mut work = Work::default();
        let joints = (&*impulse_joints, &*multibody_joints);
        let mut snapshot = if medial == 0 || self.effects.none() {
            Snapshot::default()
        } else {
            Snapshot::take(gravity, parameters.dt, bodies, colliders, joints)
        };
        // Filters are asked before rapier has moved colliders to where the user put their bodies.
        bodies.propagate_modified_body_positions_to_colliders(colliders);
        self.placed.begin(&snapshot, narrow_phase);
        let rules = Rules {
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            verdicts,
        };
        let prediction = parameters.prediction_distance();
        let muted = muting::muted(&snapshot, &asker, &rules, prediction, &mut work);
        report.muted = muted.len();
        let off = |e: &Effects| e.continuous == Effect::Off;
        let takes_all = !self.effects.any(off) && !rules.any_modified();
        report.mute_seconds = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let sets = Sets {
            gravity,
            parameters,
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            narrow_phase,
        };
        let found = candidates::find(sets, &mut self.recycled, &muted);
        hanging::ask_anew(&found.fresh, colliders);
        let mut results = self.batch.run(&found.jobs);
        report.pairs = found.pairs;
        report.jobs = found.jobs.len();
        let jobs = found.jobs.iter().zip(&found.ahead);
        for ((job, ahead), result) in jobs.clone().zip(&mut results) {
            ahead.bring_back(result);
            self.recycled.set_touching(job, !result.contacts.is_empty());
            report.add_contacts(result);
        }
        let keys = jobs.map(|(job, ahead)| ahead.key(job));
        let answers = keys.zip(results);
        let starts = found.starts;
        let compute = Box::new(move |job| starts.contacts(job));
        self.answers.replace(answers, compute);
        self.answers.mute(muted);
        self.answers
            .give_one_point(self.effects.one_point(colliders));
        self.answers.take_counts();
        self.answers.take_depth();
        let speculators = Speculators::set(&snapshot, &self.effects, asker.unit, bodies);
        report.speculative = speculators.count();
        let substeps = Substeps::set(&snapshot, joints, parameters, bodies);
        report.batch_seconds = clock.elapsed().as_secs_f64();

        // Fixed partners are the event loop's as all others are; rapier's own sweeps would stop bodies before.
        let can_sweep = soft_bodies.is_empty() && multibody_joints.multibodies().next().is_none();
        self.answers.sweep_elsewhere(takes_all && can_sweep);

        let clock = Instant::now();
        let once = Once::new(events, &mut self.told);
        pipeline.step(
            gravity,
            parameters,
            islands,
            broad_phase,
            narrow_phase,
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            soft_bodies,
            ccd_solver,
            verdicts,
            &once,
        );
        report.step_seconds = clock.elapsed().as_secs_f64();
        self.answers.mute(HashSet::new());
        self.answers.sweep_elsewhere(false);
        self.answers.let_none_pass();
        speculators.restore(bodies);
        substeps.restore(bodies);

        let clock = Instant::now();
        snapshot.follow(parameters, bodies, colliders);
        let rules = Rules {
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            verdicts,
        };
        let outcome = super::events::resolve(
            &mut snapshot,
            asker,
            rules,
            (narrow_phase, found.depth.max(self.answers.take_depth())),
            &mut self.placed,
            &mut self.batch,
            &mut work,
        );
        for &(index, struck) in &outcome.changed {
            snapshot.bodies[index].write_back(struck, bodies);
        }
        if !outcome.changed.is_empty() {
            links::write_back(&snapshot, &outcome.changed, bodies, multibody_joints);
            bodies.propagate_modified_body_positions_to_colliders(colliders);
        }
        self.placed.end(&snapshot, colliders);
        let scene = Scene {
            dt: parameters.dt,
            bodies,
            colliders,
            narrow_phase,
        };
        once.finish(&mut self.told, &outcome.impulses, scene);
        report.medial_colliders = items::count(colliders);
        report.continuous_jobs = outcome.jobs;
        report.events = outcome.events;
        report.frozen = outcome.frozen;
        report.event_seconds = clock.elapsed().as_secs_f64();
        for ids in self.answers.take_missed() {
            self.recycled.forget(ids);
        }
        report.add_answered(&self.answers.take_counts());
        report.add_searched(&work);
        report.add_sent(&before, self.batch.report());
        (report, outcome.stopped)
    }
}
