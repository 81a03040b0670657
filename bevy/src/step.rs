//! The step: bevy_rapier's own time step modes and messages, round [`MedialPipeline::step_sets`].

use crate::events::Messages;
use bevy::ecs::system::{StaticSystemParam, SystemParamItem};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier;
use rapier::geometry::{ColliderHandle, SolverFlags};
use rapier::prelude::{EventHandler, PhysicsHooks};
use rapier3d_medial::{MedialOptions, MedialPipeline, StepReport};
use std::collections::HashMap;
use std::sync::Mutex;

/// The medial pipeline of a physics world: a component on the same entity as `RapierContextSimulation`.
#[derive(Component)]
pub struct MedialWorld {
    pipeline: MedialPipeline,
    report: StepReport,
    events: Option<Box<dyn EventHandler + Send + Sync>>,
    /// Colliders removed since the last step: their last contacts are told by these entities.
    removed: HashMap<ColliderHandle, Entity>,
}

impl MedialWorld {
    /// For a world without contacts yet: its narrow phase asks this pipeline.
    pub(crate) fn attached(
        options: MedialOptions,
        simulation: &mut RapierContextSimulation,
    ) -> Self {
        let mut pipeline = MedialPipeline::new(options);
        pipeline.attach_sets(&mut simulation.narrow_phase);
        let (report, events, removed) = Default::default();
        Self {
            pipeline,
            report,
            events,
            removed,
        }
    }

    /// The pipeline, to set the effects of single colliders.
    pub fn pipeline(&mut self) -> &mut MedialPipeline {
        &mut self.pipeline
    }

    /// The report of the last step.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// Sets a handler that gets all of rapier's events besides bevy's messages; `None` removes it.
    pub fn set_event_handler(&mut self, handler: Option<Box<dyn EventHandler + Send + Sync>>) {
        self.events = handler;
    }
}

/// Keeps the entity of a collider that is about to go.
pub(crate) fn remember_removed(
    remove: On<Remove<RapierColliderHandle>>,
    colliders: Query<(&RapierColliderHandle, &RapierContextEntityLink)>,
    mut worlds: Query<&mut MedialWorld>,
) {
    if let Ok((handle, link)) = colliders.get(remove.entity)
        && let Ok(mut world) = worlds.get_mut(link.0)
    {
        world.removed.insert(handle.0, remove.entity);
    }
}

/// bevy_rapier's hooks as rapier's.
struct Hooks<H>(H);

impl<H: BevyPhysicsHooks> PhysicsHooks for Hooks<H> {
    fn filter_contact_pair(&self, raw: &rapier::prelude::PairFilterContext) -> Option<SolverFlags> {
        self.0.filter_contact_pair(PairFilterContextView { raw })
    }

    fn filter_intersection_pair(&self, raw: &rapier::prelude::PairFilterContext) -> bool {
        self.0
            .filter_intersection_pair(PairFilterContextView { raw })
    }

    fn modify_solver_contacts(&self, raw: &mut rapier::prelude::ContactModificationContext) {
        self.0
            .modify_solver_contacts(ContactModificationContextView { raw });
    }
}

/// The steps that a frame calls for.
struct Frame {
    /// How often the time step's length passes.
    ticks: usize,
    /// Length of the time step, s.
    dt: f32,
    /// Steps in each.
    substeps: usize,
    /// Length of a step, s.
    step: f32,
}

impl Frame {
    /// By bevy_rapier's rules. `behind` is how far the simulation is behind the clock, s, and is brought up to date.
    fn new(mode: TimestepMode, elapsed: f32, behind: &mut f32) -> Self {
        let frame = |ticks, dt: f32, time_scale: f32, substeps: usize| {
            let step = dt / substeps as f32 * time_scale;
            let substeps = if step > 0.0 { substeps } else { 0 };
            Self {
                ticks,
                dt,
                substeps,
                step,
            }
        };
        match mode {
            TimestepMode::Fixed { dt, substeps } => frame(1, dt, 1.0, substeps),
            TimestepMode::Variable {
                max_dt,
                time_scale,
                substeps,
            } => frame(1, (elapsed * time_scale).min(max_dt), 1.0, substeps),
            TimestepMode::Interpolated {
                dt,
                time_scale,
                substeps,
            } => {
                *behind += elapsed;
                let mut ticks = 0;
                while dt > 0.0 && *behind > 0.0 {
                    *behind -= dt;
                    ticks += 1;
                }
                frame(ticks, dt, time_scale, substeps)
            }
        }
    }
}

type World<'a> = (
    Entity,
    &'a mut RapierContextSimulation,
    &'a mut RapierContextColliders,
    &'a mut RapierContextJoints,
    &'a mut RapierRigidBodySet,
    &'a RapierConfiguration,
    &'a mut SimulationToRenderTime,
    &'a mut MedialWorld,
);

