//! The order in which a walk down two trees looks for contacts ([`super::contacts()`]): which of two nodes is split
//! next. It has a file of its own because lists of primitive pairs are sorted in the same order ([`super::listed`]).

use super::primitive_tree::PrimitiveTree;
use crate::medial::tree::NodeKind;

/// The next step of a walk down two trees from two nodes. It depends on these two nodes alone, so all walks of two
/// trees come to primitive pairs in one order.
pub(super) enum Descent {
    /// Two leaves, of these primitives.
    Leaves([u32; 2]),
    /// The first node is replaced by its children, in this order.
    First([u32; 2]),
    /// The second node is.
    Second([u32; 2]),
}

impl Descent {
    pub(super) fn of((a, b): (&impl PrimitiveTree, &impl PrimitiveTree), [i, j]: [u32; 2]) -> Self {
        // A convex node waits until the other is convex too: then both are looked at whole.
        let first = || match (a.is_convex(i), b.is_convex(j)) {
            (true, false) => false,
            (false, true) => true,
            _ => a.bound(i).1 >= b.bound(j).1,
        };
        match [a.kind(i), b.kind(j)] {
            [NodeKind::Primitive(p), NodeKind::Primitive(q)] => Self::Leaves([p, q]),
            [NodeKind::Nodes(c, d), NodeKind::Primitive(_)] => Self::First([c, d]),
            [NodeKind::Nodes(c, d), NodeKind::Nodes(..)] if first() => Self::First([c, d]),
            [_, NodeKind::Nodes(c, d)] => Self::Second([c, d]),
        }
    }
}
