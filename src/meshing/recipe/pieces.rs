//! The medial mesh of a body of flat faces that is not convex: the medial axes of convex pieces that overlap
//! (`convex_pieces.rs`), each of which is exact (`polyhedron.rs`).

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::axis::convex_pieces::{MOST_PLANES, SolidPiece, convex_pieces};
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::convex::Plane;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::options::{Hausdorff, Variant};
use crate::meshing::recipe::candidate::Candidate;
use crate::meshing::recipe::polyhedron::{MAX_PRIMITIVES, SAME_AREA, axis, faces_of, known};
use crate::meshing::recipe::source::Source;
use crate::meshing::surface::checked_surface::{Surface, cross};
use crate::meshing::surface::flat_faces::{
    FLATNESS, FLATNESS_OF_PARTS, FlatFaces, ON, convex_faces, flat_faces, rounding,
};
use crate::meshing::surface::touching::bodies;
use crate::meshing::surface::uneven_parts::Unevenness;
use crate::meshing::watch::Watch;
use std::borrow::Cow;

/// Pieces are used if the medial mesh is off by less than so many times that. More, and bodies whose faces are not
/// quite flat count as exact.
const EXACT_FACTOR: f64 = 20.0;

/// Error (longest side 1) up to which the parts of an uneven kit are used. Fits of such kits are off by .1 and more,
/// since they close the cracks between parts and stick out beside them.
const CLOSE_OF_UNEVEN: f64 = 0.01;

/// An error up to this (longest side 1) is rounding.
const ROUNDED: f64 = 2e-5;

/// Where pieces are off by too much, corners are taken to be off their planes by less, in units of what failed. All
/// pieces grow by some times that, to enclose the body, and a wedge of air of angle `a` between two of them loses
/// `1 / sin(a / 2)` times as much of its tip: 8 times at 15°, between the end of a lifter and the wall of a drum.
const FINER: f64 = 0.2;

/// A surface that holds a convex piece, and the piece's faces.
type PieceSurface<'a> = (Cow<'a, Surface>, FlatFaces);

/// What comes of convex pieces.
enum Pieces {
    Exact(Box<Candidate>),
    /// Their medial axes are off by too much.
    TooFar,
    /// There are none, or too many.
    None,
}

impl Pieces {
    /// The later one, if it is exact, which has fewer primitives then; else the one that says more.
    fn or(self, later: Self) -> Self {
        match (self, later) {
            (_, Self::Exact(later)) => Self::Exact(later),
            (Self::None, later) => later,
            (earlier, _) => earlier,
        }
    }
}

impl Source {
    /// The medial axes of convex pieces of the body, if these have at most `most` primitives: of the convex parts that
    /// the source consists of, or of those that its faces make, whichever has fewer primitives.
    pub fn pieces(&self, most: usize, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        let most = most.min(MAX_PRIMITIVES);
        if self.bounds().0.sheet.contains(&true) {
            return Ok(None);
        }
        let bodies = match self.surface.simple {
            true => Vec::new(),
            false => bodies(&self.surface, watch)?,
        };
        let coarsest = (!bodies.is_empty()).then_some(FLATNESS_OF_PARTS);
        for flatness in FLATNESS.into_iter().chain(coarsest) {
            let flat = flatness * rounding(&self.surface);
            let close = EXACT_FACTOR * flat;
            for flat in [flat, FINER * flat] {
                match self.pieces_at(&bodies, [flat, close], most, watch)? {
                    Pieces::Exact(candidate) => return Ok(Some(*candidate)),
                    Pieces::TooFar => {}
                    Pieces::None => break,
                }
            }
        }
        self.uneven_pieces(&bodies, most, watch)
    }

