//! Mass, centre and inertia of a convex piece whose faces are all flat, in closed form: a polyhedron is a sum of
//! tetrahedra from one point to the triangles of its faces (Tonon, "Explicit exact formulas for the 3-D tetrahedron
//! inertia tensor", 2004).

use super::convex_pieces::ConvexPiece;
use super::mass::Moments;
use crate::math::lane::Vec3;

/// Moments of a piece about the mean of its spheres' centres; `None` where it has round parts, or faces that are not
/// known.
pub(super) fn moments(piece: &ConvexPiece) -> Option<Moments> {
    let center = |k: usize| Vec3::<f64>::from_vector(piece.spheres[k].center);
    let count = piece.spheres.len();
    let sum = (0..count).fold(Vec3::zero(), |sum, k| sum + center(k));
    let middle = sum * (1.0 / count.max(1) as f64);
    let mut moments = Moments::zero(middle);
    let edges = piece.edges.as_ref()?;
    if edges.radius > 0.0 {
        return None;
    }
    for face in &piece.faces {
        let at = |k: usize| center(face.corners[k] as usize) - middle;
        for k in 2..face.corners.len() {
            moments.add_tetrahedron([at(0), at(k - 1), at(k)]);
        }
    }
    Some(moments)
}
