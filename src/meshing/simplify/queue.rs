//! Collapses in the order of their costs.
//!
//! Each collapse changes the costs of a dozen edges, and what was queued before is stale. Most of it
//! lies far down a heap, where it costs each step time. So only the cheapest are in the heap, and the
//! others in a list, from which the stale ones are struck when the heap is empty and its cheapest part
//! moves up. The order is that of one heap.

use crate::math::least_first::least_first;
use crate::meshing::watch::bytes_of;
use std::collections::BinaryHeap;

/// Each time the heap is empty it takes the cheapest one in this many of the waiting collapses. Only speed depends on
/// it.
const REFILL_PART: usize = 8;

/// Number of waiting collapses up to which the heap takes all of them. Only speed depends on it.
const REFILL_WHOLE: usize = 512;

/// An edge to collapse (`a < b`), or a lone ball to drop (`a == b`).
#[derive(Clone, Copy)]
pub struct QueuedCollapse {
    /// Cost of the merge.
    pub cost: f64,
    /// First end of the edge.
    pub a: u32,
    /// Second end of the edge.
    pub b: u32,
    /// Versions of both when the cost was computed; an older one is stale.
    pub versions: [u32; 2],
}

least_first!(QueuedCollapse, cost, a, b);

/// Candidates, the cheapest first.
#[derive(Clone)]
pub struct Queue {
    heap: BinaryHeap<QueuedCollapse>,
    /// Collapses that cost more than `limit`, in no order.
    later: Vec<QueuedCollapse>,
    limit: f64,
}

impl Default for Queue {
    fn default() -> Self {
        Self {
            heap: BinaryHeap::new(),
            later: Vec::new(),
            limit: f64::NEG_INFINITY,
        }
    }
}

impl Queue {
    /// Bytes of its arrays.
    pub fn bytes(&self) -> usize {
        self.heap.capacity() * size_of::<QueuedCollapse>() + bytes_of(&self.later)
    }

    /// Adds one.
    pub fn push(&mut self, candidate: QueuedCollapse) {
        if candidate.cost <= self.limit {
            self.heap.push(candidate);
        } else {
            self.later.push(candidate);
        }
    }

    /// Takes out the cheapest collapse that is `current`.
    pub fn pop(&mut self, current: impl Fn(&QueuedCollapse) -> bool) -> Option<QueuedCollapse> {
        loop {
            while let Some(candidate) = self.heap.pop() {
                if current(&candidate) {
                    return Some(candidate);
                }
            }
            self.later.retain(&current);
            let last = match self.later.len() {
                0 => return None,
                n if n <= REFILL_WHOLE => n - 1,
                n => n / REFILL_PART,
            };
            let by_cost = |x: &QueuedCollapse, y: &QueuedCollapse| x.cost.total_cmp(&y.cost);
            self.limit = self.later.select_nth_unstable_by(last, by_cost).1.cost;
            let limit = self.limit;
            let cheap = |c: &mut QueuedCollapse| c.cost.total_cmp(&limit).is_le();
            self.heap.extend(self.later.extract_if(.., cheap));
        }
    }
}
