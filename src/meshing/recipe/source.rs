//! Source of a build: the checked surface with its tree, and the limits.

use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::options::BuildLimits;
use crate::meshing::surface::boundary::Boundary;
use crate::meshing::surface::checked_surface::Surface;

/// Note on a result that is not what the source was.
pub const GAVE_UP: &str =
    "holes or parts were given up to reach the number of primitives: with more they are kept";

/// The checked surface, its tree, and what to build from it.
pub struct Source {
    pub surface: Surface,
    pub tree: TriangleTree,
    pub limits: BuildLimits,
    /// The boundary of the solid, where some of the surface is hidden inside it.
    pub boundary: Option<Boundary>,
}

impl Source {
    /// The source of a build, none of whose surface is known to be hidden yet.
    pub fn new(surface: Surface, tree: TriangleTree, limits: BuildLimits) -> Self {
        Self {
            surface,
            tree,
            limits,
            boundary: None,
        }
    }
}
