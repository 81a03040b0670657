//! L6: the hook round rapier's step, and what a rapier user calls.

pub mod candidates;
pub mod collider;
mod effects;
mod emit;
mod events;
mod first_contact;
mod impulse;
mod motion;
mod muting;
mod pairs;
pub mod pipeline;
mod recycled;
pub mod report;

pub use collider::{MedialColliderBuilder, MedialSharedShape};
pub use effects::{Effect, Effects};
pub use pipeline::{MedialOptions, MedialPipeline};
pub use report::StepReport;
