//! Order of the leaves of a sphere tree, from which it is known below which of two children a primitive is.

use super::tree::{NodeKind, SphereTree};

/// Ranks of a tree's leaves, first children first: those below a node follow each other.
#[derive(Clone, Debug, Default)]
pub struct LeafOrder {
    /// Rank of each primitive's leaf.
    pub ranks: Vec<u32>,
    /// Primitive of each rank.
    pub primitives: Vec<u32>,
    /// Lowest rank below each node.
    pub first: Vec<u32>,
}

impl LeafOrder {
    /// Ranks the leaves of a tree.
    pub fn new(tree: &SphereTree) -> Self {
        let nodes = tree.nodes();
        // Each primitive has one leaf, and a binary tree one inner node less than leaves.
        let count = nodes.len().div_ceil(2);
        let mut order = Self {
            ranks: vec![0; count],
            primitives: Vec::with_capacity(count),
            first: vec![0; nodes.len()],
        };
        let mut waiting = vec![0];
        while let Some(node) = waiting.pop() {
            order.first[node as usize] = order.primitives.len() as u32;
            match nodes[node as usize].kind() {
                NodeKind::Nodes(first, second) => waiting.extend([second, first]),
                NodeKind::Primitive(primitive) => {
                    order.ranks[primitive as usize] = order.primitives.len() as u32;
                    order.primitives.push(primitive);
                }
            }
        }
        order
    }
}
