//! Makes a [`Surface`] of the user's triangles: checked, welded, oriented, sorted into what bounds matter and what is a
//! sheet, and brought to the builder's frame.

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::check::LARGEST_REACH;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::{Bounds, Point, direction};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::{BuilderFrame, Surface, corners, cross};
use crate::meshing::surface::openings::{OPEN, lids, openings};
use crate::meshing::surface::orient::{Patches, orient};
use crate::meshing::surface::patches::{PatchKind, classify};
use crate::meshing::surface::seams::seam_slivers;
use crate::meshing::surface::shared_faces::leave_out_shared;
use crate::meshing::surface::weld::{Welded, weld};
use crate::meshing::watch::Watch;

/// A triangle lower than this over its longest edge has no usable normal and no area that matters
/// (longest side 1). It still closes the surface: it counts as a neighbour, not as a triangle.
const NEEDLE: f64 = 1e-7;

impl Surface {
    /// Checks and cleans a triangle mesh given in the user's unit, and finds out what bounds matter
    /// and what is a sheet; also gives the tree of its triangles, whose winding number counts only
    /// what bounds matter.
    pub fn new(
        vertices: &[Vector],
        indices: &[[u32; 3]],
        watch: &mut Watch,
    ) -> Result<(Self, TriangleTree), BuildError> {
        check(vertices, indices, watch)?;
        let frame = frame_of(vertices, indices)?;
        let mut findings = Findings::default();
        let entered: Vec<Point> = vertices.iter().map(|&v| frame.enter(v)).collect();
        let mut welded = weld(&entered, indices, &mut findings, watch)?;
        drop(entered);
        leave_out_shared(&mut welded, &mut findings, watch)?;
        let Welded {
            vertices,
            mut triangles,
            collapsed,
            moved,
            ..
        } = welded;
        let slivers = seam_slivers(&vertices, &triangles, watch)?;
        findings.slivers = slivers.len();
        let given = triangles.len();
        triangles.extend(slivers);
        let mut patches = orient(&vertices, &mut triangles, &mut findings, watch)?;
        let slivers = triangles.split_off(given);
        patches.of.truncate(given);
        let area_of = |t: &[u32; 3]| height(corners(&vertices, t)) >= NEEDLE;
        let mut keep = triangles.iter().map(area_of);
        patches.of.retain(|_| keep.next().unwrap_or(false));
        let (triangles, mut needles): (Vec<_>, Vec<_>) = triangles.into_iter().partition(area_of);
        findings.triangles_without_area = needles.len();
        needles.extend(slivers);
        needles.extend(collapsed);
        if triangles.is_empty() {
            let side = frame.scale;
            return Err(BuildError::ZeroSize {
                message: format!(
                    "none of {} triangles has an area (longest side of the box {side})",
                    indices.len()
                ),
            });
        }
        watch.at(0.5)?;
        let crosses = triangles.iter().map(|t| cross(corners(&vertices, t)));
        let (normals, areas): (Vec<Point>, Vec<f64>) =
            crosses.map(|c| (direction(c), 0.5 * c.length())).unzip();
        let mut surface = Self {
            area: areas.iter().sum(),
            normals,
            vertices,
            triangles,
            needles,
            welded: moved,
            frame,
            sheet: Vec::new(),
            lids: Vec::new(),
            patch_of: Vec::new(),
            whole: Vec::new(),
            cracks: 0.0,
            simple: false,
            findings,
        };
        let corners_of = |i: usize| surface.corners(i);
        let mut tree = TriangleTree::new(surface.triangles.len(), corners_of, watch)?;
        watch.keep(surface.bytes() + tree.bytes());
        surface.sort(patches, &mut tree, watch)?;
        Ok((surface, tree))
    }

