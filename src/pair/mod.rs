//! One medial mesh against another, or against any body given as swept spheres (layer 3): first contact in motion,
//! distance and contacts at fixed poses.
//!
//! This layer decides which primitives can meet, by bounding spheres and directions; the distance of two primitives is
//! always computed by [`crate::elementary`].

mod apart;
pub mod contacts;
mod convex_pieces;
pub(crate) mod deepening;
mod descent;
pub(crate) mod distance;
mod ending;
mod face_contacts;
pub mod first_contact;
pub(crate) mod held_back;
mod hull_gap;
mod hulls;
mod leaves;
pub(crate) mod listed;
pub(crate) mod met;
pub mod near_pairs;
pub mod outline;
pub mod pair_list;
mod placement;
pub(crate) mod primitive_tree;
mod queue;
mod search;
mod sphere_pair;
mod swept;
mod tips;
mod waiting;

pub use contacts::contacts;
pub use distance::nearest_spheres;
pub use first_contact::first_contact;
pub use held_back::RelativeMotionBound;
pub use listed::contacts_of_listed;
pub use met::{Met, Touch};
pub use primitive_tree::{PrimitiveList, PrimitiveTree};
pub use sphere_pair::SpherePair;
