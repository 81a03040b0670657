//! Makes the surface of a solid from triangles: repair, orientation, creases, the boundary of what overlaps.
//!
//! `repair.rs` calls the stages: `weld.rs`, `shared_faces.rs`, `orient.rs` (with the loose seams of `sew.rs`), `seams.rs`, `patches.rs`
//! (matter or sheet), `openings.rs`; their result is `checked_surface.rs`. Where it overlaps itself: `boundary.rs`,
//! with `flat_boundary.rs`, `hidden.rs` and `folds.rs`. Sharp edges: `creases.rs`; flat faces: `flat_faces.rs`; prisms: `profile.rs`.

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
pub(crate) mod weld;
