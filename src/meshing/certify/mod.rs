//! Certificates of a result: that it covers the surface, how far it is off, its mass.
//!
//! # Files
//! - It covers the surface: `enclose.rs` raises radii until it does, and proves it; `coverage_cuts.rs` cuts faces where
//!   the part that one primitive covers ends.
//! - Its error: `hausdorff.rs`, by the branch and bound of `largest.rs`.
//! - The solid itself: `inside.rs` (the union of the primitives), `primitive_tree.rs` (signed distance to it),
//!   `prepared_primitives.rs` (distance to one primitive for many points).
//! - The mass of the source: `mass.rs`.

mod coverage_cuts;
pub(crate) mod enclose;
pub mod hausdorff;
pub(crate) mod inside;
pub(crate) mod largest;
pub(crate) mod mass;
pub(crate) mod prepared_primitives;
pub(crate) mod primitive_tree;
