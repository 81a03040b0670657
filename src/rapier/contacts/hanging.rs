//! Finds medial colliders whose contacts must be computed anew although their pair has hardly moved
//! ([`crate::rapier::host::forced_updates`]).
//!
//! - Bodies that hang, that is whose contacts pull them away from their centre of mass, as those of convex bodies never
//!   do. With contacts that are out of date they keep swinging ([`crate::rapier::contacts::predicted_contacts`]). So
//!   all contacts of a collider are computed anew if one in which it hangs has moved.
//! - Bodies that are thin beside the distance by which a pair may move before its contacts are computed anew: they
//!   would be through a wall by then.
//! - Bodies whose axes the user has locked or let go since: contacts that can move nothing any more throw them
//!   ([`crate::rapier::contacts::locked_bodies`]).
//! - Bodies that have come to rest. Contacts that could close while they moved no longer can, and the solver would
//!   pay for them as long as the bodies lie there.

use crate::math::Real;
use crate::parry::corrections::locked_axes::UNSOLVED;
use crate::rapier::contacts::locked_bodies::{any_locked, is_stale};
use crate::rapier::contacts::reach::{is_thin, reach};
use crate::rapier::host::contact_depth::deepest;
use crate::rapier::view::medial_colliders::{MedialCollider, MedialColliders, Sets};
use crate::rapier::view::participants::contact_pairs;
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::geometry::{ColliderSet, ContactPair};

/// Length by which a contact that a body hangs in may have moved, or its force have swung round the centre of
/// mass, since it was computed, in units of rapier's length unit. A chain of 20 links does not sleep at 0.001
/// and does at 0.0005. Kept awake and damped, its last link moves by 1 mm with 0.0005, by 0.7 mm with 0.0002.
const MAX_STALE_TRAVEL: Real = 0.0002;

/// Gap up to which a body hangs in a contact, in units of rapier's length unit.
const TOUCHING_GAP: Real = 0.001;

/// Cosine of the angle between a contact's force and its arm from which it pulls (45°). In a heap rings lie
/// on each other's inner sides at all angles, and half of them would count at 90°.
const PULL_COSINE: Real = 0.7;

/// Widest gap among a pair's contacts from which the pair counts as come to rest, in units of the gap that it can close
/// now ([`reach()`]), and in those of the recycle distance: the solver still has contacts that cannot close. At 1 pairs
/// that move a little are computed in every step.
const REST_GAP_RATIO: Real = 1.25;

/// Finds the medial colliders whose contacts are to be computed anew (one flag each), and the depth of
/// the deepest contact of a medial collider that takes part, a length. Known from the world alone, so that a world that
/// was saved and loaded goes on as it would have.
pub fn find(sets: &Sets, medial: &MedialColliders) -> (Vec<bool>, Real) {
    let thin = |c| is_thin(c, &medial.parameters);
    let mut anew: Vec<bool> = medial.all.iter().map(thin).collect();
    let any_locked = any_locked(sets);
    let mut depth_of_all: Real = 0.0;
    let touching = contact_pairs(sets.narrow_phase, sets.participants);
    for pair in touching.filter(|pair| !pair.manifolds().is_empty()) {
        let places = [pair.collider1, pair.collider2].map(|h| medial.place(h));
        if places == [None, None] {
            continue;
        }
        depth_of_all = depth_of_all.max(depth(pair, sets.colliders));
        if is_stale(sets, pair, any_locked) {
            places.iter().flatten().for_each(|i| anew[*i] = true);
        }
        let [Some(i), Some(j)] = places else {
            continue;
        };
        let sides = [&medial.all[i], &medial.all[j]];
        let mass = |s: &MedialCollider| s.moving.map_or(Real::MAX, |(mass, _)| mass);
        let (lighter, side) = if mass(sides[1]) <= mass(sides[0]) {
            (j, sides[1])
        } else {
            (i, sides[0])
        };
        if anew[lighter] || side.moving.is_none() {
            continue;
        }
        let skins: Real = sides.iter().map(|s| s.skin).sum();
        anew[lighter] = hanging(pair, sides, skins, sets.parameters.length_unit)
            || at_rest(pair, sides, skins, &medial.parameters);
    }
    (anew, depth_of_all)
}

