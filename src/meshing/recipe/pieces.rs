//! The medial mesh of a body of flat faces that is not convex: the medial axes of convex pieces that overlap
//! (`convex_pieces.rs`), each of which is exact (`polyhedron.rs`).

use crate::error::BuildError;
use crate::meshing::axis::convex_pieces::{MOST_PLANES, Piece, convex_pieces};
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::convex::{ON, Plane};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::options::Variant;
use crate::meshing::recipe::candidate::Candidate;
use crate::meshing::recipe::polyhedron::{MOST, axis};
use crate::meshing::recipe::source::Source;
use crate::meshing::surface::checked_surface::{Surface, cross};
use crate::meshing::surface::flat_faces::{FlatFaces, flat_faces};
use crate::meshing::watch::Watch;

/// Pieces are used if the medial mesh is off by less than this (longest side 1): what rounding of the source to `f32`
/// makes of it, some sizes from its origin. Larger, and bodies whose faces are not quite flat count as exact.
const CLOSE: f64 = 1e-5;

/// The union of the pieces misses the source by this at most (longest side 1): corners this near to a plane are on it, in
/// cells and in pieces.
const MISSED: f64 = 2.0 * ON;

impl Source {
    /// The medial axes of convex pieces of the body, if these are within the limit on the count.
    pub fn pieces(&self, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        let surface = &self.surface;
        let Some(angle) = self.limits.creases.angle_of_flat() else {
            return Ok(None);
        };
        if !surface.simple || surface.sheet.contains(&true) || !surface.lids.is_empty() {
            return Ok(None);
        }
        let body = (0..surface.triangles.len()).collect();
        let Some(faces) = flat_faces(surface, body, 2 * MOST_PLANES, watch)? else {
            return Ok(None);
        };
        let planes = distinct(faces.planes);
        if planes.len() > MOST_PLANES {
            return Ok(None);
        }
        let Some(pieces) = convex_pieces(&planes, &self.tree, watch)? else {
            return Ok(None);
        };
        let most = self.limits.primitives.unwrap_or(MOST).min(MOST);
        let mut draft = Draft::default();
        let mut growth: f64 = 0.0;
        for piece in &pieces {
            let left = most.saturating_sub(draft.faces.len());
            let (surface, faces) = self.surface_of(piece);
            let corners = |t: usize| surface.corners(t);
            let tree = TriangleTree::new(surface.triangles.len(), corners, watch)?;
            let limits = (angle.cos(), CLOSE);
            let Some(axis) = axis(&surface, &tree, &faces, limits, left, watch)? else {
                return Ok(None);
            };
            growth = growth.max(axis.growth);
            draft = draft.and(axis.draft);
        }
        let count = draft.faces.len();
        let before = self.limits.enclose.then(|| draft.clone());
        let grown = match self.limits.enclose {
            true => (growth + MISSED + surface.welded - self.limits.allow_uncovered).max(0.0),
            false => 0.0,
        };
        draft.balls.iter_mut().for_each(|ball| ball.radius += grown);
        let enclosed = self.measured(draft, before, Effort::CLOSE, watch)?;
        // Triangles without area may stick out of the pieces, which are of the others alone.
        let uncovered = f64::from(enclosed.hausdorff.uncovered);
        let is_short = self.limits.enclose && uncovered > self.limits.allow_uncovered;
        if is_short || enclosed.error() > CLOSE {
            return Ok(None);
        }
        let mut candidate = self.reported(enclosed, watch)?;
        candidate.variant = Variant::Exact;
        candidate.notes.push(format!(
            "{} convex pieces that overlap: their medial axes have {count} primitives, and are exact",
            pieces.len()
        ));
        Ok(Some(candidate))
    }

    /// The surface of a piece, with the source's own vertices where its corners are at these.
    fn surface_of(&self, piece: &Piece) -> (Surface, FlatFaces) {
        let mut vertices: Vec<Point> = Vec::new();
        let mut index = |p: Point| {
            let near = |q: &Point| (p - *q).length() <= 2.0 * ON;
            vertices.iter().position(near).unwrap_or_else(|| {
                let own = self.surface.vertices.iter().find(|q| near(q));
                vertices.push(*own.unwrap_or(&p));
                vertices.len() - 1
            }) as u32
        };
        let mut triangles = Vec::new();
        let mut face_of = Vec::new();
        for face in &piece.solid.faces {
            let mut corners: Vec<u32> = face.corners.iter().map(|p| index(*p)).collect();
            corners.dedup();
            let fan = corners[1..].windows(2);
            for w in fan {
                let triangle = [corners[0], w[0], w[1]];
                if triangle[0] != triangle[1]
                    && triangle[1] != triangle[2]
                    && triangle[0] != triangle[2]
                {
                    face_of.push((triangles.len(), face.plane));
                    triangles.push(triangle);
                }
            }
        }
        let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
        let area = triangles
            .iter()
            .map(|t| 0.5 * cross(corners(t)).length())
            .sum();
        let count = triangles.len();
        let planes = piece.planes.clone();
        let surface = Surface {
            normals: face_of
                .iter()
                .map(|f| planes[f.1 as usize].normal)
                .collect(),
            vertices,
            triangles,
            needles: Vec::new(),
            welded: 0.0,
            frame: self.surface.frame,
            area,
            sheet: vec![false; count],
            patch_of: vec![0; count],
            lids: Vec::new(),
            simple: true,
            findings: Default::default(),
        };
        (surface, FlatFaces { planes, face_of })
    }
}

/// Planes less those that are others, of which faces look the other way or are apart.
fn distinct(planes: Vec<Plane>) -> Vec<Plane> {
    let mut all: Vec<Plane> = Vec::new();
    for plane in planes {
        let same = |other: &Plane| {
            [1.0, -1.0].into_iter().any(|sign| {
                let turned = (other.normal - plane.normal * sign).length();
                turned <= ON && (other.offset - plane.offset * sign).abs() <= ON
            })
        };
        if !all.iter().any(same) {
            all.push(plane);
        }
    }
    all
}
