//! Certificates of a result: that it covers the surface, how far it is off, its mass.
//!
//! `enclose.rs` raises radii until the solid covers the surface, and proves it; `hausdorff.rs` measures the error, by
//! the branch and bound of `largest.rs`; `mass.rs` has the mass of the source.

mod coverage_cuts;
pub(crate) mod enclose;
pub mod hausdorff;
pub(crate) mod inside;
pub(crate) mod largest;
pub(crate) mod mass;
pub(crate) mod prepared_primitives;
pub(crate) mod primitive_tree;
