//! Whether rapier may keep contacts for as long as the user says, although there are medial colliders: where few of the
//! pairs that move have one. All contacts of medial colliders are then computed anew in each step
//! ([`crate::rapier::host::forced_updates`]).
//!
//! rapier has one recycle distance for the whole world. The smaller one that medial colliders need costs a crowd of rapier's
//! own shapes two fifths of rapier's step: their contacts are computed anew more often.

use crate::medial::MedialMesh;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::participants::contact_pairs;
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::geometry::{Collider, ColliderHandle};

/// Pairs of rapier's own shapes, for each pair with a medial collider, from which these are outnumbered. A pair with a
/// medial collider costs more by being computed in each step than one of rapier's own saves.
const OUTNUMBERED: usize = 8;

/// Whether few of the pairs that move have a medial collider, and the user's recycle distance is larger than that of the
/// step. Known from the world alone, so that a world that was saved and
/// loaded, or of which not all takes part, goes on alike.
pub fn are_outnumbered(sets: &Sets, users: &IntegrationParameters) -> bool {
    if sets.parameters.contact_recycle_distance() >= users.contact_recycle_distance() {
        return false;
    }
    let (mut own, mut others) = (0, 0);
    for pair in contact_pairs(sets.narrow_phase, sets.participants) {
        let handles = [pair.collider1, pair.collider2];
        if !handles.iter().any(|handle| may_move(sets, *handle)) {
            continue;
        }
        match handles.iter().any(|handle| is_medial(sets, *handle)) {
            true => own += 1,
            false => others += 1,
        }
    }
    others >= OUTNUMBERED * own
}

fn is_medial(sets: &Sets, handle: ColliderHandle) -> bool {
    let collider = sets.colliders.get(handle);
    collider.is_some_and(|c| c.shape().as_shape::<MedialMesh>().is_some())
}

/// Whether a collider is on a body that is awake and not fixed.
fn may_move(sets: &Sets, handle: ColliderHandle) -> bool {
    let parent = sets.colliders.get(handle).and_then(Collider::parent);
    let body = parent.and_then(|body| sets.bodies.get(body));
    body.is_some_and(|body| !body.is_fixed() && !body.is_sleeping())
}
