//! The queue of the search for a first contact ([`super::search`]): pairs of nodes, pairs of primitives and elementary
//! tests, in the order of the times until which they are proven not to meet.

use super::deepening::Threshold;
use super::tips::SubPrimitive;
use crate::elementary::test_list::ElementaryTest;
use crate::math::least_first::least_first;

/// An entry of the queue: a pair of nodes, a pair of primitives or parts of them, or an elementary test, of which it is
/// not known yet whether the two meet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum WorkItem {
    /// Two swept nodes: their balls meet then, or directions keep their primitives apart until then.
    Nodes([u32; 2]),
    /// Parts of two primitives that are tested: their place in the list of these.
    SubPrimitives(u32),
    /// An elementary test: its place in the list of those not settled.
    Test(u32),
}

/// A pair of primitives, or parts of them, whose elementary tests are listed, with the distance that counts as
/// contact.
#[derive(Clone, Copy)]
pub(super) struct Tested {
    /// The swept nodes that they are.
    pub(super) nodes: [u32; 2],
    pub(super) primitives: [u32; 2],
    /// Part of each that is tested.
    pub(super) parts: [SubPrimitive; 2],
    /// Condition that counts as contact.
    pub(super) threshold: Threshold,
}

/// An elementary test that is under way: its bracket is neither closed nor proven free.
#[derive(Clone, Copy)]
pub(super) struct OpenTest {
    /// Place of its [`Tested`] pair in the list of these.
    pub(super) of: u32,
    pub(super) test: ElementaryTest,
    /// Iterations so far.
    pub(super) spent: u32,
}

/// An entry of the queue: a candidate with the time until which it is proven free, by which entries are ordered.
///
/// At the same time, first come the tests, then primitives, then the node pair that overlaps deepest for its size;
/// among several of these, the one whose nodes come first in their trees, so that the order does not depend on what
/// else is looked at.
pub(super) struct Entry {
    pub(super) time: f64,
    /// Signed distance of two node balls at the start of the piece, in units of their radii, so at
    /// least −1; below that for what is not a node pair.
    pub(super) depth: f64,
    /// The bodies' nodes; 0 for what is not a node pair.
    of: [u32; 2],
    pub(super) candidate: WorkItem,
}

impl Entry {
    /// Anything but a node pair.
    pub(super) fn at(time: f64, candidate: WorkItem) -> Self {
        Self {
            time,
            depth: -2.0,
            of: [0; 2],
            candidate,
        }
    }

    /// Two swept nodes, which are these nodes of their bodies.
    pub(super) fn of_nodes(time: f64, depth: f64, swept: [u32; 2], of: [u32; 2]) -> Self {
        Self {
            time,
            depth,
            of,
            candidate: WorkItem::Nodes(swept),
        }
    }
}

least_first!(Entry, time + depth, of, candidate);
