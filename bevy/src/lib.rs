//! Concave colliders that do not tunnel, in bevy: [`RapierMedialPlugin`] in place of bevy_rapier's own plugin.
//!
//! The plugin adds `RapierPhysicsPlugin` with all its systems but the step, and steps with
//! [`rapier3d_medial::MedialPipeline`] instead. Time steps, interpolation, collision and contact force messages,
//! hooks and several physics worlds work as in bevy_rapier; a [`MedialCollider`] is one more kind of collider.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_rapier3d::prelude::*;
//! use bevy_rapier3d_medial::prelude::*;
//!
//! fn spawn(mut commands: Commands) -> Result {
//!     let ring = MedialMesh::torus(0.5, 0.1, 24)?;
//!     commands.spawn((RigidBody::Dynamic, MedialCollider::from(ring), Transform::from_xyz(0.0, 2.0, 0.0)));
//!     commands.spawn((Collider::cuboid(20.0, 0.5, 20.0), Transform::from_xyz(0.0, -0.5, 0.0)));
//!     Ok(())
//! }
//!
//! App::new()
//!     .add_plugins((MinimalPlugins, TransformPlugin, RapierMedialPlugin::<NoUserData>::default()))
//!     .add_systems(Startup, spawn);
//! ```
//!
//! # Differences from bevy_rapier
//! bevy_rapier keeps parts of its step private, so four things differ:
//! - Messages about soft bodies that tear are not sent.
//! - `RapierContextSimulation::step_stats` stays empty; use [`MedialWorld::report`].
//! - A handler given to `RapierContextSimulation::set_event_handler` is not called; use
//!   [`MedialWorld::set_event_handler`].
//! - bevy_rapier keeps some twenty bytes for each collider that was ever removed.
#![warn(missing_docs)]

mod collider;
mod events;
mod plugin;
mod step;

pub use collider::MedialCollider;
#[cfg(feature = "assets")]
pub use collider::{MedialAsset, MedialAssetLoader, MedialBuild, MedialBuilt};
pub use plugin::RapierMedialPlugin;
pub use step::MedialWorld;

/// Everything that an app usually needs beside `bevy_rapier3d::prelude::*`.
pub mod prelude {
    #[cfg(feature = "assets")]
    pub use crate::{MedialAsset, MedialBuild, MedialBuilt};
    pub use crate::{MedialCollider, MedialWorld, RapierMedialPlugin};
    pub use rapier3d_medial::{
        BuildOptions, BuildReport, Effect, Effects, MedialMesh, MedialOptions, MedialSphere,
        Quality, StepReport,
    };
}

/// Compiles the README's example.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
