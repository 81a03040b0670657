//! Corrections of contacts that parry gets wrong, one file for each kind of error (`docs/host.md`).
//!
//! - With triangles: those without a normal or too deep, `false_contacts.rs`, and those that point into a convex piece,
//!   `inward_contacts.rs`.
//! - Normals of edges that just touch a face, `touching_normals.rs`, or voxels, `voxel_normals.rs`.
//! - Those that cannot move a body whose axes are locked, by which rapier's solver divides: `locked_axes.rs`.
//! - Contacts of convex pieces deep in other shapes that push another way than the shortest: `deep_pieces.rs`.
//! - For callers of parry's own dispatcher, normals that point into a convex piece: `outward_normals.rs`.

pub(crate) mod deep_pieces;
pub(crate) mod false_contacts;
pub(crate) mod inward_contacts;
pub(crate) mod locked_axes;
pub(crate) mod outward_normals;
pub(crate) mod touching_normals;
pub(crate) mod voxel_normals;
