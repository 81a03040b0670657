//! Whether few of the pairs that move have a medial collider. rapier may then keep contacts for as long as the user
//! says, and all contacts of medial colliders are computed anew in each step ([`crate::rapier::host::forced_updates`]).
//!
//! rapier has one recycle distance for the whole world. The smaller one that medial colliders need costs a crowd of
//! rapier's own shapes two fifths of rapier's step: their contacts are computed anew more often.

use crate::medial::MedialMesh;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::participants::{contact_pairs, enabled};
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::geometry::Collider;

/// How many pairs of rapier's own shapes there must be for each pair with a medial collider. Such a pair costs more by
/// being computed in each step than one of rapier's own saves.
const OUTNUMBERED: usize = 8;

/// Whether few of the pairs that move have a medial collider, and the user's recycle distance is larger than that of
/// the step. A moving medial collider counts as a pair of its own: it may be about to meet something. Known from the
/// world alone, so that a world that was saved and loaded, or of which not all takes part, goes on alike.
pub fn are_outnumbered(sets: &Sets, users: &IntegrationParameters) -> bool {
    let [own, users_own] = [sets.parameters, users].map(|p| p.contact_recycle_distance());
    if own >= users_own || keeps_nothing(users) {
        return false;
    }
    let colliders = enabled(sets.bodies, sets.colliders, sets.participants);
    let moving = colliders.filter(|(_, collider)| may_move(sets, collider));
    let mut moving = moving.peekable();
    if moving.peek().is_none() {
        return false;
    }
    let mut medial = moving.filter(|(_, collider)| is_medial(collider)).count();
    let mut others = 0;
    for pair in contact_pairs(sets.narrow_phase, sets.participants) {
        let handles = [pair.collider1, pair.collider2];
        let both = handles.map(|handle| sets.colliders.get(handle));
        let mut both = both.into_iter().flatten();
        if !both.clone().any(|collider| may_move(sets, collider)) {
            continue;
        }
        match both.any(is_medial) {
            true => medial += 1,
            false => others += 1,
        }
    }
    others >= OUTNUMBERED * medial
}

/// Whether rapier computes all contacts in each step.
pub fn keeps_nothing(parameters: &IntegrationParameters) -> bool {
    !parameters.contact_recycling || parameters.contact_recycle_distance() <= 0.0
}

fn is_medial(collider: &Collider) -> bool {
    collider.shape().as_shape::<MedialMesh>().is_some()
}

/// Whether a collider is on a body that is awake and not fixed.
fn may_move(sets: &Sets, collider: &Collider) -> bool {
    let body = collider.parent().and_then(|body| sets.bodies.get(body));
    body.is_some_and(|body| !body.is_fixed() && !body.is_sleeping())
}
