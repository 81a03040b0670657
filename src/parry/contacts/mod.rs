//! Contact manifolds of medial meshes.
//!
//! - Of two meshes: `manifolds.rs`. With a flat face: `flat_face.rs`. With others they are parry's, between the convex
//!   parts that `convex_parts.rs` lists, for bodies of any size (`scaled_contact.rs`). Points and normals of a
//!   manifold: `manifold_points.rs`.
//! - Which contacts stay: those that bear the load (`contact_reduction.rs`); impulses of the step before are handed on
//!   (`previous_contacts.rs`).
//! - The one contact of bodies that are deep in each other: `deep_contact.rs`.

pub mod contact_reduction;
pub(crate) mod convex_parts;
pub(crate) mod deep_contact;
pub(crate) mod flat_face;
pub(crate) mod manifold_points;
pub(crate) mod manifolds;
pub mod previous_contacts;
pub(crate) mod scaled_contact;
