//! Pairs that are watched however slow they are, since rapier's contacts of them are deep: the effect `guard`, whose
//! inequality is in `docs/effects.md`.

use crate::math::Real;
use crate::math::fast_hash::{FastMap, FastSet};
use crate::rapier::host::contact_depth::deepest;
use crate::rapier::impacts::toi_query::CcdPolicy;
use crate::rapier::view::eligible_pairs::in_order;
use crate::rapier::view::participants::{Participants, contact_pairs};
use crate::rapier::view::step_view::StepView;
use rapier3d::geometry::{ColliderHandle, NarrowPhase};

/// Depth, in units of rapier's length unit, from which a pair that was put into each other may be left to the solver:
/// twice the gap of a fast pair. Larger, and thin bodies spawned in one place are held there; smaller, and what rests
/// on a surface without thickness may be taken for put into it.
const SUNK_DEPTH: Real = 2.0e-3;

/// Depth of a watched pair: its contacts are so deep that even a slow one may get to the medial axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deep {
    /// Whether a contact is deeper than [`SUNK_DEPTH`].
    pub is_sunk: bool,
    /// Length by which the deepest contact exceeds the depth from which pairs are watched
    /// ([`Tuning::guarded`](crate::rapier::tuning::Tuning::guarded)), if it is below the floor and deeper than
    /// [`SUNK_DEPTH`]; 0 if none is.
    pub way: Real,
}

/// Pairs whose contacts in rapier are deep.
#[derive(Default)]
pub struct DeepPairs {
    /// The pairs that are watched.
    pub watched: FastMap<[usize; 2], Deep>,
    /// The pairs with a contact deeper than [`SUNK_DEPTH`], watched or not; pairs without a medial collider only where
    /// a watched pair is below the floor.
    pub sunk: FastSet<[usize; 2]>,
}

/// Finds the deep pairs. Those without a medial collider are never watched; that they are `sunk` may decide what a
/// medial one is pressed against.
pub fn deep(
    view: &StepView,
    (narrow_phase, participants): (&NarrowPhase, Option<&Participants>),
    policy: &CcdPolicy,
) -> DeepPairs {
    let tuning = &policy.tuning;
    let parts = view.colliders.iter().enumerate();
    let parts: FastMap<ColliderHandle, usize> = parts.map(|(k, p)| (p.handle, k)).collect();
    let mut deep = DeepPairs::default();
    let mut others = Vec::new();
    for found in contact_pairs(narrow_phase, participants) {
        let places = [found.collider1, found.collider2].map(|h| parts.get(&h));
        let [Some(&i), Some(&j)] = places else {
            continue;
        };
        if [i, j].iter().all(|k| view.colliders[*k].medial().is_none()) {
            others.push((found, [i, j]));
            continue;
        }
        let pair = in_order(view, [i, j]);
        let [start1, start2] = [i, j].map(|k| view.motion(k, 0.0).start);
        for m in found.manifolds() {
            let depth = deepest(m, [&start1, &start2]);
            if depth <= 0.0 {
                continue;
            }
            let thickness = view.thickness_at([i, j], [m.subshape1, m.subshape2]);
            let guarded = tuning.guarded() * thickness;
            let is_sunk = depth > SUNK_DEPTH * policy.unit;
            if is_sunk {
                deep.sunk.insert(pair);
            }
            if depth > guarded {
                let pair = deep.watched.entry(pair).or_default();
                pair.is_sunk |= is_sunk;
                if is_sunk && depth > tuning.floor * thickness {
                    pair.way = pair.way.max(depth - guarded);
                }
            }
        }
    }
    if deep.watched.values().any(|deep| deep.way > 0.0) {
        let sunk = others.iter().filter(|(found, [i, j])| {
            let [start1, start2] = [*i, *j].map(|k| view.motion(k, 0.0).start);
            let depths = found
                .manifolds()
                .iter()
                .map(|m| deepest(m, [&start1, &start2]));
            depths.fold(0.0, Real::max) > SUNK_DEPTH * policy.unit
        });
        deep.sunk
            .extend(sunk.map(|(_, pair)| in_order(view, *pair)));
    }
    deep
}
