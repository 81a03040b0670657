//! Numbers and geometry that know nothing of medial meshes (layer 0).
//!
//! # Files
//! - Closed forms: `nearest.rs` (paper Eq. 2 at a fixed time), `approach.rs` (Eq. 4 for spheres), `motion.rs` (rigid
//!   motion and sagitta).
//! - Constants: `tolerance.rs`. Counters: `counters.rs`. Lanes: `lane.rs`, `lane_avx.rs`.

pub(crate) mod approach;
pub(crate) mod counters;
pub(crate) mod fast_hash;
pub mod lane;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lane_avx;
pub(crate) mod least_first;
pub mod motion;
pub mod nearest;
pub(crate) mod portable;
pub(crate) mod sphere;
pub mod tolerance;

/// Position (translation and rotation), as in rapier's API.
pub use parry3d::math::Pose;
/// The scalar of rapier's world: `f32`, lengths in the user's unit (metres in rapier).
pub use parry3d::math::Real;
/// Unit quaternion, as in rapier's API.
pub use parry3d::math::Rotation;
/// Point or direction, as in rapier's API.
pub use parry3d::math::Vector;
