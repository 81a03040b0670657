//! The plugin: bevy_rapier's systems before and after the step, and this crate's step between them.

use crate::collider;
use crate::step::{self, MedialWorld};
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::SystemParamItem;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use rapier3d_medial::MedialOptions;
use std::marker::PhantomData;

/// Physics with medial colliders: add it in place of `RapierPhysicsPlugin`, with the same hooks.
pub struct RapierMedialPlugin<Hooks = NoUserData> {
    schedule: Interned<dyn ScheduleLabel>,
    options: MedialOptions,
    initialization: RapierContextInitialization,
    hooks: PhantomData<fn() -> Hooks>,
}

impl<Hooks> Default for RapierMedialPlugin<Hooks> {
    fn default() -> Self {
        Self {
            schedule: PostUpdate.intern(),
            options: MedialOptions::default(),
            initialization: RapierContextInitialization::default(),
            hooks: PhantomData,
        }
    }
}

impl<Hooks> RapierMedialPlugin<Hooks> {
    /// Sets the effects, backend and budget of all physics worlds.
    pub fn with_options(mut self, options: MedialOptions) -> Self {
        self.options = options;
        self
    }

    /// Steps in `FixedUpdate` instead of `PostUpdate`.
    pub fn in_fixed_schedule(self) -> Self {
        self.in_schedule(FixedUpdate)
    }

    /// Steps in this schedule instead of `PostUpdate`.
    pub fn in_schedule(mut self, schedule: impl ScheduleLabel) -> Self {
        self.schedule = schedule.intern();
        self
    }

    /// Sets how bevy_rapier makes its first physics world.
    pub fn with_custom_initialization(
        mut self,
        initialization: RapierContextInitialization,
    ) -> Self {
        self.initialization = initialization;
        self
    }

    /// Sets rapier's length unit, for scenes whose unit is not the metre: the number of their units in a metre.
    pub fn with_length_unit(self, length_unit: f32) -> Self {
        self.with_custom_initialization(RapierContextInitialization::default_with_length_unit(
            length_unit,
        ))
    }
}

impl<Hooks> Plugin for RapierMedialPlugin<Hooks>
where
    Hooks: 'static + BevyPhysicsHooks,
    for<'w, 's> SystemParamItem<'w, 's, Hooks>: BevyPhysicsHooks,
{
    fn build(&self, app: &mut App) {
        let around_the_step = [PhysicsSet::SyncBackend, PhysicsSet::Writeback];
        app.add_plugins(
            RapierPhysicsPlugin::<Hooks>::default()
                .in_schedule(self.schedule)
                .with_custom_initialization(self.initialization.clone())
                .with_physics_sets_systems(around_the_step.into_iter().collect()),
        );
        let options = self.options;
        let attach = move |mut commands: Commands,
                           mut fresh: Query<
            (Entity, &mut RapierContextSimulation),
            Without<MedialWorld>,
        >| {
            for (entity, mut simulation) in &mut fresh {
                commands
                    .entity(entity)
                    .insert(MedialWorld::attached(options, &mut simulation));
            }
        };
        app.add_systems(self.schedule, attach.before(PhysicsSet::SyncBackend))
            .add_systems(
                self.schedule,
                step::step::<Hooks>.in_set(PhysicsSet::StepSimulation),
            )
            .add_observer(step::remember_removed);
        collider::add_systems(app, self.schedule);
    }
    #[cfg(feature = "assets")]
    fn finish(&self, app: &mut App) {
        collider::finish(app);
    }
}
