//! Pairs that lie in each other because they were put there: spawned in one place, or teleported.
//!
//! Their medial axes are next to each other or cross already, so there is nothing left to keep, and holding them would
//! hold them for ever: whatever takes such a pair apart at one place takes it deeper at another. The event loop leaves
//! them to rapier's solver until they are above the floor ([`super::tuning::Tuning::floor`]), and keeps them there.
//!
//! A collider was put where it is if it is not where the step before left it. What was not put there, but pressed, is
//! held.

use super::snapshot::Snapshot;
use crate::math::Pose;
use crate::math::fast_hash::FastSet;
use rapier3d::geometry::{ColliderHandle, ColliderSet};

type Pair = [ColliderHandle; 2];

/// What is known from step to step. At first all that there is was put there.
#[derive(Default)]
pub struct Placed {
    /// Where the last step left the colliders, in the order of their indices.
    ends: Vec<(ColliderHandle, Pose)>,
    /// Colliders that were put where they are, before this step.
    put: FastSet<ColliderHandle>,
    /// Pairs that are left to the solver.
    left: FastSet<Pair>,
}

impl Placed {
    /// Looks for what was put where it is, at the start of a step.
    pub fn begin(&mut self, snapshot: &Snapshot, colliders: &ColliderSet) {
        self.put.clear();
        let mut ends = self.ends.iter().peekable();
        let index = |handle: ColliderHandle| handle.into_raw_parts().0;
        for part in &snapshot.parts {
            while ends
                .next_if(|(h, _)| index(*h) < index(part.handle))
                .is_some()
            {}
            let pose = colliders.get(part.handle).map(|c| *c.position());
            if ends.peek().map(|(h, at)| (*h, Some(*at))) != Some((part.handle, pose)) {
                self.put.insert(part.handle);
            }
        }
    }

    /// Of the pairs whose contacts in rapier are below the floor in this step, those that are left to the solver.
    pub fn leave(
        &mut self,
        snapshot: &Snapshot,
        sunk: impl Iterator<Item = [usize; 2]>,
    ) -> Vec<[usize; 2]> {
        let handles = |pair: [usize; 2]| pair.map(|k| snapshot.parts[k].handle);
        let was_put =
            |pair: Pair| pair.iter().any(|h| self.put.contains(h)) || self.left.contains(&pair);
        let pairs: Vec<_> = sunk.filter(|pair| was_put(handles(*pair))).collect();
        self.left = pairs.iter().map(|pair| handles(*pair)).collect();
        pairs
    }

    /// Remembers where the step leaves the colliders.
    pub fn end(&mut self, snapshot: &Snapshot, colliders: &ColliderSet) {
        self.ends.clear();
        let parts = snapshot.parts.iter().map(|part| part.handle);
        let ends = parts.filter_map(|h| Some((h, *colliders.get(h)?.position())));
        self.ends.extend(ends);
    }
}
