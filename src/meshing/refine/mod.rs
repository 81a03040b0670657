//! A better fit with the same primitives: least squares, insertion, swaps, collapse by measured cost.

pub(crate) mod fit;
pub(crate) mod insert;
pub(crate) mod least_squares;
pub(crate) mod measured_collapse;
pub(crate) mod refit;
pub(crate) mod residuals;
pub(crate) mod swaps;