    /// Judges the patches, and takes down what came out.
    fn sort(
        &mut self,
        mut patches: Patches,
        tree: &mut TriangleTree,
        watch: &mut Watch,
    ) -> Result<(), BuildError> {
        let mut findings = std::mem::take(&mut self.findings);
        let kinds = classify(self, &mut patches, tree, &mut findings, watch)?;
        let mut ends = vec![false; kinds.len()];
        for &(_, patch) in &patches.open_edges {
            ends[patch as usize] = true;
        }
        let mut simple = !findings.overlapping;
        for ((patch, kind), ends) in patches.list.iter().zip(&kinds).zip(ends) {
            match kind {
                PatchKind::Solid => {
                    findings.patches_solid += 1;
                    findings.patches_mended += usize::from(ends);
                    findings.patches_cavity += usize::from(patch.closed && patch.volume < 0.0);
                    simple &= patch.closed && !patch.twisted;
                }
                PatchKind::Sheet => {
                    findings.patches_sheet += 1;
                    findings.patches_flat += usize::from(patch.closed);
                }
            }
        }
        let closed = |p: u32| kinds[p as usize] == PatchKind::Solid;
        self.lids = lids(&self.vertices, &patches, closed, tree, watch)?;
        self.simple = simple;
        // The vectors of the areas of what is closed add up to nothing.
        let mut vectors = vec![Point::zero(); kinds.len()];
        for (t, &patch) in patches.of.iter().enumerate() {
            vectors[patch as usize] = vectors[patch as usize] + cross(self.corners(t)) * 0.5;
        }
        let is_whole = |p: usize| {
            let patch = &patches.list[p];
            let is_closed = vectors[p].length() < OPEN * patch.area;
            kinds[p] == PatchKind::Solid && is_closed && patch.volume > 0.0
        };
        self.whole = (0..kinds.len()).map(is_whole).collect();
        for wide in openings(&self.vertices, &patches, watch)? {
            self.whole[wide.patch as usize] = false;
        }
        self.sheet = patches
            .of
            .iter()
            .map(|&p| kinds[p as usize] == PatchKind::Sheet)
            .collect();
        self.patch_of = patches.of;
        self.findings = findings;
        Ok(())
    }
}

fn check(vertices: &[Vector], indices: &[[u32; 3]], watch: &mut Watch) -> Result<(), BuildError> {
    if indices.is_empty() {
        return Err(BuildError::Empty {
            vertices: vertices.len(),
        });
    }
    if let Some(index) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(BuildError::NotFinite {
            index,
            position: vertices[index].into(),
        });
    }
    let count = vertices.len();
    for (index, triangle) in indices.iter().enumerate() {
        watch.every(index)?;
        if let Some(&value) = triangle.iter().find(|&&v| v as usize >= count) {
            return Err(BuildError::IndexOutOfRange {
                index,
                value: value.into(),
                count,
            });
        }
        let is_far = |v: &&u32| vertices[**v as usize].abs().max_element() > LARGEST_REACH;
        if let Some(&vertex) = triangle.iter().find(is_far) {
            return Err(BuildError::TooFar {
                index: vertex as usize,
                position: vertices[vertex as usize].into(),
                most: LARGEST_REACH,
            });
        }
    }
    Ok(())
}

/// The frame from the box of the vertices that triangles use: a stray vertex must not shrink the
/// rest.
fn frame_of(vertices: &[Vector], indices: &[[u32; 3]]) -> Result<BuilderFrame, BuildError> {
    let used = indices
        .iter()
        .flatten()
        .map(|&v| Point::from_vector(vertices[v as usize]));
    let bounds = Bounds::of(used);
    let scale = bounds.longest_side();
    if scale <= 0.0 {
        return Err(BuildError::ZeroSize {
            message: format!(
                "all triangles lie in the point {:?}",
                <[Real; 3]>::from(bounds.lo.to_vector())
            ),
        });
    }
    Ok(BuilderFrame {
        center: bounds.center(),
        scale,
    })
}

/// Height of a triangle over its longest edge.
fn height(t: [Point; 3]) -> f64 {
    let longest_sq = (t[1] - t[0])
        .length_sq()
        .max((t[2] - t[1]).length_sq())
        .max((t[0] - t[2]).length_sq());
    if longest_sq > 0.0 {
        cross(t).length() / longest_sq.sqrt()
    } else {
        0.0
    }
}
