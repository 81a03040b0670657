//! Medial colliders in rapier (layer 6): what a user calls, and what is done before and after rapier's step.
//!
//! A step in order (`step.rs`): it takes a view of the world (`view/`) and makes the plan of the step (`planning.rs`,
//! by the rules of `contacts/`: the contacts that rapier will ask for, and the pairs that are muted, that is kept from
//! its solver); then rapier steps; then the impacts within the step that rapier missed are resolved (`resolving.rs`, by
//! `impacts/` and `joints/`). The workarounds for rapier 0.36 are in `host/`.
//!
//! # Files
//! - What users call: `pipeline.rs`, with sets of their own `pipeline_for_sets.rs`, and between two steps `prepare.rs`;
//!   `integration/` adds to rapier's builders. Settings: `effects.rs`, the constants of the event loop `tuning.rs`.
//!   What a step tells: `report.rs`.
//! - What a step is taken with: `step_args.rs`, rapier's sets `world.rs`. Its plan: `step_plan.rs`; what
//!   bodies are given for the length of rapier's step: `loans.rs`. What is kept from step to step: `state.rs`.

mod contacts;
mod effects;
mod host;
mod impacts;
mod integration;
mod joints;
mod loans;
mod pipeline;
mod pipeline_for_sets;
mod planning;
#[cfg(feature = "gpu")]
mod prepare;
mod report;
mod resolving;
mod state;
mod step;
mod step_args;
mod step_plan;
mod tuning;
mod view;
mod world;

pub use effects::{Effect, Effects, MedialOptions};
pub use host::recycling::RECYCLE_DISTANCE;
#[cfg(feature = "serde-serialize")]
pub use impacts::initial_overlaps::OverlapsRecord;
pub use integration::collider::{MedialColliderBuilder, MedialSharedShape};
#[cfg(feature = "debug-render")]
pub use integration::debug_draw::MedialDebugRender;
pub use integration::parameters::MedialIntegrationParameters;
#[cfg(feature = "serde-serialize")]
pub use integration::saved_world::{SavedWorld, SavedWorldError, load_world, save_world};
pub use pipeline::MedialPipeline;
pub use report::StepReport;
#[doc(hidden)]
pub use tuning::Tuning;
