//! Contacts of convex pieces of a medial mesh with triangles that point into the piece or are too deep, which are left
//! out.
//!
//! Of a mesh and triangles parry finds the contacts of each primitive for itself. The slab along an edge of a box is
//! thin: where a triangle cuts through it, its shortest way out of the triangle may be deeper into the ground, with all
//! of the box behind it. The box as a whole has no contact there; what holds it up are other contacts. And where a
//! primitive just touches the border of a triangle, parry's EPA algorithm may find it far below.

use super::contact_reduction::places;
use crate::math::fast_hash::FastSet;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::medial::convex_pieces::ConvexPiece;
use parry3d::query::ContactManifold;
use parry3d::shape::Shape;

/// Leaves out deep contacts of a mesh's convex pieces along which the piece reaches beyond the contact by more than the
/// contact's depth, as long as it has another deep one. Leaves out as well those that are deeper than the piece is in the
/// triangle by more than the prediction distance, where the piece is no deeper than that. The mesh is body `side` (0 or
/// 1) of the manifolds; `ground` are the triangles, and where they are in the mesh's frame.
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
        // The piece's own, asked for contacts that are deeper than it could be.
        let of_piece = || Some(gap(pieces.of_node(piece?)?, triangle(ground, id)?));
        let is_asked = m.points.iter().any(|point| point.dist < -prediction);
        let gap = is_asked.then(of_piece).flatten();
        let is_wrong = |m: &ContactManifold<M, C>, i: usize| {
            let is_near = |gap: &Real| *gap >= -prediction;
            let is_deeper = |gap: Real| m.points[i].dist < gap - prediction;
            gap.filter(is_near).is_some_and(is_deeper)
        };
        let left: Vec<bool> = (0..m.points.len())
            .map(|i| is_deep(m, i) && (is_held && is_inward(m, i) || is_wrong(m, i)))
            .collect();
        let mut left = left.into_iter();
        m.points.retain(|_| left.next() != Some(true));
    }
}

/// The corners of a triangle of the ground in the mesh's frame.
fn triangle((ground, pose): (&dyn Shape, &Pose), id: u32) -> Option<[Vector; 3]> {
    let mut found = None;
    let parts = ground.as_composite_shape()?;
    parts.map_part_at(id, &mut |_, part, _| {
        found = part.as_triangle().map(|t| t.vertices().map(|p| pose * p));
    });
    found
}

/// The largest gap of a piece and a triangle along the directions across their faces, a length; negative where they overlap
/// along all of these.
fn gap(piece: &ConvexPiece, [a, b, c]: [Vector; 3]) -> Real {
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
    faces.fold(lowest(across).max(lowest(-across)), Real::max)
}