/// In the place of bevy_rapier's step: all physics worlds, each by the steps that the frame calls for.
#[allow(clippy::too_many_arguments)]
pub(crate) fn step<H>(
    mut commands: Commands,
    mut worlds: Query<World>,
    mode: Res<TimestepMode>,
    hooks: StaticSystemParam<H>,
    time: Res<Time>,
    mut collisions: MessageWriter<CollisionEvent>,
    mut forces: MessageWriter<ContactForceEvent>,
    mut quarantines: MessageWriter<PhysicsQuarantineEvent>,
    mut interpolated: Query<(&RapierRigidBodyHandle, &mut TransformInterpolation)>,
) where
    H: 'static + BevyPhysicsHooks,
    for<'w, 's> SystemParamItem<'w, 's, H>: BevyPhysicsHooks,
{
    let hooks = Hooks(hooks.into_inner());
    for (
        entity,
        mut simulation,
        mut colliders,
        mut joints,
        mut bodies,
        settings,
        mut clock,
        mut medial,
    ) in &mut worlds
    {
        let simulation = &mut *simulation;
        let (colliders, joints, bodies) = (&mut *colliders, &mut *joints, &mut *bodies);
        if !settings.physics_pipeline_active {
            bodies.propagate_modified_body_positions_to_colliders(colliders);
            continue;
        }
        simulation.set_num_threads(settings.num_threads);
        if settings.simulation_mode == SimulationMode::CollisionOnly {
            // Nothing moves by itself: rapier's own way, with this crate's contacts.
            let events = Some((&collisions, &forces));
            let (gravity, only) = (settings.gravity, settings.simulation_mode);
            simulation.step_simulation(
                colliders, joints, bodies, gravity, only, *mode, events, &hooks, &time, &mut clock,
                None,
            );
            simulation.send_bevy_events(&mut collisions, &mut forces);
            continue;
        }
        let frame = Frame::new(*mode, time.delta_secs(), &mut clock.diff);
        simulation.integration_parameters.dt = frame.dt;
        if frame.ticks * frame.substeps == 0 {
            bodies.propagate_modified_body_positions_to_colliders(colliders);
            continue;
        }
        let mut parameters = simulation.integration_parameters;
        parameters.dt = frame.step;
        let mut lost = PhysicsQuarantineEvent {
            context: entity,
            bodies: Vec::new(),
            colliders: Vec::new(),
            soft_bodies: Vec::new(),
        };
        let MedialWorld {
            pipeline,
            report,
            events,
            removed,
        } = &mut *medial;
        let messages = Messages {
            removed,
            user: events.as_deref(),
            collisions: Mutex::default(),
            forces: Mutex::default(),
        };
        for tick in 0..frame.ticks {
            if matches!(*mode, TimestepMode::Interpolated { .. }) && tick + 1 == frame.ticks {
                for (handle, mut interpolation) in &mut interpolated {
                    if let Some(body) = bodies.bodies.get(handle.0) {
                        interpolation.start = Some(*body.position());
                        interpolation.end = None;
                    }
                }
            }
            for _ in 0..frame.substeps {
                *report = pipeline.step_sets(
                    &mut simulation.pipeline,
                    settings.gravity,
                    &parameters,
                    &mut simulation.islands,
                    &mut simulation.broad_phase,
                    &mut simulation.narrow_phase,
                    &mut bodies.bodies,
                    &mut colliders.colliders,
                    &mut joints.impulse_joints,
                    &mut joints.multibody_joints,
                    &mut bodies.soft_bodies,
                    &mut simulation.ccd_solver,
                    &hooks,
                    &messages,
                );
                let found = simulation.pipeline.quarantine();
                lost.bodies.extend(
                    found
                        .bodies()
                        .iter()
                        .filter_map(|h| bodies.rigid_body_entity(*h)),
                );
                lost.colliders.extend(
                    found
                        .colliders()
                        .iter()
                        .filter_map(|h| colliders.collider_entity(*h)),
                );
                lost.soft_bodies.extend(
                    found
                        .soft_bodies()
                        .iter()
                        .filter_map(|h| bodies.soft_body_entity(*h)),
                );
            }
        }
        collisions.write_batch(messages.collisions.into_inner().unwrap_or_default());
        forces.write_batch(messages.forces.into_inner().unwrap_or_default());
        removed.clear();
        quarantine(&mut commands, lost, &mut quarantines);
    }
}

/// Marks what rapier has disabled because its numbers were no longer finite, and tells it.
fn quarantine(
    commands: &mut Commands,
    lost: PhysicsQuarantineEvent,
    messages: &mut MessageWriter<PhysicsQuarantineEvent>,
) {
    if lost.bodies.is_empty() && lost.colliders.is_empty() && lost.soft_bodies.is_empty() {
        return;
    }
    log::warn!("no longer finite, and disabled: {lost:?}");
    for entity in &lost.bodies {
        commands.entity(*entity).try_insert(RigidBodyDisabled);
    }
    for entity in &lost.colliders {
        commands.entity(*entity).try_insert(ColliderDisabled);
    }
    for entity in &lost.soft_bodies {
        commands.entity(*entity).try_insert(SoftBodyDisabled);
    }
    messages.write(lost);
}
