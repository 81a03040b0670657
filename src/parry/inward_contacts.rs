//! Contacts that point into a convex piece of a medial mesh, which are left out.
//!
//! Of a mesh and triangles parry finds the contacts of each primitive for itself. The slab along an edge of a box is thin: where a triangle cuts
//! through it, its shortest way out of the triangle may be deeper into the ground, with all of the box behind it. The box
//! as a whole has no contact there; what holds it up are other contacts.

use super::contact_reduction::places;
use crate::math::Real;
use crate::math::fast_hash::FastSet;
use crate::medial::MedialMesh;
use parry3d::query::ContactManifold;

/// Leaves out deep contacts of a mesh's convex pieces along which the piece reaches beyond the contact by more than the
/// contact's depth, as long as it has another deep one. The mesh is body `side` (0 or 1) of the manifolds.
pub fn leave_out<M, C>(manifolds: &mut [ContactManifold<M, C>], mesh: &MedialMesh, side: usize) {
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
        if held.contains(&piece_of(m)) {
            let left: Vec<bool> = (0..m.points.len())
                .map(|i| is_deep(m, i) && is_inward(m, i))
                .collect();
            let mut left = left.into_iter();
            m.points.retain(|_| left.next() != Some(true));
        }
    }
}
