//! Chooses the pairs that are kept from rapier's solver and left to the event loop: those that move by more than
//! their thickness in the step and do not touch yet. Contacts computed at the start of the step would come too late
//! for them, or lie at places where the bodies never meet. Where both bodies may be moved, and one belongs to a multibody
//! that turns wildly ([`crate::rapier::host::multibody_energy`]), touching pairs are left to the event loop too. Half of the step's budget may go
//! into this; without it a pair is left to both.

use crate::math::Real;
use crate::parry::answers::Key;
use crate::rapier::host::multibody_energy::is_wild;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::view::eligible_pairs::{Rules, sweep};
use crate::rapier::view::motion::Kind;
use crate::rapier::view::step_view::StepView;
use std::collections::HashSet;

/// The pairs to be muted, under the key by which the narrow phase will ask.
pub fn muted(
    view: &StepView,
    policy: &CcdPolicy,
    rules: &Rules,
    prediction: Real,
    work: &mut Work,
) -> HashSet<Key> {
    let mut keys = HashSet::new();
    if !policy.may_be_fast(view, policy.tuning.muted, view.least_thickness()) {
        return keys;
    }
    for pair in sweep(view, policy.dt, 0.0) {
        let [p, q] = pair.map(|k| &view.parts[k]);
        let plane = p.shape.as_halfspace().or(q.shape.as_halfspace());
        let reach = prediction + p.skin + q.skin;
        let apart = |a: &parry3d::bounding_volume::Aabb, b: &parry3d::bounding_volume::Aabb| {
            (a.mins - b.maxs).max(b.mins - a.maxs).max_element() > reach
        };
        if plane.is_none()
            && !apart(&p.aabb, &q.aabb)
            && policy.is_fast(view, pair, policy.tuning.muted)
            && !policy.speculates(view, pair)
            && policy.left(work) > policy.budget / 2
            && rules.respond(view, pair)
            && (is_wild_pair(view, policy, pair) || !policy.touches(view, pair, work))
        {
            let [m1, m2] = pair.map(|k| view.motion(k, 0.0).start);
            keys.insert(Key::new(&*p.shape, &*q.shape, &m1.inv_mul(&m2)));
        }
    }
    keys
}

/// Whether two bodies may be moved, and one is of a multibody that turns wildly.
fn is_wild_pair(view: &StepView, policy: &CcdPolicy, pair: [usize; 2]) -> bool {
    let bodies = pair.map(|k| &view.bodies[view.parts[k].body]);
    bodies.iter().all(|b| b.kind == Kind::Free) && bodies.iter().any(|b| is_wild(b, policy.dt))
}
