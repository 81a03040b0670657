//! The source surface, checked, welded and oriented (`repair.rs`), in the builder's frame, in which its
//! longest side is 1 and its box is centred at the origin.

use crate::math::Vector;
use crate::math::fast_hash::FastMap;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::watch::bytes_of;

/// Map from the user's unit and origin to the builder's, and back.
#[derive(Clone, Copy, Debug)]
pub struct BuilderFrame {
    /// Middle of the source's box, in the user's unit.
    pub center: Point,
    /// Longest side of the source's box, in the user's unit.
    pub scale: f64,
}

impl BuilderFrame {
    /// Converts to the builder's frame.
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
    pub frame: BuilderFrame,
    /// Sum of the triangles' areas (longest side 1).
    pub area: f64,
    /// Whether each triangle is a sheet's, and bounds no matter.
    pub sheet: Vec<bool>,
    /// The patch of each triangle; see [`crate::meshing::surface::orient`].
    pub patch_of: Vec<u32>,
    /// Whether each patch bounds matter by itself, but for small openings, and faces outward.
    pub whole: Vec<bool>,
    /// Triangles that close the small openings of patches that bound matter, and their normals: the boundary of the
    /// solid, where the source has none.
    pub lids: Vec<([Point; 3], Point)>,
    /// Width up to which cracks in matter count as matter (longest side 1), if that is more than rounding.
    pub cracks: f64,
    /// Whether the triangles that are no sheet's close a volume without overlaps.
    pub simple: bool,
    /// Faults found and what was done about them.
    pub findings: Findings,
}

impl Surface {
    /// Bytes of its arrays.
    pub fn bytes(&self) -> usize {
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
            whole: self.whole.clone(),
            cracks: self.cracks,
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
            whole: self.whole.clone(),
            lids: Vec::new(),
            cracks: self.cracks,
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

/// Corners of a triangle of these vertices.
pub fn corners(vertices: &[Point], t: &[u32; 3]) -> [Point; 3] {
    t.map(|v| vertices[v as usize])
}

/// Normal of a triangle, as long as twice its area.
pub fn cross([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a)
}
