//! The source surface: checked, welded, oriented, and brought to the builder's frame, in which its
//! longest side is 1 and its box is centred at the origin.

use super::bounds::{Bounds, Point, direction};
use super::findings::Findings;
use super::openings::lids;
use super::orient::{Patches, orient};
use super::patches::{Kind, judge};
use super::seams::seam_slivers;
use super::triangle_tree::TriangleTree;
use super::watch::{Watch, bytes_of};
use super::weld::{Welded, weld};
use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::math::{Real, Vector};

/// A triangle lower than this over its longest edge has no usable normal and no area that matters
/// (longest side 1). It still closes the surface: it counts as a neighbour, not as a triangle.
const NEEDLE: f64 = 1e-7;

/// From the user's unit and origin to the builder's, and back.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Middle of the source's box, in the user's unit.
    pub center: Point,
    /// Longest side of the source's box, in the user's unit.
    pub scale: f64,
}

impl Frame {
    /// To the builder's frame.
    pub fn enter(&self, v: Vector) -> Point {
        (Point::from_vector(v) - self.center) * (1.0 / self.scale)
    }
}

/// A triangle mesh that the stages can rely on: finite, no needles, consistently oriented where
/// that is possible.
#[derive(Clone)]
pub struct Surface {
    /// Welded vertices, in the builder's frame.
    pub vertices: Vec<Point>,
    /// Triangles with area; their vertices differ.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles without area, of three vertices or fewer. They are covered, and measured as far as they
    /// stick out, and count for nothing else.
    pub needles: Vec<[u32; 3]>,
    /// How far welding moved a vertex at most (longest side 1).
    pub welded: f64,
    /// Unit normal of each triangle, outward where the surface is closed.
    pub normals: Vec<Point>,
    /// How to get back to the user's unit.
    pub frame: Frame,
    /// Sum of the triangles' areas (longest side 1).
    pub area: f64,
    /// Whether each triangle is a sheet's, and bounds no matter.
    pub sheet: Vec<bool>,
    /// The patch of each triangle; see [`super::orient`].
    pub patch_of: Vec<u32>,
    /// Triangles that close the small openings of patches that bound matter, and their normals: the boundary of the
    /// solid, where the source has none.
    pub lids: Vec<([Point; 3], Point)>,
    /// Whether the triangles that are no sheet's close a volume without overlaps.
    pub simple: bool,
    /// What was found and what was done about it.
    pub findings: Findings,
}

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
        let Welded {
            vertices,
            mut triangles,
            collapsed,
            moved,
        } = weld(&entered, indices, &mut findings, watch)?;
        drop(entered);
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
            simple: false,
            findings,
        };
        let corners_of = |i: usize| surface.corners(i);
        let mut tree = TriangleTree::new(surface.triangles.len(), corners_of, watch)?;
        watch.keep(surface.bytes() + tree.bytes());
        surface.sort(patches, &mut tree, watch)?;
        Ok((surface, tree))
    }

    /// Has the patches judged, and takes down what came out.
    fn sort(
        &mut self,
        mut patches: Patches,
        tree: &mut TriangleTree,
        watch: &mut Watch,
    ) -> Result<(), BuildError> {
        let mut findings = std::mem::take(&mut self.findings);
        let kinds = judge(self, &mut patches, tree, &mut findings, watch)?;
        let mut ends = vec![false; kinds.len()];
        for &(_, patch) in &patches.open_edges {
            ends[patch as usize] = true;
        }
        let mut simple = !findings.overlapping;
        for ((patch, kind), ends) in patches.list.iter().zip(&kinds).zip(ends) {
            match kind {
                Kind::Solid => {
                    findings.patches_solid += 1;
                    findings.patches_mended += usize::from(ends);
                    findings.patches_cavity += usize::from(patch.closed && patch.volume < 0.0);
                    simple &= patch.closed && !patch.twisted;
                }
                Kind::Sheet => {
                    findings.patches_sheet += 1;
                    findings.patches_flat += usize::from(patch.closed);
                }
            }
        }
        let closed = |p: u32| kinds[p as usize] == Kind::Solid;
        self.lids = lids(&self.vertices, &patches, closed, tree, watch)?;
        self.simple = simple;
        self.sheet = patches
            .of
            .iter()
            .map(|&p| kinds[p as usize] == Kind::Sheet)
            .collect();
        self.patch_of = patches.of;
        self.findings = findings;
        Ok(())
    }

    /// Bytes of its arrays.
    fn bytes(&self) -> usize {
        let triangles = bytes_of(&self.triangles) + bytes_of(&self.needles);
        let of_each = bytes_of(&self.normals) + bytes_of(&self.patch_of) + self.triangles.len();
        bytes_of(&self.vertices) + triangles + of_each
    }

    /// The triangles that `wanted` says, as a surface of their own.
    pub fn part(&self, wanted: impl Fn(usize) -> bool) -> Self {
        let of = |i: &usize| wanted(*i);
        let chosen: Vec<usize> = (0..self.triangles.len()).filter(of).collect();
        let triangles: Vec<[u32; 3]> = chosen.iter().map(|&i| self.triangles[i]).collect();
        Self {
            vertices: self.vertices.clone(),
            normals: chosen.iter().map(|&i| self.normals[i]).collect(),
            area: triangles
                .iter()
                .map(|t| 0.5 * cross(corners(&self.vertices, t)).length())
                .sum(),
            triangles,
            needles: Vec::new(),
            welded: self.welded,
            frame: self.frame,
            lids: Vec::new(),
            sheet: chosen.iter().map(|&i| self.sheet[i]).collect(),
            patch_of: chosen.iter().map(|&i| self.patch_of[i]).collect(),
            simple: self.simple,
            findings: self.findings.clone(),
        }
    }

    /// Pieces of triangles, each with its triangle, and all lids, as a surface of their own.
    pub fn of_pieces(&self, pieces: &[([Point; 3], usize)]) -> Self {
        let mut index_of: FastMap<[u64; 3], u32> = FastMap::default();
        let mut vertices = Vec::new();
        let lids = self.lids.iter();
        let own = pieces.iter().map(|p| p.1);
        let mut index = |p: Point| {
            *index_of
                .entry([p.x, p.y, p.z].map(f64::to_bits))
                .or_insert_with(|| {
                    vertices.push(p);
                    vertices.len() as u32 - 1
                })
        };
        let all = pieces.iter().map(|(piece, _)| piece);
        let all = all.chain(lids.clone().map(|(lid, _)| lid));
        let triangles: Vec<[u32; 3]> = all.clone().map(|t| t.map(&mut index)).collect();
        let area = all.map(|t| 0.5 * cross(*t).length()).sum();
        let needles = self.needles.iter();
        let needles = needles.map(|t| corners(&self.vertices, t).map(&mut index));
        Self {
            needles: needles.collect(),
            vertices,
            triangles,
            normals: own
                .clone()
                .map(|t| self.normals[t])
                .chain(lids.clone().map(|l| l.1))
                .collect(),
            area,
            sheet: own
                .clone()
                .map(|t| self.sheet[t])
                .chain(lids.clone().map(|_| false))
                .collect(),
            patch_of: own
                .map(|t| self.patch_of[t])
                .chain(lids.map(|_| 0))
                .collect(),
            lids: Vec::new(),
            simple: self.simple,
            welded: self.welded,
            frame: self.frame,
            findings: self.findings.clone(),
        }
    }

    /// Corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point; 3] {
        corners(&self.vertices, &self.triangles[triangle])
    }

    /// Corners of all triangles without area.
    pub fn needle_corners(&self) -> impl ExactSizeIterator<Item = [Point; 3]> + Clone + '_ {
        self.needles.iter().map(|t| corners(&self.vertices, t))
    }

    /// Corners of all triangles, in order.
    pub fn all_corners(&self) -> impl ExactSizeIterator<Item = [Point; 3]> + Clone + '_ {
        (0..self.triangles.len()).map(|i| self.corners(i))
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
    }
    Ok(())
}

/// The frame from the box of the vertices that triangles use: a stray vertex must not shrink the
/// rest.
fn frame_of(vertices: &[Vector], indices: &[[u32; 3]]) -> Result<Frame, BuildError> {
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
    Ok(Frame {
        center: bounds.center(),
        scale,
    })
}

fn corners(vertices: &[Point], t: &[u32; 3]) -> [Point; 3] {
    t.map(|v| vertices[v as usize])
}

fn cross([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a)
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
