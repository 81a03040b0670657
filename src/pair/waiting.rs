//! The part of the search for a first contact ([`super::search`]) that lets a candidate wait: where directions
//! ([`super::apart`]) prove two primitives or nodes apart for a while, they go back into the queue with that time.

use super::apart::{Balls, free_until, held_until};
use super::deepening::Threshold;
use super::primitive_tree::PrimitiveTree;
use super::queue::Entry;
use super::search::FirstContactSearch;
use crate::math::lane::Vec3;

/// Fraction of a piece by which directions must put off two primitives for them to wait in the queue;
/// with less their elementary tests are listed. Smaller lets the last steps before a contact creep,
/// larger runs tests that directions would have spared.
const WORTH_WAITING: f64 = 1.0e-3;

impl<A: PrimitiveTree, B: PrimitiveTree> FirstContactSearch<'_, A, B> {
    /// Whether directions gain too little for two candidates to wait.
    pub(super) fn gains_too_little(&self, free: f64, time: f64) -> bool {
        free < time + WORTH_WAITING * (self.times[1] - self.times[0])
    }

    /// Puts two nodes back into the queue, until `free`.
    pub(super) fn wait(&mut self, nodes: [u32; 2], free: f64) -> bool {
        let of = [
            self.sides.0.node(nodes[0]).node,
            self.sides.1.node(nodes[1]).node,
        ];
        self.queue(Entry::of_nodes(free, 0.0, nodes, of));
        true
    }

    /// Time until which directions prove two primitives free from `time` on; `None` if as long as the search asks.
    pub(super) fn free_until(&self, balls: [&Balls; 2], time: f64) -> Option<f64> {
        let touching = Threshold::new(self.reach, self.earliest.limits.tolerance);
        self.above_until(balls, &touching, time)
    }

    /// Time until which directions prove two primitives farther apart than `threshold` from `time` on; `None` if as
    /// long as the search asks. The factor of the threshold is not applied to the radii.
    pub(super) fn above_until(
        &self,
        balls: [&Balls; 2],
        threshold: &Threshold,
        time: f64,
    ) -> Option<f64> {
        self.in_piece(time, |span| {
            free_until(balls, span, threshold.target, threshold.tolerance)
        })
    }

    /// Time until which one direction alone proves them free, and until they come within the tolerance.
    pub(super) fn held_until(
        &self,
        balls: [&Balls; 2],
        n: Vec3<f64>,
        threshold: &Threshold,
        time: f64,
    ) -> Option<f64> {
        let contact = threshold.target + threshold.tolerance;
        self.in_piece(time, |span| held_until(balls, n, span, contact))
    }

    /// Answer to two fractions of the piece that is searched, from `time` to the end, as a time.
    pub(super) fn in_piece(
        &self,
        time: f64,
        free: impl Fn([f64; 2]) -> Option<f64>,
    ) -> Option<f64> {
        let [start, length] = [self.times[0], self.times[1] - self.times[0]];
        let [from, until] = self.span(time);
        let free = free([from, until])?;
        if free <= from {
            return Some(time);
        }
        // Rounding of the way to the piece's fractions and back.
        Some((start + free * length).next_down().next_down().max(time))
    }

    /// Span from `time` to the end of what is searched, in fractions of the piece.
    pub(super) fn span(&self, time: f64) -> [f64; 2] {
        let [start, end] = self.times;
        [time, self.earliest.upper.min(end)].map(|t| (t - start) / (end - start))
    }
}
