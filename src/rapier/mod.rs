//! L6: the hook round rapier's step, and what a rapier user calls.

pub mod candidates;
pub mod collider;
pub mod pipeline;
mod recycled;
pub mod report;

pub use collider::{MedialColliderBuilder, MedialSharedShape};
pub use pipeline::{MedialOptions, MedialPipeline};
pub use report::StepReport;
