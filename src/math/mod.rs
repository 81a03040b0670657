//! Numbers and geometry that know nothing of medial meshes (layer 0).
//!
//! # Files
//! - Closed forms: `nearest.rs` (spheres nearest to each other at a fixed time, paper Eq. 2), `approach.rs` (when two
//!   spheres on straight paths meet, Eq. 4), `motion.rs` (rigid motion, and how far its points leave straight paths),
//!   `clipping.rs` (the part of a polygon on one side of a plane).
//! - Types: `sphere.rs` (a centre and a radius), `lane.rs` (one trait over `f32`, `f64` and eight lanes), `lane_avx.rs`
//!   (eight lanes in an AVX register).
//! - Helpers: `counters.rs` (structs of counters), `least_first.rs` (the order of a heap from which the least key
//!   leaves first), `fast_hash.rs` (hash of a few integers), `portable.rs` (functions with the same last bit on every
//!   platform).
//! - Constants: `tolerance.rs`.

pub(crate) mod approach;
pub(crate) mod clipping;
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
