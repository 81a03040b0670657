//! Turns pairs of near spheres (`pair/contacts.rs`) into contact manifolds of parry, which persist from step to
//! step. `contact_manifolds.rs` calls it when parry asks.
//!
//! There is one contact for each patch, because the time of a solver grows with the number of contacts, and one
//! manifold for each pair of primitives, so that each keeps its own normal. (With one manifold for each pair of
//! colliders a chain of rings falls apart.)

use super::convex_parts::{ConvexPart, part_number, slack};
use crate::batch::PairResult;
use crate::math::tolerance::ONE_DIRECTION;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::SpherePair;
use crate::pair::contacts::along_old_normal;
use crate::pair::ghost_contacts::{PartContact, ghosts};
use parry3d::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
    TrackedContact,
};
use parry3d::shape::{PackedFeatureId, Shape};

/// Cosine under which two contacts of one primitive pair get manifolds of their own: a manifold has one normal.
const SAME_NORMAL: Real = ONE_DIRECTION as Real;

/// Cosine from which two contacts closer than the thinner body's thickness are one patch (11°): the
/// neighbours of a joint all report the contact there, under normals a little apart. At 20° two rings
/// of 27 cones (13° a joint) that hang in each other lose the notch that holds them, and never sleep.
const SAME_PATCH: Real = 0.98;

/// Width of a patch, in units of the thinner body's thickness, where contacts may have to serve for several steps. In
/// these the place where two smooth bodies touch moves by more than that, and a body that has one contact there tips
/// over it until contacts are computed again: with patches as wide as they are thick 65 of 180 pairs of rings that lie
/// on each other rock on for ever, with this 9 of 360. Where bodies move faster, wide patches serve: what rolls loses
/// no speed to a contact ahead of it.
pub const NARROW: Real = 0.1;

/// Writes the manifolds of two meshes at relative pose `pos12`. Contacts further apart than `prediction`
/// are left out; the deepest of a primitive pair gives its manifold the normal. Manifolds that were
/// there keep their data, and points of the same features keep their impulses. Where a deep contact's
/// normal would turn over, it stays that of the old manifold while that is hardly deeper.
pub fn write_manifolds<M, C>(
    meshes: [&MedialMesh; 2],
    found: &PairResult,
    pos12: &Pose,
    prediction: Real,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) where
    M: Default + Clone,
    C: Default + Copy,
{
    let old = std::mem::take(manifolds);
    let near = found.contacts.iter().filter(|c| c.distance <= prediction);
    let near = without_ghosts(near.collect(), meshes, pos12);
    let width = if found.lasting { NARROW } else { 1.0 };
    let mut near = deepest_of_each_patch(near.into_iter(), meshes, width);
    near.sort_by(|a, b| {
        a.primitives
            .cmp(&b.primitives)
            .then(a.distance.total_cmp(&b.distance))
            .then(a.feature.cmp(&b.feature))
    });
    let inverse = pos12.rotation.inverse();
    let groups = near.chunk_by(|a, b| a.primitives == b.primitives);
    let settled: Vec<SpherePair> = groups
        .flat_map(|group| {
            let kept = kept_normal(meshes, pos12, group, &old);
            let rest = if kept.is_some() { &[] } else { group };
            kept.into_iter().chain(rest.iter().map(|c| **c))
        })
        .collect();
    for c in &settled {
        let [a, b] = c.primitives;
        let same = |m: &&mut ContactManifold<M, C>| {
            [m.subshape1, m.subshape2] == c.primitives && m.local_n1.dot(c.normal) >= SAME_NORMAL
        };
        // Sorted: the manifolds of this primitive pair are the last ones.
        let manifold = match manifolds
            .iter_mut()
            .rev()
            .take_while(|m| [m.subshape1, m.subshape2] == c.primitives)
            .find(same)
        {
            Some(m) => m,
            None => {
                // Data that the user's hooks keep in a manifold stay where its normal turns over.
                let of_pair =
                    |m: &&ContactManifold<M, C>| [m.subshape1, m.subshape2] == c.primitives;
                let mut same = old.iter().filter(of_pair);
                let previous = same
                    .find(|m| m.local_n1.dot(c.normal) >= SAME_NORMAL)
                    .or_else(|| old.iter().find(of_pair));
                let data = previous.map(|m| m.data.clone()).unwrap_or_default();
                let mut m = ContactManifold::with_data(a, b, data);
                m.local_n1 = c.normal;
                m.local_n2 = inverse * -c.normal;
                manifolds.push(m);
                let last = manifolds.len() - 1;
                &mut manifolds[last]
            }
        };
        let [p1, p2] = c.points;
        // Along the manifold's normal, which need not be quite the contact's.
        let distance = c.distance + (pos12 * p2 - p1).dot(manifold.local_n1 - c.normal);
        let feature = PackedFeatureId::face(c.feature);
        let mut point = TrackedContact::new(p1, p2, feature, feature, distance);
        let previous = old
            .iter()
            .filter(|m| [m.subshape1, m.subshape2] == c.primitives)
            // An impulse along a normal that turned over would pull.
            .filter(|m| m.local_n1.dot(c.normal) > 0.0)
            .flat_map(|m| &m.points)
            .find(|p| p.fid1 == feature);
        if let Some(previous) = previous {
            point.data = previous.data;
        }
        manifold.points.push(point);
    }
}

