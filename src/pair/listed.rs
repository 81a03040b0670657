//! Contacts of two medial meshes from a list of primitive pairs that may be near each other, wherever the list comes
//! from.
//!
//! The contacts of a pair of meshes depend on the set of its primitive pairs within the prediction distance, and on the
//! order in which these are taken: of sphere pairs at the same place under the same normal the first of the nearest is
//! kept. The order is that in which a walk down both trees comes to them (`Descent`). It depends on the trees alone:
//! what a search rules out is missing in its walk, and moves nothing else. So a list that holds all primitive pairs
//! within the distance, sorted in this order, has the contacts of [`contacts()`] bit by bit, whatever else it holds:
//! farther pairs add none.

use super::SpherePair;
use super::contact_list::ContactList;
use super::contacts::contacts;
use super::descent::Descent;
use super::first_contact::Counts;
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use crate::medial::leaf_order::LeafOrder;

/// Contacts of two meshes, equal to those of [`contacts()`] in every bit, if `listed` holds all pairs of their
/// primitives within `prediction` (a length) of each other. It may hold others, in any order and repeatedly; pairs that
/// do not exist are ignored. It is left in disorder.
///
/// A mesh with convex pieces is searched as if there were no list: pieces meet as a whole. So is a negative prediction:
/// of primitives whose medial surfaces cross, only bounds decide then whether they are deep enough, and a list does not
/// know the bounds of the search.
pub fn contacts_of_listed(
    mesh1: &MedialMesh,
    mesh2: &MedialMesh,
    pos12: &Pose,
    prediction: Real,
    listed: &mut [[u32; 2]],
) -> (Vec<SpherePair>, Counts) {
    let has_pieces = |mesh: &MedialMesh| !mesh.convex_pieces().is_empty();
    if prediction < 0.0 || has_pieces(mesh1) || has_pieces(mesh2) {
        return contacts(mesh1, mesh2, pos12, prediction);
    }
    let (mut found, mut counts) = (ContactList::new(prediction.into()), Counts::default());
    if !(pos12.is_finite() && prediction.is_finite()) {
        return (Vec::new(), counts);
    }
    let place = Placement::new(pos12);
    in_order([mesh1, mesh2], listed, |primitives| {
        let pair = PrimitivePair::new(mesh1, mesh2, primitives, &place);
        pair.contacts(&mut found, &mut counts);
    });
    (found.into_contacts(), counts)
}

/// Calls `take` on each of the pairs listed once, in the order of a walk down both trees. Leaves the list in disorder.
fn in_order(meshes: [&MedialMesh; 2], listed: &mut [[u32; 2]], mut take: impl FnMut([u32; 2])) {
    let orders = meshes.map(MedialMesh::leaf_order);
    // Ranks from here on; those that do not exist go to the end.
    let mut end = listed.len();
    let mut at = 0;
    while at < end {
        let [p, q] = listed[at].map(|p| p as usize);
        match (orders[0].ranks.get(p), orders[1].ranks.get(q)) {
            (Some(&p), Some(&q)) => {
                listed[at] = [p, q];
                at += 1;
            }
            _ => {
                end -= 1;
                listed.swap(at, end);
            }
        }
    }
    let walk = Walk { meshes, orders };
    if end > 0 {
        walk.down([0, 0], &mut listed[..end], &mut take);
    }
}

/// Two trees on the way down.
struct Walk<'a> {
    meshes: [&'a MedialMesh; 2],
    orders: [&'a LeafOrder; 2],
}

impl Walk<'_> {
    /// Takes the pairs below two nodes, given by their ranks, one at least. It is as deep as both trees together: a few
    /// hundred calls at most.
    fn down(&self, mut at: [u32; 2], pairs: &mut [[u32; 2]], take: &mut impl FnMut([u32; 2])) {
        // The walk to one pair, or to one that is listed several times, passes no other.
        let first = pairs[0];
        while pairs.iter().any(|pair| *pair != first) {
            let (side, [c, d]) = match Descent::of((self.meshes[0], self.meshes[1]), at) {
                Descent::First(children) => (0, children),
                Descent::Second(children) => (1, children),
                // Not reached: below two leaves there is one pair.
                Descent::Leaves(_) => break,
            };
            let behind = self.orders[side].first[d as usize];
            let mut split = 0;
            for k in 0..pairs.len() {
                if pairs[k][side] < behind {
                    pairs.swap(k, split);
                    split += 1;
                }
            }
            at[side] = if split > 0 { c } else { d };
            if split > 0 && split < pairs.len() {
                let (before, after) = pairs.split_at_mut(split);
                self.down(at, before, take);
                at[side] = d;
                return self.down(at, after, take);
            }
        }
        take([0, 1].map(|k| self.orders[k].primitives[first[k] as usize]));
    }
}
