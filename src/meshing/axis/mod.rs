//! The medial mesh to start from: the medial axis of samples of the surface, or of flat faces exactly.
//!
//! # Files
//! - From samples: `start.rs` chooses. How far samples are apart: `local_spacing.rs` (by thickness), `wall_samples.rs`
//!   (for thin walls). Their tetrahedra: `delaunay.rs`, points entered in the order of `insertion_order.rs`; the balls:
//!   `inner_balls.rs`, or at one given point `shrinking_ball.rs`.
//! - From samples, with creases: `crease_samples.rs` (samples beside creases), `clip.rs` (the mesh of them),
//!   `crease_ends.rs` (its balls of radius 0), `tangent.rs` (balls made tangent to the faces around them),
//!   `crease_splits.rs` (finer where sheets bend).
//! - Where the surface is a sheet: `sheets.rs`.
//! - Exactly: a convex body of flat faces `flat_axis.rs` (over `roof.rs`, less the sheets that `blunt_sheets.rs` leaves
//!   out), one that is not convex `convex_pieces.rs`, a prism `prism_axis.rs` (over `wavefront.rs`), a prism with
//!   teeth, webs or thin walls, as of gears, `ribs.rs`. Their sheets are cut into triangles by `sheet_triangles.rs`.

pub(crate) mod blunt_sheets;
pub(crate) mod clip;
pub(crate) mod convex_pieces;
pub(crate) mod crease_ends;
pub(crate) mod crease_samples;
pub(crate) mod crease_splits;
pub mod delaunay;
pub(crate) mod flat_axis;
pub(crate) mod inner_balls;
pub(crate) mod insertion_order;
pub(crate) mod local_spacing;
pub(crate) mod prism_axis;
pub(crate) mod ribs;
pub(crate) mod roof;
pub(crate) mod sheet_triangles;
pub(crate) mod sheets;
pub(crate) mod shrinking_ball;
pub(crate) mod start;
pub(crate) mod tangent;
pub(crate) mod wall_samples;
pub(crate) mod wavefront;
