//! False contacts of convex pieces of a medial mesh with triangles: those whose normal points into the piece, and those
//! deeper than the piece is in the triangle. They are removed.
//!
//! parry finds the contacts of each primitive of a mesh with triangles by itself. The slab along an edge of a box is
//! thin: where a triangle cuts through it, its shortest way out of the triangle may be deeper into the ground, with all
//! of the box behind it. The box as a whole has no contact there; other contacts hold it up. And where a primitive just
//! touches the border of a triangle, parry's EPA algorithm may find it far below.

use crate::math::fast_hash::FastSet;
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::medial::convex_pieces::ConvexPiece;
use crate::parry::contacts::manifold_points::places;
use parry3d::query::ContactManifold;
use parry3d::shape::{Shape, TrianglePseudoNormals, TypedShape};

/// Depth by which a contact of a piece may exceed the depth of the piece, in units of its thickness.
const DEEPER: Real = 0.01;

/// Removes deep contacts of a mesh's convex pieces along which the piece reaches beyond the contact by more than the
/// contact's depth, as long as the piece has another deep one. Also removes contacts that are deeper than the piece is
/// in the triangle, which no contact of a part of it can be. The mesh is body `side` (0 or 1) of the manifolds;
/// `ground` are the triangles, and their pose in the mesh's frame.
pub fn leave_out<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    ground: (&dyn Shape, &Pose),
    prediction: Real,
) {
    let pieces = mesh.convex_pieces();
    if pieces.is_empty() {
        return;
    }
    let piece_of = |m: &ContactManifold<M, C>| pieces.node_of([m.subshape1, m.subshape2][side]);
    let is_inward = |m: &ContactManifold<M, C>, i: usize| {
        let Some(piece) = piece_of(m).and_then(|node| pieces.of_node(node)) else {
            return false;
        };
        let (normal, place) = ([m.local_n1, m.local_n2][side], places(m, i)[side]);
        let beyond = piece
            .spheres
            .iter()
            .map(|s| normal.dot(s.center - place) + s.radius);
        beyond.fold(Real::MIN, Real::max) > -m.points[i].dist
    };
    let is_deep = |m: &ContactManifold<M, C>, i: usize| m.points[i].dist < 0.0;
    let mut held: FastSet<Option<u32>> = FastSet::default();
    for m in manifolds.iter() {
        if (0..m.points.len()).any(|i| is_deep(m, i) && !is_inward(m, i)) {
            held.insert(piece_of(m));
        }
    }
    for m in manifolds {
        let piece = piece_of(m);
        let is_held = held.contains(&piece);
        let id = [m.subshape2, m.subshape1][side];
        // The least distance of a contact that the piece may have there, asked for where any contact is deeper than
        // rounding.
        let least = || {
            let piece = pieces.of_node(piece?)?;
            let (corners, normals) = triangle(ground, id)?;
            let is_one_sided = normals.is_some_and(|n| !n.two_sided);
            let size = corners.iter().map(|p| p.length()).fold(0.0, Real::max);
            let more = prediction.min(DEEPER * piece.thickness) + REAL_ROUNDING * size;
            let half = prediction.min(0.5 * piece.thickness);
            Some(gap(piece, (corners, is_one_sided), half) - more)
        };
        let is_asked = m.points.iter().any(|point| point.dist < 0.0);
        let least = is_asked.then(least).flatten();
        let is_wrong = |m: &ContactManifold<M, C>, i: usize| {
            least.is_some_and(|least| m.points[i].dist < least)
        };
        let left: Vec<bool> = (0..m.points.len())
            .map(|i| is_deep(m, i) && (is_held && is_inward(m, i) || is_wrong(m, i)))
            .collect();
        let mut left = left.into_iter();
        m.points.retain(|_| left.next() != Some(true));
    }
}

/// The corners of a triangle of the ground in the mesh's frame, and what normals rapier allows there, if not all:
/// mostly those at its front.
pub fn triangle(
    (ground, pose): (&dyn Shape, &Pose),
    id: u32,
) -> Option<([Vector; 3], Option<TrianglePseudoNormals>)> {
    let (triangle, normals) = match ground.as_typed_shape() {
        TypedShape::TriMesh(mesh) => (mesh.triangle(id), mesh.triangle_normal_constraints(id)),
        TypedShape::HeightField(field) => {
            let normals = field.triangle_normal_constraints(id);
            (field.triangle_at_id(id)?, normals)
        }
        _ => return None,
    };
    Some((triangle.vertices().map(|p| pose * p), normals))
}

/// The largest gap of a piece and a triangle along the directions across their faces, a length; negative where they
/// overlap along all of these. Where the piece is more than `half` in a triangle that pushes to its front only, the one
/// along that.
fn gap(piece: &ConvexPiece, ([a, b, c], is_one_sided): ([Vector; 3], bool), half: Real) -> Real {
    let across = (b - a).cross(c - a).normalize_or_zero();
    let lowest = |n: Vector| {
        let ends = piece.spheres.iter().map(|s| n.dot(s.center - a) - s.radius);
        ends.fold(Real::MAX, Real::min)
    };
    let beyond = |n: Vector| {
        let ends = piece.spheres.iter().map(|s| n.dot(s.center) + s.radius);
        let nearest = [a, b, c].map(|p| n.dot(p)).into_iter();
        nearest.fold(Real::MAX, Real::min) - ends.fold(Real::MIN, Real::max)
    };
    let faces = piece.faces.iter().map(|face| beyond(face.normal));
    let gap = faces.fold(lowest(across).max(lowest(-across)), Real::max);
    match is_one_sided && gap < -half {
        true => gap.min(lowest(across)),
        false => gap,
    }
}