/// Writes one contact into a manifold of its own, which keeps the data of the manifold that was there before.
pub fn write_one_point<M, C>(
    contact: Option<SpherePair>,
    pos12: &Pose,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) where
    M: Default + Clone,
    C: Default + Copy,
{
    let old = std::mem::take(manifolds).into_iter().next();
    let Some(c) = contact else { return };
    let [a, b] = c.primitives;
    let old = old.filter(|m| {
        [m.subshape1, m.subshape2] == [a, b] && m.local_n1.dot(c.normal) >= SAME_NORMAL
    });
    let data = old.as_ref().map(|m| m.data.clone()).unwrap_or_default();
    let mut manifold = ContactManifold::with_data(a, b, data);
    manifold.local_n1 = c.normal;
    manifold.local_n2 = pos12.rotation.inverse() * -c.normal;
    let feature = PackedFeatureId::face(c.feature);
    let mut point = TrackedContact::new(c.points[0], c.points[1], feature, feature, c.distance);
    if let Some(before) = old.as_ref().and_then(|m| m.points.first()) {
        point.data = before.data;
    }
    manifold.points.push(point);
    manifolds.push(manifold);
}

/// The contacts that are ghosts on neither side ([`ghosts`]).
fn without_ghosts<'a>(
    mut contacts: Vec<&'a SpherePair>,
    meshes: [&MedialMesh; 2],
    pos12: &Pose,
) -> Vec<&'a SpherePair> {
    let inverse = pos12.rotation.inverse();
    for k in [0, 1] {
        let seen = contacts.iter().map(|c| PartContact {
            part: c.primitives[k],
            other: part_number(meshes[1 - k], c.primitives[1 - k]),
            place: c.points[k],
            normal: if k == 0 {
                c.normal
            } else {
                inverse * -c.normal
            },
            gap: c.distance,
        });
        let seen: Vec<PartContact> = seen.collect();
        let reach = |part: u32, n: Vector| ConvexPart::of(meshes[k], part).reach(n);
        let slack = slack(meshes[k], pos12);
        let ghosts = ghosts(&seen, reach, |_| slack);
        let mut ghosts = ghosts.into_iter();
        contacts.retain(|_| ghosts.next() != Some(true));
    }
    contacts
}

/// The contacts that have no deeper one of about the same normal within `width` times the thickness of the thinner
/// mesh. Those of two convex pieces are no neighbours of one place, but the corners of the faces on which a body rests:
/// all of them stay.
fn deepest_of_each_patch<'a>(
    contacts: impl Iterator<Item = &'a SpherePair>,
    meshes: [&MedialMesh; 2],
    width: Real,
) -> Vec<&'a SpherePair> {
    let radius = width * meshes[0].thickness().min(meshes[1].thickness());
    let is_of_pieces = |c: &SpherePair| {
        let of_piece = |k: usize| meshes[k].convex_pieces().node_of(c.primitives[k]);
        of_piece(0).is_some() && of_piece(1).is_some()
    };
    let mut sorted: Vec<&SpherePair> = contacts.collect();
    sorted.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let mut kept: Vec<&SpherePair> = Vec::new();
    for c in sorted {
        let covers = |k: &&SpherePair| {
            k.points[0].distance_squared(c.points[0]) < radius * radius
                && k.normal.dot(c.normal) >= SAME_PATCH
        };
        if is_of_pieces(c) || !kept.iter().any(covers) {
            kept.push(c);
        }
    }
    kept
}

/// Chooses the contact that takes the place of all contacts of a primitive pair, deepest first, where the deepest has
/// none of the old normals but one of them still serves.
fn kept_normal<M, C>(
    [mesh1, mesh2]: [&MedialMesh; 2],
    pos12: &Pose,
    group: &[&SpherePair],
    old: &[ContactManifold<M, C>],
) -> Option<SpherePair> {
    let deepest = group.first().filter(|c| c.distance < 0.0)?;
    let mut before = old
        .iter()
        .filter(|m| [m.subshape1, m.subshape2] == deepest.primitives)
        .map(|m| m.local_n1);
    let same = |n: &Vector| n.dot(deepest.normal) >= SAME_NORMAL;
    let first = before.next().filter(|n| !same(n))?;
    if before.any(|n| same(&n)) {
        return None;
    }
    let kept = along_old_normal(mesh1, mesh2, pos12, deepest, first);
    (!same(&kept.normal)).then_some(kept)
}

/// Makes sure that a workspace is there. rapier reads its presence as "the list of manifolds may
/// change", and panics when a list changes without it. An empty workspace of parry's own survives
/// saving, one of ours would not.
pub fn ensure_workspace<M, C>(
    shape1: &dyn Shape,
    shape2: &dyn Shape,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
{
    if workspace.is_some() {
        return;
    }
    // Twice the sum of both sizes: certainly out of reach, so that parry finds nothing.
    let reach = |s: &dyn Shape| {
        let b = s.compute_local_aabb();
        b.mins.abs().max(b.maxs.abs()).length()
    };
    let away = 2.0 * (reach(shape1) + reach(shape2));
    let far = Pose::translation(away, 0.0, 0.0);
    let mut none: Vec<ContactManifold<M, C>> = Vec::new();
    let result =
        DefaultQueryDispatcher.contact_manifolds(&far, shape1, shape2, 0.0, &mut none, workspace);
    debug_assert!(result.is_ok() && workspace.is_some());
}
