//! The queue of the event loop: pairs in the order of the times before which they are known not to meet, and of
//! pairs with the same time in the order of their colliders.

use crate::math::Real;
use crate::math::fast_hash::FastMap;
use std::collections::BTreeSet;

type Pair = [usize; 2];

/// Queue of pairs, each once, with what waits for it.
pub struct EventQueue<T> {
    /// Bits of the time, pair, and place in `all`.
    order: BTreeSet<(u32, Pair, u32)>,
    entries: FastMap<Pair, (u32, u32)>,
    all: Vec<Option<T>>,
    unused: Vec<u32>,
    /// Partners of each collider with which it has waited since [`EventQueue::partners`] looked last.
    partners: FastMap<usize, Vec<usize>>,
}

impl<T> Default for EventQueue<T> {
    fn default() -> Self {
        Self {
            order: BTreeSet::new(),
            entries: FastMap::default(),
            all: Vec::new(),
            unused: Vec::new(),
            partners: FastMap::default(),
        }
    }
}

/// The bits of times ≥ 0 are in the order of the times.
fn bits(time: Real) -> u32 {
    time.max(0.0).to_bits()
}

impl<T> EventQueue<T> {
    /// Adds a pair that does not wait yet, until `time`, in seconds.
    pub fn insert(&mut self, pair: Pair, time: Real, what: T) {
        let place = self.unused.pop().unwrap_or_else(|| {
            self.all.push(None);
            self.all.len() as u32 - 1
        });
        self.all[place as usize] = Some(what);
        self.entries.insert(pair, (bits(time), place));
        self.order.insert((bits(time), pair, place));
        for [i, j] in [pair, [pair[1], pair[0]]] {
            self.partners.entry(i).or_default().push(j);
        }
    }

    /// Colliders with which `i` waits.
    pub fn partners(&mut self, i: usize) -> Vec<usize> {
        let Some(partners) = self.partners.get_mut(&i) else {
            return Vec::new();
        };
        partners.sort_unstable();
        partners.dedup();
        let entries = &self.entries;
        partners.retain(|&j| entries.contains_key(&[i, j]) || entries.contains_key(&[j, i]));
        partners.clone()
    }

    /// Forgets a pair.
    pub fn remove(&mut self, pair: Pair) {
        if let Some((time, place)) = self.entries.remove(&pair) {
            self.order.remove(&(time, pair, place));
            self.all[place as usize] = None;
            self.unused.push(place);
        }
    }

    /// All pairs.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> {
        self.order.iter().map(|(_, pair, _)| *pair)
    }

    /// The time of the first pair, in seconds.
    pub fn first_time(&self) -> Option<Real> {
        self.order.first().map(|(time, ..)| Real::from_bits(*time))
    }

    /// The first pair, what waits for it, and the time of the second one in seconds.
    pub fn first(&mut self) -> Option<(Pair, &mut T, Option<Real>)> {
        let mut order = self.order.iter();
        let (_, pair, place) = order.next()?;
        let next = order.next().map(|(time, ..)| Real::from_bits(*time));
        let what = self.all[*place as usize].as_mut()?;
        Some((*pair, what, next))
    }

    /// Reschedules the first pair to a later time.
    pub fn reschedule_first(&mut self, time: Real) {
        if let Some((_, pair, place)) = self.order.pop_first() {
            self.entries.insert(pair, (bits(time), place));
            self.order.insert((bits(time), pair, place));
        }
    }
}
