//! Boxes, triangles, trees and orders of points: what every stage of a build computes with.

pub(crate) mod bounds;
pub(crate) mod chunks;
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
