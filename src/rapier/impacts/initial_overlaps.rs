//! Pairs that are deep in each other because the user put them there: spawned at one place, or teleported.
//!
//! The medial axes of such a pair are near each other or cross already, so there is nothing left to protect, and
//! holding them apart would hold them as they are for ever: whatever parts them at one place takes them deeper at
//! another. So the event loop leaves such a pair to rapier's solver until none of its contacts is deep any more
//! ([`crate::rapier::impacts::deep_pairs`]), and keeps it above the floor ([`crate::rapier::tuning::Tuning::floor`]) from
//! then on. A pair left to the solver until it is above the floor alone would be held there: next to the contact that is
//! above it are edges that still cross.
//!
//! A pair counts as put into each other if one of the two is new and rapier had no contacts of the pair, or if it is below
//! the floor and the two were moved against each other, between two steps, by so much that they may have been apart before. A pair that
//! forces pressed together is held, even if both are moved together.

use crate::math::fast_hash::{FastMap, FastSet};
use crate::math::{Pose, Real};
use crate::rapier::impacts::deep_pairs::Deep;
use crate::rapier::view::step_view::StepView;
use rapier3d::geometry::{ColliderHandle, ColliderSet, NarrowPhase};

type Pair = [ColliderHandle; 2];

/// Record from step to step of bodies put into each other.
#[derive(Default)]
pub struct InitialOverlaps {
    /// Poses at which the last step left the colliders, in the order of their indices.
    ends: Vec<(ColliderHandle, Pose)>,
    /// Pairs of new colliders of which rapier has contacts from before this step: of a world that was loaded.
    met: FastSet<Pair>,
    /// Pairs that are left to the solver.
    left: FastSet<Pair>,
}

fn index(handle: ColliderHandle) -> u32 {
    handle.into_raw_parts().0
}

/// The two in the order of their indices.
fn sorted([a, b]: Pair) -> Pair {
    if index(a) <= index(b) { [a, b] } else { [b, a] }
}

impl InitialOverlaps {
    /// Looks at the contacts that rapier has of new colliders, at the start of a step.
    pub fn begin(&mut self, view: &StepView, narrow_phase: &NarrowPhase) {
        self.met.clear();
        let is_new = |handle| self.end_of(handle).is_none();
        if !view.parts.iter().any(|part| is_new(part.handle)) {
            return;
        }
        let pairs = narrow_phase
            .contact_pairs()
            .filter(|pair| pair.has_any_active_contact());
        let pairs = pairs.map(|pair| sorted([pair.collider1, pair.collider2]));
        self.met = pairs
            .filter(|pair| pair.iter().any(|h| is_new(*h)))
            .collect();
    }

    /// Pairs with deep contacts in this step that are left to the solver.
    pub fn leave(&mut self, view: &StepView, deep: &FastMap<[usize; 2], Deep>) -> Vec<[usize; 2]> {
        let handles = |pair: [usize; 2]| sorted(pair.map(|k| view.parts[k].handle));
        let was_put = |pair: [usize; 2], deep: &Deep| match self.moved(view, pair) {
            Some(moved) => deep.way > 0.0 && moved >= deep.way,
            None => deep.is_sunk && !self.met.contains(&handles(pair)),
        };
        let is_left = |pair: &[usize; 2], deep: &Deep| {
            self.left.contains(&handles(*pair)) || was_put(*pair, deep)
        };
        let left = deep.iter().filter(|(pair, deep)| is_left(pair, deep));
        let pairs: Vec<_> = left.map(|(pair, _)| *pair).collect();
        self.left = pairs.iter().map(|pair| handles(*pair)).collect();
        pairs
    }

    /// Remembers where the step leaves the colliders.
    pub fn end(&mut self, view: &StepView, colliders: &ColliderSet) {
        self.ends.clear();
        let parts = view.parts.iter().map(|part| part.handle);
        let ends = parts.filter_map(|h| Some((h, *colliders.get(h)?.position())));
        self.ends.extend(ends);
    }

    fn end_of(&self, handle: ColliderHandle) -> Option<&Pose> {
        let place = self
            .ends
            .binary_search_by_key(&index(handle), |(h, _)| index(*h));
        let (known, pose) = &self.ends[place.ok()?];
        (*known == handle).then_some(pose)
    }

    /// Bound on how far points of two colliders were moved against each other between the last step and this one, a
    /// length; `None` if one of them is new.
    fn moved(&self, view: &StepView, pair: [usize; 2]) -> Option<Real> {
        let [p, q] = pair.map(|k| &view.parts[k]);
        let start = |k: usize| view.start_pose(pair[k]);
        let before = self.end_of(p.handle)?.inv_mul(self.end_of(q.handle)?);
        let now = start(0).inv_mul(&start(1));
        let turn = before.rotation.angle_between(now.rotation);
        let extent = q.bound.center().length() + q.bound.radius();
        Some((now.translation - before.translation).length() + turn * extent)
    }
}