    /// The medial axes of the parts of a kit that is more uneven than other exact bodies may be.
    fn uneven_pieces(
        &self,
        bodies: &[Vec<usize>],
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<Candidate>, BuildError> {
        let uneven = self.boundary.as_ref().and_then(|b| b.uneven);
        let Some(Unevenness { flat, cracks }) = uneven else {
            return Ok(None);
        };
        let Some((parts, beside)) = self.own_parts(bodies, flat, most, watch)? else {
            return Ok(None);
        };
        match self.of_parts(&parts, beside, CLOSE_OF_UNEVEN, most, watch)? {
            Pieces::Exact(mut candidate) => {
                let note = format!(
                    "cracks between parts up to {cracks:.4} of the size count as matter: vertices are that far off"
                );
                candidate.notes.push(note);
                Ok(Some(*candidate))
            }
            _ => Ok(None),
        }
    }

    /// The same for corners that are off their planes by at most `flat`, where errors up to `close` count as none.
    /// `bodies` are the triangles of each part of the source, if it has several.
    fn pieces_at(
        &self,
        bodies: &[Vec<usize>],
        [flat, close]: [f64; 2],
        most: usize,
        watch: &mut Watch,
    ) -> Result<Pieces, BuildError> {
        let own = self.own_parts(bodies, flat, most, watch)?;
        let made = self.parts_by_faces(flat, watch)?;
        let mut best = Pieces::None;
        for (parts, beside) in [own, made].into_iter().flatten() {
            let most = match &best {
                Pieces::Exact(best) => best.draft.faces.len() - 1,
                _ => most,
            };
            let next = self.of_parts(&parts, beside, close, most, watch)?;
            best = best.or(next);
        }
        Ok(best)
    }

    /// The parts of a source of convex parts that overlap and are not hidden, and how far its corners may be beside
    /// them; `None` where one of them is not convex.
    fn own_parts(
        &self,
        bodies: &[Vec<usize>],
        flat: f64,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<(Vec<PieceSurface<'_>>, f64)>, BuildError> {
        if bodies.is_empty() {
            return Ok(None);
        }
        let mut is_seen = vec![false; self.surface.whole.len()];
        for &patch in &self.bounds().0.patch_of {
            is_seen[patch as usize] = true;
        }
        let seen = bodies.iter().filter(|body| {
            let mut patches = body.iter().map(|&t| self.surface.patch_of[t]);
            patches.any(|patch| is_seen[patch as usize])
        });
        let most = faces_of(most);
        let mut parts = Vec::new();
        for body in seen {
            let Some(faces) = convex_faces(&self.surface, body.clone(), flat, most, watch)? else {
                return Ok(None);
            };
            parts.push((Cow::Borrowed(&self.surface), faces));
        }
        Ok(Some((parts, flat)))
    }

    /// Convex pieces between the planes of all faces, for corners that are off these planes by at most `flat`, and the
    /// distance by which the source's corners may be outside them. `None` where there are too many pieces.
    fn parts_by_faces(
        &self,
        flat: f64,
        watch: &mut Watch,
    ) -> Result<Option<(Vec<PieceSurface<'_>>, f64)>, BuildError> {
        let on = ON * flat;
        let (surface, _) = self.bounds();
        let body = (0..surface.triangles.len()).collect();
        let Some(faces) = flat_faces(surface, body, flat, 2 * MOST_PLANES, watch)? else {
            return Ok(None);
        };
        let (planes, beyond) = distinct(surface, &faces, flat, on);
        if planes.len() > MOST_PLANES {
            return Ok(None);
        }
        let pieces = convex_pieces(&planes, on, &self.tree, watch)?;
        // Corners this near to a plane are on it, in cells and in pieces, and source corners beside it.
        let beside = 2.0 * on + beyond;
        let parts =
            |pieces: Vec<SolidPiece>| pieces.iter().map(|p| self.surface_of(p, on)).collect();
        Ok(pieces.map(|pieces| (parts(pieces), beside)))
    }

    /// The medial axes of convex pieces whose union is the body, if they have at most `most` primitives, and are off by
    /// less than `close`; the source's corners may be `beside` them.
    fn of_parts(
        &self,
        parts: &[PieceSurface],
        beside: f64,
        close: f64,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Pieces, BuildError> {
        let Some(angle) = self.limits.creases.angle_of_flat() else {
            return Ok(Pieces::None);
        };
        // Matter that is thinner than corners may be off a plane is in no piece.
        if parts.is_empty() {
            return Ok(Pieces::None);
        }
        let mut draft = Draft::default();
        let (mut growth, mut bulge): (f64, f64) = (0.0, 0.0);
        for (surface, faces) in parts {
            let left = most.saturating_sub(draft.faces.len());
            let corners = |i: usize| surface.corners(faces.face_of[i].0);
            let tree = TriangleTree::new(faces.face_of.len(), corners, watch)?;
            let limits = (angle.cos(), close);
            let Some(axis) = axis(surface, &tree, faces, limits, left, watch)? else {
                return Ok(Pieces::None);
            };
            // Where not every edge is of two triangles, some of a face may be missing.
            let areas = (0..faces.face_of.len()).map(|i| 0.5 * cross(corners(i)).length());
            let area: f64 = areas.sum();
            if (axis.area - area).abs() > SAME_AREA * area {
                return Ok(Pieces::None);
            }
            growth = growth.max(axis.growth);
            bulge = bulge.max(axis.bulge);
            draft = draft.and(axis.draft);
        }
        let count = draft.faces.len();
        let grown = match self.limits.enclose {
            true => (growth + beside + self.surface.welded - self.limits.allow_uncovered).max(0.0),
            false => 0.0,
        };
        draft.balls.iter_mut().for_each(|ball| ball.radius += grown);
        let effort = Effort {
            enough: close,
            ..Effort::CHECK
        };
        let mut enclosed = self.measured(draft, None, effort, watch)?;
        // Triangles without area may stick out of the pieces, which are of the others alone.
        let uncovered = f64::from(enclosed.hausdorff.uncovered);
        let is_short = self.limits.enclose && uncovered > self.limits.allow_uncovered;
        if is_short || enclosed.error() > close {
            return Ok(Pieces::TooFar);
        }
        // Between the points measured too: each piece is, and together they are the body.
        enclosed.hausdorff.sampling = enclosed.hausdorff.sampling.min(close as Real);
        let mut candidate = self.reported(enclosed, watch)?;
        candidate.variant = Variant::Exact;
        let before = Hausdorff {
            sampling: beside as Real,
            ..known(growth, bulge)
        };
        candidate.before = self.limits.enclose.then_some(before);
        let off = match candidate.error() {
            off if off > ROUNDED => format!(" but for {off:.6}, by which faces are not flat"),
            _ => String::new(),
        };
        candidate.notes.push(match parts.len() {
            1 => format!("one convex piece: its medial axis has {count} primitives, and is exact{off}"),
            several => format!(
                "{several} convex pieces that overlap: their medial axes have {count} primitives, and are exact{off}"
            ),
        });
        Ok(Pieces::Exact(Box::new(candidate)))
    }

    /// The surface of a piece, with the source's own vertices where its corners are at these.
    fn surface_of(&self, piece: &SolidPiece, on: f64) -> PieceSurface<'_> {
        let mut vertices: Vec<Point> = Vec::new();
        let mut index = |p: Point| {
            let near = |q: &Point| (p - *q).length() <= 2.0 * on;
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
            whole: vec![true],
            lids: Vec::new(),
            cracks: 0.0,
            simple: true,
            findings: Default::default(),
        };
        (Cow::Owned(surface), FlatFaces { planes, face_of })
    }
}

/// Planes of faces less those that are others, of which faces look the other way or are apart: all corners of a face
/// lie within `on` of them. And how far they do at most, beyond `flat`.
fn distinct(surface: &Surface, faces: &FlatFaces, flat: f64, on: f64) -> (Vec<Plane>, f64) {
    let mut corners = vec![Vec::new(); faces.planes.len()];
    for &(t, face) in &faces.face_of {
        corners[face as usize].extend(surface.corners(t));
    }
    let mut all: Vec<Plane> = Vec::new();
    let mut beyond: f64 = 0.0;
    for (plane, corners) in faces.planes.iter().zip(corners) {
        let off = |other: &Plane| {
            let heights = corners.iter().map(|p| other.depth(*p).abs());
            heights.fold(0.0, f64::max)
        };
        let nearest = all.iter().map(off).fold(f64::INFINITY, f64::min);
        match nearest <= on {
            true => beyond = beyond.max(nearest - flat),
            false => all.push(*plane),
        }
    }
    (all, beyond)
}
