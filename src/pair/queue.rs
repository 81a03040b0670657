//! What the search of [`super::first_contact`] still has to look at, in the order of the time before
//! which it is proven free.

use super::swept::Swept;
use crate::elementary::test_list::ElementaryTest;
use std::cmp::Ordering;

/// Something that may meet.
pub(super) enum Candidate {
    /// Two nodes, whose swept balls meet then.
    Nodes([Swept; 2]),
    /// Two primitives, free until then by directions that their spheres give.
    Primitives([u32; 2]),
    /// One elementary test of two primitives.
    Test(Open),
}

/// An elementary test that is not settled.
pub(super) struct Open {
    pub(super) primitives: [u32; 2],
    pub(super) test: ElementaryTest,
    /// Target distance of this primitive pair.
    pub(super) target: f64,
    /// Iterations so far.
    pub(super) spent: u32,
}

/// A candidate, ordered by the time until which it is free; of several at the same time, first the
/// tests, then primitives, then the node pair that overlaps deepest for its size.
pub(super) struct Entry {
    pub(super) time: f64,
    /// Signed distance of two node balls at the start of the piece, in units of their radii, so at
    /// least −1; below that for what is not a node pair.
    pub(super) depth: f64,
    pub(super) candidate: Candidate,
}

impl Entry {
    pub(super) fn nodes(time: f64, depth: f64, nodes: [Swept; 2]) -> Self {
        Self {
            time,
            depth,
            candidate: Candidate::Nodes(nodes),
        }
    }

    pub(super) fn primitives(time: f64, primitives: [u32; 2]) -> Self {
        Self {
            time,
            depth: -2.0,
            candidate: Candidate::Primitives(primitives),
        }
    }

    pub(super) fn test(time: f64, open: Open) -> Self {
        Self {
            time,
            depth: -3.0,
            candidate: Candidate::Test(open),
        }
    }

    /// Breaks ties, so that answers do not depend on the heap's habits.
    fn index(&self) -> ([u32; 2], [(u8, u8); 4]) {
        match &self.candidate {
            Candidate::Nodes([a, b]) => ([a.node, b.node], Default::default()),
            Candidate::Primitives(pair) => (*pair, Default::default()),
            Candidate::Test(open) => (open.primitives, open.test.corners),
        }
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Entry {}
impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Entry {
    /// Reversed: `BinaryHeap` pops the largest.
    fn cmp(&self, other: &Self) -> Ordering {
        (other.time.total_cmp(&self.time))
            .then(other.depth.total_cmp(&self.depth))
            .then_with(|| other.index().cmp(&self.index()))
    }
}
