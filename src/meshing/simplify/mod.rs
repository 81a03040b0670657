//! Fewer primitives: edge collapse by quadrics (Li et al., "Q-MAT", 2015).

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
