//! Chooses the pairs that are kept from rapier's solver and left to the event loop: those that move by more than
//! their thickness in the step and do not touch yet. Contacts computed at the start of the step would come too late
//! for them, or lie at places where the bodies never meet. Where both bodies may be moved, and one belongs to a multibody
//! that turns wildly ([`super::whirls`]), touching pairs are left to the event loop too. Half of the step's budget may go
//! into this; without it a pair is left to both.

use super::first_contact::{Asker, Work};
use super::motion::Kind;
use super::pairs::{Rules, sweep};
use super::snapshot::Snapshot;
use super::whirls::is_wild;
use crate::math::Real;
use crate::parry::answers::Key;
use std::collections::HashSet;

/// The pairs to be muted, under the key by which the narrow phase will ask.
pub fn muted(
    snapshot: &Snapshot,
    asker: &Asker,
    rules: &Rules,
    prediction: Real,
    work: &mut Work,
) -> HashSet<Key> {
    let mut keys = HashSet::new();
    if !asker.may_be_fast(snapshot, asker.tuning.muted, snapshot.least_thickness()) {
        return keys;
    }
    for pair in sweep(snapshot, asker.dt, 0.0) {
        let [p, q] = pair.map(|k| &snapshot.parts[k]);
        let plane = p.shape.as_halfspace().or(q.shape.as_halfspace());
        let reach = prediction + p.skin + q.skin;
        let apart = |a: &parry3d::bounding_volume::Aabb, b: &parry3d::bounding_volume::Aabb| {
            (a.mins - b.maxs).max(b.mins - a.maxs).max_element() > reach
        };
        if plane.is_none()
            && !apart(&p.aabb, &q.aabb)
            && asker.is_fast(snapshot, pair, asker.tuning.muted)
            && !asker.speculates(snapshot, pair)
            && asker.left(work) > asker.budget / 2
            && rules.respond(snapshot, pair)
            && (is_wild_pair(snapshot, asker, pair) || !asker.touches(snapshot, pair, work))
        {
            let [m1, m2] = pair.map(|k| snapshot.motion(k, 0.0).start);
            keys.insert(Key::new(&*p.shape, &*q.shape, &m1.inv_mul(&m2)));
        }
    }
    keys
}

/// Whether two bodies may be moved, and one is of a multibody that turns wildly.
fn is_wild_pair(snapshot: &Snapshot, asker: &Asker, pair: [usize; 2]) -> bool {
    let bodies = pair.map(|k| &snapshot.bodies[snapshot.parts[k].body]);
    bodies.iter().all(|b| b.kind == Kind::Free) && bodies.iter().any(|b| is_wild(b, asker.dt))
}
