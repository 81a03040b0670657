//! One medial mesh against another, or against any body given as swept spheres (layer 3): first contact in motion,
//! distance and contacts at fixed poses.
//!
//! This layer decides which primitives can meet, by bounding spheres and directions; the distance of two primitives is
//! always computed by [`crate::elementary`].
//!
//! # Files
//! - First contact in motion: `first_contact.rs` is the call and `search.rs` the search. Parts of the search:
//!   `swept.rs` (one body in motion), `queue.rs` (what may meet, the soonest first), `waiting.rs` (what is apart for a
//!   while), `leaves.rs` (two primitives), `convex_pieces.rs` (two convex pieces), `deepening.rs` (contacts at the
//!   start that may sink in a little), `tips.rs` (primitives without their thin ends), `ending.rs` (the answer).
//! - Contacts of parts that their neighbours shield: `ghost_contacts.rs`; of first contacts `shielded.rs`.
//! - Where bodies met: `met.rs` (the primitives or faces), `piece_contact.rs` (the place on two convex pieces),
//!   `patch.rs` (flat faces on each other).
//! - Proofs that two are apart: in motion `apart.rs` (along chords) and `path_ends.rs` (in exact rigid motion); at
//!   fixed poses `hulls.rs` (bounds of hulls) and `hull_gap.rs` (their distance).
//! - Contacts at fixed poses: `contacts.rs`, in the order of `descent.rs`; of two primitives `primitive_pair.rs`, of
//!   two convex pieces `face_contacts.rs`, from a list of primitive pairs `listed.rs`. `contact_list.rs` keeps the
//!   nearest, with the grid of `contact_grid.rs`; `thinned.rs` and `held_back.rs` leave some out. A contact itself:
//!   `sphere_pair.rs`.
//! - Distance at fixed poses: `distance.rs`.
//! - What every query is given: `primitive_tree.rs` (a body as spheres under a tree), `placement.rs` (the second body
//!   in the frame of the first).
//! - What spares a search: `outline.rs` (a few directions for the whole bodies), `near_pairs.rs` and `pair_list.rs`
//!   (primitive pairs that may come near each other).

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
pub(crate) mod ghost_contacts;
pub(crate) mod held_back;
mod hull_gap;
mod hulls;
mod leaves;
pub(crate) mod listed;
pub(crate) mod met;
pub mod near_pairs;
pub mod outline;
pub mod pair_list;
pub(crate) mod patch;
mod path_ends;
mod piece_contact;
mod placement;
mod primitive_pair;
pub(crate) mod primitive_tree;
mod queue;
mod search;
mod shielded;
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
pub(crate) use hulls::FILTER_DEPTH;
pub use listed::contacts_of_listed;
pub use met::{Met, Touch};
pub use primitive_tree::{PrimitiveList, PrimitiveTree};
pub use sphere_pair::SpherePair;
