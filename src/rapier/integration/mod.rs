//! Integration with rapier elsewhere than in the step.
//!
//! - Builders of colliders and shapes: `collider.rs`. rapier's settings for small bodies: `parameters.rs`.
//! - Debug lines: `debug_draw.rs`. Saved worlds: `saved_world.rs`.

pub(crate) mod collider;
#[cfg(feature = "debug-render")]
pub(crate) mod debug_draw;
pub(crate) mod parameters;
#[cfg(feature = "serde-serialize")]
pub(crate) mod saved_world;
