//! Integration with rapier elsewhere than in the step: builders, debug lines, saved worlds.

pub(crate) mod collider;
#[cfg(feature = "debug-render")]
pub(crate) mod debug_draw;
pub(crate) mod parameters;
#[cfg(feature = "serde-serialize")]
pub(crate) mod saved_world;
