//! What a user of rapier calls (layer 6), and what is done before and after rapier's step to have medial colliders
//! collide.

mod ahead;
mod blow;
mod boxes;
pub mod candidates;
mod census;
pub mod collider;
mod course;
#[cfg(feature = "debug-render")]
pub mod debug_draw;
mod effects;
mod emit;
mod enabled;
mod events;
mod first_contact;
mod hanging;
mod impulse;
mod inquiry;
mod items;
mod joints;
mod limits;
mod links;
mod meetings;
mod motion;
mod muting;
mod outlines;
mod pairs;
mod pieces;
pub mod pipeline;
mod placed;
mod prepared;
mod pushes;
mod recycled;
pub mod report;
mod response;
mod rows;
#[cfg(feature = "serde-serialize")]
pub mod saved_world;
mod skyline;
mod snapshot;
mod speculative;
mod spent;
mod substeps;
mod sweep;
mod thin_parts;
mod tied;
mod tuning;
mod verdicts;
mod waiting;
mod watched;
mod whirls;
mod world;

pub use collider::{MedialColliderBuilder, MedialSharedShape};
#[cfg(feature = "debug-render")]
pub use debug_draw::MedialDebugRender;
pub use effects::{Effect, Effects, MedialOptions};
pub use pipeline::MedialPipeline;
pub use recycled::RECYCLE_DISTANCE;
pub use report::StepReport;
#[cfg(feature = "serde-serialize")]
pub use saved_world::{SavedWorld, SavedWorldError, load_world, save_world};
#[doc(hidden)]
pub use tuning::Tuning;
