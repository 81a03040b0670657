//! Fewer primitives: edge collapse by quadrics (Li et al., "Q-MAT", 2015).
//!
//! # Files
//! - The collapse: `collapse.rs`, on the complex of `complex.rs`, in the order of `queue.rs`; where creases stay
//!   `creased.rs`; solid parts and sheets to a number they share `shared_count.rs`.
//! - Its costs: `ball_quadrics.rs` (planes that balls should touch), `merge_cost.rs` (the merged ball),
//!   `crease_cost.rs` (damage to creases), `merged_neighborhood.rs` (what is around a merged ball).
//! - Voids that collapses leave: `voids.rs`.

pub(crate) mod ball_quadrics;
pub(crate) mod collapse;
pub(crate) mod complex;
pub(crate) mod crease_cost;
pub(crate) mod creased;
pub(crate) mod merge_cost;
pub(crate) mod merged_neighborhood;
pub(crate) mod queue;
pub(crate) mod shared_count;
pub(crate) mod voids;
