//! Chooses the pairs that are muted, that is kept from rapier's solver and left to the event loop: those that move by
//! more than their thickness in the step and do not touch yet. Contacts computed at the start of the step would come
//! too late for them, or lie at places where the bodies never meet: what falls beside a seam of the floor would be
//! thrown aside by the half that it passes within rapier's prediction distance, since the half that it meets is muted.
//! The inequality is that of `continuous` in `docs/effects.md`; the dispatcher then answers "no contacts"
//! ([`crate::parry::narrow_phase_plan`]).
//!
//! Where both bodies may be moved, and one belongs to a multibody that is unstable
//! ([`crate::rapier::host::multibody_energy`]), touching pairs are left to the event loop too. So are those of a body
//! that a joint has swing far in the step: rapier keeps the normal of the step's start and a point on either body,
//! and a point that goes along an arc falls behind what flies on before it; it is pressed back, the harder the more
//! sub-steps there are.
//!
//! A quarter of the step's budget may go into this; without it a pair is left to both. With half of it too little may
//! be left to reach the first impact of a heap, and the same step comes again and again.

use crate::math::Real;
use crate::parry::narrow_phase_plan::PairKey;
use crate::rapier::host::multibody_energy::is_unstable;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::view::eligible_pairs::{Rules, sweep};
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;
use rapier3d::geometry::{ColliderHandle, NarrowPhase};
use std::collections::HashSet;

/// The pairs that are kept from rapier's solver.
#[derive(Default)]
pub struct Muted {
    /// All of them, under the key by which the narrow phase will ask.
    pub keys: HashSet<PairKey>,
    /// Whether some may bounce ([`Effects::restitution`](crate::Effects::restitution)).
    pub bouncing: bool,
    /// Medial colliders whose contacts rapier must compute anew, because it may hold the wrong ones of a pair with
    /// restitution, and would keep them for as long as the two hardly move: old contacts, of a pair that is muted now
    /// for its bounce, or none, of a pair that may have been muted in the step before and is not now.
    pub stale: HashSet<ColliderHandle>,
}

/// Finds the pairs to be muted.
pub fn muted(
    view: &StepView,
    policy: &CcdPolicy,
    rules: &Rules,
    (narrow_phase, prediction): (&NarrowPhase, Real),
    work: &mut Work,
) -> Muted {
    let mut muted = Muted::default();
    if !view.any_restitution()
        && !policy.may_be_fast(view, policy.tuning.muted, view.least_thickness())
    {
        return muted;
    }
    // Work of the whole step up to which pairs are looked at; its parts before a stop may have spent some.
    let most = work.spent() + policy.budget_left(work).min(policy.budget / 4);
    for pair in sweep(view, policy.dt, prediction) {
        let [p, q] = pair.map(|k| &view.colliders[k]);
        let plane = p.shape.as_halfspace().or(q.shape.as_halfspace());
        let reach = prediction + p.skin + q.skin;
        let apart = |a: &parry3d::bounding_volume::Aabb, b: &parry3d::bounding_volume::Aabb| {
            (a.mins - b.maxs).max(b.mins - a.maxs).max_element() > reach
        };
        if plane.is_some() || apart(&p.aabb, &q.aabb) {
            continue;
        }
        let known = narrow_phase.contact_pair(p.handle, q.handle);
        let medial = if p.medial().is_some() { p } else { q };
        match reason(view, policy, rules, (pair, prediction, most), work) {
            Some(reason) => {
                let [m1, m2] = pair.map(|k| view.motion(k, 0.0).start);
                let key = PairKey::new(&*p.shape, &*q.shape, &m1.inv_mul(&m2));
                muted.keys.insert(key);
                if reason == Reason::Bounces {
                    muted.bouncing = true;
                    if known.is_some_and(|c| !c.manifolds().is_empty()) {
                        muted.stale.insert(medial.handle);
                    }
                }
            }
            None if view.restitution(pair) > 0.0
                && known.is_some_and(|c| !c.has_any_active_contact()) =>
            {
                muted.stale.insert(medial.handle);
            }
            None => {}
        }
    }
    muted
}

/// Why a pair is muted.
#[derive(PartialEq)]
enum Reason {
    Bounces,
    IsFast,
    IsUnstable,
    Swings,
}

fn reason(
    view: &StepView,
    policy: &CcdPolicy,
    rules: &Rules,
    (pair, prediction, most): ([usize; 2], Real, u64),
    work: &mut Work,
) -> Option<Reason> {
    let may_bounce = policy.may_bounce(view, pair);
    // Where a joint takes a body is not known yet: what is beside its path stays with rapier's solver.
    let jointed = pair.map(|k| view.bodies[view.colliders[k].body].jointed);
    let margin = if jointed.contains(&true) {
        0.0
    } else {
        prediction
    };
    let is_fast = policy.is_fast(view, pair, margin);
    if !(may_bounce || is_fast)
        || policy.speculates(view, pair)
        || work.spent() >= most
        || !rules.respond(view, pair)
    {
        return None;
    }
    // A pair that no force presses together does not rest, whatever its nearest points do.
    let rests = |speed: Option<Real>| speed.is_some_and(|s| s <= policy.least_bounce(view, pair));
    if may_bounce && (!view.may_be_pressed(pair) || !rests(policy.approach(view, pair, work))) {
        return Some(Reason::Bounces);
    }
    if !is_fast {
        return None;
    }
    if is_unstable_pair(view, policy, pair) {
        return Some(Reason::IsUnstable);
    }
    if !policy.touches(view, pair, work) {
        return Some(Reason::IsFast);
    }
    policy.swings(view, pair, work).then_some(Reason::Swings)
}

/// Whether two bodies may be moved, and one is of a multibody that is unstable.
fn is_unstable_pair(view: &StepView, policy: &CcdPolicy, pair: [usize; 2]) -> bool {
    let bodies = pair.map(|k| &view.bodies[view.colliders[k].body]);
    bodies.iter().all(|b| b.mobility == Mobility::Free)
        && bodies.iter().any(|b| is_unstable(b, policy.dt))
}
