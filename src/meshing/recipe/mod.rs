//! Which candidates a build makes, in which order, and which of them it returns.
//!
//! # Files
//! - The order: `pipeline.rs`. What it starts from: `source.rs`. A possible result: `candidate.rs`.
//! - Exact ones: `polyhedron.rs` (convex), `pieces.rs` (flat faces), `extruded.rs` (prisms, gears with ribs). With
//!   fewer primitives: `reduced.rs`.
//! - Fitted ones: `ladder.rs` (a collapsed mesh for any number of primitives), `counts.rs` (how many primitives),
//!   `tightened.rs` (covers the surface closely), `smallest.rs` (for a given error).

pub(crate) mod candidate;
pub(crate) mod counts;
pub(crate) mod extruded;
pub(crate) mod ladder;
pub(crate) mod pieces;
pub(crate) mod pipeline;
pub(crate) mod polyhedron;
pub(crate) mod reduced;
pub(crate) mod smallest;
pub(crate) mod source;
pub(crate) mod tightened;
