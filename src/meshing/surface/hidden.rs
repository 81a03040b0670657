//! Points of a surface that are hidden: there is matter on both sides.
//!
//! Source of the inside test: Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers" (2013).

use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::folds::Folds;

/// Tells which points of a surface are hidden.
pub struct Hidden<'a> {
    /// Tree of the surface.
    pub tree: &'a TriangleTree,
    pub folds: &'a Folds<'a>,
    /// Distance before and behind the surface at which the winding number is asked for (longest side 1).
    pub off: f64,
    /// Points and triangles that winding numbers have looked at.
    pub work: usize,
}

impl Hidden<'_> {
    /// Whether there is matter behind a point of the surface and before it.
    pub fn is_enclosed(&mut self, p: Point, normal: Point) -> bool {
        let mut is_inside = |p: Point| self.tree.winding_counted(p, &mut self.work) > INSIDE;
        is_inside(p + normal * self.off) && is_inside(p - normal * self.off)
    }

    /// Whether there is matter behind a point of the surface and before it, if a fold of the surface's own patch, which
    /// looks like a void, counts as matter.
    pub fn is_in_fold(&mut self, p: Point, patch: u32, normal: Point) -> bool {
        let mut is_inside = |p: Point| self.folds.is_inside(p, patch, &mut self.work);
        is_inside(p + normal * self.off) && is_inside(p - normal * self.off)
    }
}
