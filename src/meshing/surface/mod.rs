//! Makes the surface of a solid from triangles: repair, orientation, creases, the boundary of what overlaps.
//!
//! # Files
//! - The stages, which `repair.rs` calls: `weld.rs` (vertices at one place), `shared_faces.rs` (faces that two parts
//!   share), `orient.rs` (patches that face one way, with the loose seams of `sew.rs`), `seams.rs` (edges along
//!   others), `patches.rs` (matter or sheet), `openings.rs` (rims and lids). Their result is `checked_surface.rs`.
//! - Where it overlaps itself: `boundary.rs` (triangles with matter on one side only), exactly for flat faces
//!   `flat_boundary.rs`; `hidden.rs` (points with matter on both sides), `folds.rs` (parts turned inside out),
//!   `uneven_parts.rs` (kits whose vertices are off, with cracks between their parts).
//! - What later stages ask of it: `edges.rs` (edges and shells), `creases.rs` (sharp edges), `flat_faces.rs`,
//!   `touching.rs` (bodies that share faces), `profile.rs` (prisms), `samples.rs` (points spread evenly).

pub(crate) mod boundary;
pub(crate) mod checked_surface;
pub(crate) mod creases;
pub(crate) mod edges;
pub(crate) mod flat_boundary;
pub(crate) mod flat_faces;
pub(crate) mod folds;
pub(crate) mod hidden;
pub(crate) mod openings;
pub(crate) mod orient;
pub(crate) mod patches;
pub(crate) mod profile;
pub(crate) mod repair;
pub(crate) mod samples;
pub(crate) mod seams;
pub(crate) mod sew;
pub(crate) mod shared_faces;
pub(crate) mod touching;
pub(crate) mod uneven_parts;
pub(crate) mod weld;
