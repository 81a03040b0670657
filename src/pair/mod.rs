//! One medial mesh against another, or against any body given as swept spheres (layer 3): first contact in motion,
//! distance and contacts at fixed poses.
//!
//! This layer decides which primitives can meet, by bounding spheres and directions; the distance of two primitives is
//! always computed by [`crate::elementary`].
//!
//! # Files
//! - First contact in motion: `first_contact.rs` is the call and `search.rs` the search. Parts of the search:
//!   `swept.rs` (one body in motion), `queue.rs`, `waiting.rs`, `leaves.rs` (two primitives), `convex_pieces.rs` (two
//!   convex pieces) with `piece_contact.rs` and `patch.rs`, `deepening.rs`, `tips.rs`, `ending.rs`. Proofs that two are
//!   apart: `apart.rs`, `path_ends.rs`.
//! - Contacts at fixed poses: `contacts.rs`, in the order of `descent.rs`; of two primitives `primitive_pair.rs`, of two convex pieces (the blocks of a body
//!   with flat faces) `face_contacts.rs`; from a list of primitive pairs `listed.rs`. `contact_list.rs` keeps the
//!   nearest, with `contact_grid.rs`; `thinned.rs` and `held_back.rs` leave some out.
//! - Distance at fixed poses: `distance.rs`. Proofs at fixed poses: `hulls.rs`, `hull_gap.rs`.
//! - What spares a search: `outline.rs`, `near_pairs.rs`, `pair_list.rs`.

mod apart;
mod contact_grid;
mod contact_list;
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
mod patch;
mod path_ends;
mod piece_contact;
mod placement;
mod primitive_pair;
pub(crate) mod primitive_tree;
mod queue;
mod search;
mod sphere_pair;
mod swept;
pub mod thinned;
mod tips;
mod waiting;

pub use contacts::contacts;
pub use distance::nearest_spheres;
pub use first_contact::first_contact;
pub use held_back::RelativeMotionBound;
pub(crate) use hull_gap::Support;
pub(crate) use hulls::DEEP;
pub use listed::contacts_of_listed;
pub use met::{Met, Touch};
pub use primitive_tree::{PrimitiveList, PrimitiveTree};
pub use sphere_pair::SpherePair;
