//! Folds: where a part of a surface passes through itself so that its inside is out, as noise does where triangles are
//! small. The winding number is −1 there, and 0 where another part encloses it: that is matter, and no void.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;

/// Folds of a surface: tells which points are inside matter, with folds counted as matter.
pub struct Folds<'a> {
    tree: &'a TriangleTree,
    /// The trees of patches that bound matter by themselves.
    own: Vec<Option<TriangleTree>>,
}

impl<'a> Folds<'a> {
    /// The folds for points next to a surface, whose tree is `tree`.
    pub fn new(
        surface: &Surface,
        tree: &'a TriangleTree,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); surface.whole.len()];
        for (t, &patch) in surface.patch_of.iter().enumerate() {
            watch.every(t)?;
            if surface.whole[patch as usize] {
                triangles[patch as usize].push(t as u32);
            }
        }
        let mut own = Vec::with_capacity(triangles.len());
        let mut bytes = 0;
        for of_patch in &triangles {
            // One that is all of the surface has no other around it.
            if of_patch.is_empty() || of_patch.len() == surface.triangles.len() {
                own.push(None);
                continue;
            }
            let corners = |i: usize| surface.corners(of_patch[i] as usize);
            let tree = TriangleTree::new(of_patch.len(), corners, watch)?;
            bytes += tree.bytes();
            own.push(Some(tree));
        }
        watch.hold(bytes);
        Ok(Self { tree, own })
    }

    /// Whether there is matter at a point next to a patch; adds the points and triangles looked at to `work`.
    pub fn is_inside(&self, p: Point, patch: u32, work: &mut usize) -> bool {
        let all = self.tree.winding_counted(p, work);
        let own = &self.own[patch as usize];
        all > INSIDE
            || own.as_ref().is_some_and(|own| {
                let own = own.winding_counted(p, work);
                own < 0.0 && all - own > INSIDE
            })
    }
}
