//! Medial colliders in rapier (layer 6): what a user calls, and what is done before and after rapier's step.
//!
//! A step in order (`step.rs`): it takes a view of the world (`view/`), plans the step (`contacts/`: the contacts
//! that rapier will ask for, and the pairs that are muted, that is kept from its solver), has rapier step, and
//! resolves the impacts within the step that rapier missed (`impacts/`, `joints/`). What rapier 0.36 has to be told
//! in roundabout ways is in `host/`.
//!
//! What users call is in `pipeline.rs`, and `integration/` adds to rapier's builders. Settings are in `effects.rs`,
//! the constants of the event loop in `tuning.rs`.

mod contacts;
mod effects;
mod host;
mod impacts;
mod integration;
mod joints;
mod loans;
mod pipeline;
mod report;
mod state;
mod step;
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
