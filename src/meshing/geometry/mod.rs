//! Boxes, triangles, trees and orders of points: what every stage of a build computes with.
//!
//! # Files
//! - Points and boxes: `bounds.rs`, four boxes side by side `four_boxes.rs`.
//! - Triangles: `triangle.rs` (nearest point, solid angle), `nearest_triangle.rs` (distances to many),
//!   `triangle_tree.rs` (the tree over them), `winding.rs` (how often they wind round a point), `closed.rs` (whether
//!   they close a surface), `subdivide.rs` (into smaller ones), `polygon_triangles.rs` (a polygon with holes cut into
//!   triangles).
//! - Planes: `convex.rs` (convex polyhedra cut by them), `quadric.rs` (squared distances of a sphere to them).
//! - Helpers: `chunks.rs` (work on all cores), `random.rs` (seeded), `union_find.rs` (groups of indices).

pub(crate) mod bounds;
pub(crate) mod chunks;
pub(crate) mod closed;
pub(crate) mod convex;
pub(crate) mod four_boxes;
pub(crate) mod nearest_triangle;
pub(crate) mod polygon_triangles;
pub(crate) mod quadric;
pub(crate) mod random;
pub(crate) mod subdivide;
pub(crate) mod triangle;
pub(crate) mod triangle_tree;
pub(crate) mod union_find;
pub(crate) mod winding;
