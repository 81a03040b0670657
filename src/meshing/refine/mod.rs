//! A better fit with the same primitives: least squares, insertion, swaps, collapse by measured cost.
//!
//! # Files
//! - The order: `fit.rs`.
//! - What it tries: `refit.rs` (centres and radii by least squares), `insert.rs` (new primitives where the error is
//!   largest), `swaps.rs` (primitives moved there), `measured_collapse.rs` (collapse by measured cost).
//! - The least squares: `residuals.rs` (errors at samples), `least_squares.rs` (the linear step).

pub(crate) mod fit;
pub(crate) mod insert;
pub(crate) mod least_squares;
pub(crate) mod measured_collapse;
pub(crate) mod refit;
pub(crate) mod residuals;
pub(crate) mod swaps;
