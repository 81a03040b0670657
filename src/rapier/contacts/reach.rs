//! How far two medial colliders may move against each other before their contacts are computed again, and so how far
//! away contacts have to be known. The bound goes by velocities, gravity, forces and neighbours.

use crate::math::Real;
use crate::rapier::view::medial_colliders::MedialCollider;
use rapier3d::dynamics::IntegrationParameters;

/// Thickness (a radius) below which contacts of a body are computed anew in each step, in units of the distance by
/// which a pair may move before. At 1 twice as many boxes of a centimetre tremble on a hull in a world of metres (21 of
/// 24).
const THIN_RATIO: Real = 0.25;

/// Whether a collider moves and is so thin that its contacts are computed anew in each step: it would be through a wall
/// by the time that rapier does so.
pub fn is_thin(collider: &MedialCollider, parameters: &IntegrationParameters) -> bool {
    let thin = THIN_RATIO * parameters.contact_recycle_distance();
    collider.moving.is_some() && collider.mesh.thickness() < thin
}

/// Bound on the speed at which two colliders close.
pub fn closing([a, b]: [&MedialCollider; 2]) -> Real {
    (a.motion.linvel - b.motion.linvel).length() + a.swing() + b.swing()
}

/// Gap, without contact skins, that two colliders may close before their contacts are computed again: their
/// [`way()`], at most rapier's prediction distance. Where the user writes into the contacts, all of that distance: a
/// hook may bring nearer what could not be closed, or take from the solver what holds another back.
pub fn reach(starts: [&MedialCollider; 2], parameters: &IntegrationParameters) -> Real {
    parameters
        .prediction_distance()
        .min(way(starts, parameters))
}

/// How far two colliders may move against each other before their contacts are computed again, by their
/// velocities, gravity, forces and what is near them. Beside joints, and where the user writes into their contacts, it
/// has no bound.
///
/// The bound is for this step, in which something may push them (rapier lets nothing bounce before the poses are
/// final, so no push is faster than what pushes), or for the steps in which rapier keeps their contacts. A recycled
/// pair that is pushed later may exceed this bound.
pub fn way(starts: [&MedialCollider; 2], parameters: &IntegrationParameters) -> Real {
    if starts.iter().any(|s| s.is_modified()) {
        return Real::MAX;
    }
    let dt = parameters.dt;
    let [a, b] = starts.map(|s| s.acceleration);
    // Either may be held by something.
    let pull = a.length().max(b.length()).max(a.distance(b));
    let gains = pull * dt * dt;
    let substeps = parameters.num_solver_iterations.max(1) as Real;
    let falls = gains * (substeps + 1.0) / (2.0 * substeps);
    let closes = closing(starts) * dt;
    let pushed = starts[0].pushed.max(starts[1].pushed) * dt;
    let in_step = closes + falls + pushed;
    if starts.iter().any(|s| is_thin(s, parameters)) {
        return in_step;
    }
    let kept = parameters.contact_recycle_distance();
    in_step.max(unasked(closes, [gains, falls], kept))
}

/// How far a pair gets while rapier keeps its contacts: until the end of the last step at whose start it has
/// moved by no more than `kept`. Without forces it closes by at most `closes` in a step; with them by `falls`
/// more in the first one, and by `gains` more in each than in the one before.
///
/// After `n` steps that begin at `c <= closes` it has come `n c + (n (n - 1) / 2) gains + n falls`, and the
/// next one adds `c + n gains + falls`: the most over all `c` and `n`. Beyond `STEPS` of them `n gains` is at most
/// `√(2 kept gains)`, since `falls` is half of `gains` or more, and `c` at most `kept / n`.
fn unasked(closes: Real, [gains, falls]: [Real; 2], kept: Real) -> Real {
    const STEPS: u8 = 4;
    let mut furthest = kept;
    let mut fallen = falls;
    for n in (1..=STEPS).map(Real::from) {
        if fallen > kept {
            return furthest;
        }
        let steady = closes.min((kept - fallen) / n);
        fallen += n * gains + falls;
        furthest = furthest.max((n + 1.0) * steady + fallen);
    }
    let steady = closes.min(kept / Real::from(STEPS));
    furthest.max(kept + steady + (2.0 * kept * gains).sqrt() + falls)
}
