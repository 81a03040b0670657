//! Points of a surface that are hidden: there is matter on both sides.
//!
//! Cracks count as matter: where parts that touch leave one, at its bottom a face of a third part would be seen, from
//! far inside the solid.
//!
//! Source of the inside test: Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers" (2013).

use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::folds::Folds;

/// Half the width up to which a crack counts as matter, in units of the distance from its bottom at which it is looked
/// for.
const CRACK: f64 = 0.5;

/// Sine of the angle to the face at its bottom from which walls make a crack: others are the face of another part
/// before it.
const STEEP: f64 = 0.5;

/// Tells which points of a surface are hidden.
pub struct Hidden<'a> {
    /// Tree of the surface.
    pub tree: &'a TriangleTree,
    pub folds: &'a Folds<'a>,
    /// Distance behind the surface at which the winding number is asked for (longest side 1).
    pub off: f64,
    /// The same before it: the width up to which cracks count as matter.
    pub cracks: f64,
    /// Points and triangles that winding numbers have looked at.
    pub work: usize,
}

impl Hidden<'_> {
    /// Whether there is matter behind a point of the surface and before it.
    pub fn is_enclosed(&mut self, p: Point, normal: Point) -> bool {
        let mut is_inside = |p: Point| self.tree.winding_counted(p, &mut self.work) > INSIDE;
        is_before_matter(self.tree, p, normal * self.cracks, &mut is_inside)
            && is_inside(p - normal * self.off)
    }

    /// Whether there is matter behind a point of the surface and before it, if a fold of the surface's own patch, which
    /// looks like a void, counts as matter.
    pub fn is_in_fold(&mut self, p: Point, patch: u32, normal: Point) -> bool {
        let mut is_inside = |p: Point| self.folds.is_inside(p, patch, &mut self.work);
        is_before_matter(self.tree, p, normal * self.cracks, &mut is_inside)
            && is_inside(p - normal * self.off)
    }
}

/// Whether there is matter, or a crack in it, before a point of the surface of `tree`: at `p + off`, where `off` is
/// along its normal.
pub fn is_before_matter(
    tree: &TriangleTree,
    p: Point,
    off: Point,
    mut is_inside: impl FnMut(Point) -> bool,
) -> bool {
    let before = p + off;
    if is_inside(before) {
        return true;
    }
    let length = off.length();
    let normal = direction(off);
    let Some(wall) = tree.closest_within(before, CRACK * length) else {
        return false;
    };
    let to_wall = wall - before;
    let along = to_wall - normal * to_wall.dot(normal);
    if along.length() < STEEP * to_wall.length() {
        return false;
    }
    let across = direction(along) * length;
    is_inside(before + across) && is_inside(before - across)
}
