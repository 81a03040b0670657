//! Joints in impacts: bodies held together move as one system.
//!
//! `jointed_bodies.rs` is what the event loop calls; the maths is in `tied_system.rs`, with the rows of `rows.rs`,
//! solved by `skyline.rs`; limits: `limits.rs` and `stops.rs`; in which pieces of the step bodies move: `pieces.rs`.

pub(crate) mod jointed_bodies;
pub(crate) mod limits;
pub(crate) mod pieces;
pub(crate) mod rows;
pub(crate) mod skyline;
mod stops;
pub(crate) mod tied_system;
