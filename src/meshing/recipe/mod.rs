//! Which candidates a build makes, in which order, and which of them it returns.
//!
//! - The order: `pipeline.rs`. A possible result: `candidate.rs`.
//! - Exact ones: `polyhedron.rs` (convex), `pieces.rs` (flat faces), `extruded.rs` (prisms, gears with ribs).
//! - Fitted ones: `ladder.rs`, `counts.rs` (how many primitives), `tightened.rs`, `smallest.rs` (for a given error).

pub(crate) mod candidate;
pub(crate) mod counts;
pub(crate) mod extruded;
pub(crate) mod ladder;
pub(crate) mod pieces;
pub(crate) mod pipeline;
pub(crate) mod polyhedron;
pub(crate) mod smallest;
pub(crate) mod source;
pub(crate) mod tightened;
