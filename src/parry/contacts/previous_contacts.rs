//! Contacts that carried a load in the step before, which hand their impulses on to those that take their place.

use super::manifold_points::places;
use crate::math::{Real, Vector};
use parry3d::query::ContactManifold;

/// A contact of the step before that carried a load.
pub struct PreviousContact<C> {
    subshapes: [u32; 2],
    /// Point on the body, in its frame.
    pub place: Vector,
    data: C,
}

/// The contacts of these manifolds that carried a load, at their points on body `side` (0 or 1).
pub fn previous<M, C: Copy>(
    manifolds: &[ContactManifold<M, C>],
    side: usize,
) -> Vec<PreviousContact<C>> {
    let of = |m: &ContactManifold<M, C>, i: usize| PreviousContact {
        subshapes: [m.subshape1, m.subshape2],
        place: places(m, i)[side],
        data: m.points[i].data,
    };
    let all = manifolds.iter();
    all.flat_map(|m| (0..m.points.len()).map(move |i| of(m, i)))
        .collect()
}

/// Makes parry compute all contacts anew. It would otherwise go on from those in the manifolds, of which some were
/// removed and some turned.
pub fn force_full_update<M, C: Default + Copy>(manifolds: &mut [ContactManifold<M, C>]) {
    manifolds
        .iter_mut()
        .for_each(ContactManifold::mark_shapes_deformed);
}

/// Passes the data (impulses) of contacts of the step before to the nearest new contacts of the same subshapes, each
/// once. parry matches contacts by features, which several contacts of an edge share, so that an impulse would count
/// several times.
pub fn transfer_impulses<M, C: Default + Copy>(
    manifolds: &mut [ContactManifold<M, C>],
    previous: &[PreviousContact<C>],
    prediction: Real,
    side: usize,
) {
    for manifold in manifolds {
        let now: Vec<Vector> = (0..manifold.points.len())
            .map(|i| places(manifold, i)[side])
            .collect();
        let ids = [manifold.subshape1, manifold.subshape2];
        manifold
            .points
            .iter_mut()
            .for_each(|p| p.data = C::default());
        let mut free = vec![true; now.len()];
        for b in previous.iter().filter(|b| b.subshapes == ids) {
            let apart = |i: &usize| now[*i].distance(b.place);
            let near = (0..now.len()).filter(|i| free[*i] && apart(i) < prediction);
            if let Some(i) = near.min_by(|i, j| apart(i).total_cmp(&apart(j))) {
                free[i] = false;
                manifold.points[i].data = b.data;
            }
        }
    }
}