/// How deep the deepest contact of a pair is where its colliders are, a length; 0 if none is.
fn depth(pair: &ContactPair, colliders: &ColliderSet) -> Real {
    let [Some(c1), Some(c2)] = [pair.collider1, pair.collider2].map(|h| colliders.get(h)) else {
        return 0.0;
    };
    let poses = [c1.position(), c2.position()];
    let depths = pair.manifolds().iter().map(|m| deepest(m, poses));
    depths.fold(0.0, Real::max)
}

/// Which medial colliders touch another so that the contact pulls their body away from its centre of mass,
/// however little. Known from the world alone, as in [`find`].
pub fn hang(sets: &Sets, medial: &MedialColliders) -> Vec<bool> {
    let mut hangs = vec![false; medial.all.len()];
    for pair in contact_pairs(sets.narrow_phase, sets.participants) {
        let places = [pair.collider1, pair.collider2].map(|h| medial.place(h));
        let [Some(i), Some(j)] = places else {
            continue;
        };
        if hangs[i] && hangs[j] {
            continue;
        }
        let gap =
            medial.all[i].skin + medial.all[j].skin + TOUCHING_GAP * sets.parameters.length_unit;
        for m in pair.manifolds() {
            for p in m.points.iter().filter(|p| p.dist < gap) {
                let sides = [
                    (i, p.local_p1, -m.data.normal),
                    (j, p.local_p2, m.data.normal),
                ];
                for (place, point, force) in sides {
                    if hangs[place] {
                        continue;
                    }
                    let collider = &medial.all[place];
                    let arm = collider
                        .moving
                        .map(|(_, center)| *collider.pose() * point - center);
                    hangs[place] = arm.is_some_and(|arm| arm.dot(force) > 0.0);
                }
            }
        }
    }
    hangs
}

/// Whether one of a pair hangs in contacts which have moved, in a world of this length unit.
fn hanging(pair: &ContactPair, sides: [&MedialCollider; 2], skins: Real, unit: Real) -> bool {
    let centers = sides.map(|s| s.moving.map(|(_, center)| center));
    let limit = MAX_STALE_TRAVEL * unit;
    pair.manifolds().iter().any(|m| {
        // The force on each, as it was, and as it turned with it.
        let then = [-m.data.normal, m.data.normal];
        let now = [-m.local_n1, -m.local_n2];
        let points = m.points.iter();
        let mut touching = points.filter(|p| p.dist - skins < TOUCHING_GAP * unit);
        touching.any(|p| {
            let points = [*sides[0].pose() * p.local_p1, *sides[1].pose() * p.local_p2];
            let arm = |k: usize| centers[k].map(|center| points[k] - center);
            let pulled =
                |k: usize| arm(k).is_some_and(|arm| arm.dot(then[k]) > PULL_COSINE * arm.length());
            let swung = |k: usize| {
                let chord = (sides[k].pose().rotation * now[k]).distance(then[k]);
                arm(k).is_some_and(|arm| arm.length() * chord > limit)
            };
            let gap = points[1] - points[0] - m.data.normal * p.dist;
            (pulled(0) || pulled(1)) && (swung(0) || swung(1) || gap.length() > limit)
        })
    })
}

/// Whether the solver has contacts of a pair that cannot close any more.
fn at_rest(
    pair: &ContactPair,
    sides: [&MedialCollider; 2],
    skins: Real,
    parameters: &IntegrationParameters,
) -> bool {
    let points = pair.manifolds().iter().flat_map(|m| &m.points);
    let gaps = points.map(|p| p.dist).filter(|gap| *gap < UNSOLVED);
    let widest = gaps.fold(Real::MIN, Real::max) - skins;
    // A pair may close a gap of the recycle distance before it is computed again.
    widest > REST_GAP_RATIO * parameters.contact_recycle_distance()
        && widest > REST_GAP_RATIO * reach(sides, parameters)
}
