//! A set of primitive pairs of two bodies, by the nodes of both trees above them: a search goes down to these only.

use super::primitive_tree::PrimitiveTree;
use super::swept::{Bits, ListedBits, add_bits};
use crate::medial::tree::NodeKind;
use std::sync::Arc;

/// Primitive pairs to search. It may hold others besides: of more than [`Bits::BITS`] pairs, several share a bit.
#[derive(Clone, Default)]
pub struct PairList(pub(super) Arc<ListedBits>);

impl PairList {
    /// All pairs of primitives below these pairs of nodes of the first and the second body.
    pub(super) fn of_nodes(
        bodies: (&impl PrimitiveTree, &impl PrimitiveTree),
        pairs: &[[u32; 2]],
    ) -> Self {
        Self(Arc::new([
            bits_of_nodes(bodies.0, pairs.iter().map(|p| p[0])),
            bits_of_nodes(bodies.1, pairs.iter().map(|p| p[1])),
        ]))
    }
}

/// Bits for each node of a body: bit `n` is set if the n-th of the given nodes is below it, above it or itself.
fn bits_of_nodes(body: &impl PrimitiveTree, nodes: impl Iterator<Item = u32>) -> Vec<Bits> {
    let mut bits: Vec<Bits> = Vec::new();
    for (n, node) in nodes.enumerate() {
        add_bits(&mut bits, node, 1 << (n as u32 % Bits::BITS));
    }
    for root in 0..body.roots() {
        spread(body, root, 0, &mut bits);
    }
    bits
}

/// Adds the bits `above` a node to all below it, and theirs to it; returns the latter.
fn spread(body: &impl PrimitiveTree, node: u32, above: Bits, bits: &mut Vec<Bits>) -> Bits {
    let own = bits.get(node as usize).copied().unwrap_or(0);
    let below = match body.kind(node) {
        NodeKind::Primitive(_) => 0,
        NodeKind::Nodes(first, second) => [first, second]
            .map(|child| spread(body, child, above | own, bits))
            .into_iter()
            .fold(0, |all, child| all | child),
    };
    add_bits(bits, node, above | below);
    own | below
}
