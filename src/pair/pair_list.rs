//! A set of primitive pairs of two bodies, by the nodes of both trees above them: a search goes down to these only.

use super::primitive_tree::PrimitiveTree;
use super::swept::{Bits, Listed};
use crate::medial::tree::NodeKind;
use std::sync::Arc;

/// Primitive pairs to search. It may hold others besides: of more than [`Bits::BITS`] pairs, several share a bit.
#[derive(Clone, Default)]
pub struct PairList(pub(super) Arc<Listed>);

impl PairList {
    /// These pairs of primitives, given by their numbers in the first and the second body.
    pub(super) fn of_primitives(
        bodies: (&impl PrimitiveTree, &impl PrimitiveTree),
        pairs: &[[u32; 2]],
    ) -> Self {
        Self(Arc::new([
            nodes_above(bodies.0, pairs.iter().map(|p| p[0])),
            nodes_above(bodies.1, pairs.iter().map(|p| p[1])),
        ]))
    }
}

/// Of each node of a body, the bits of the primitives below it; the n-th primitive given has the n-th bit.
fn nodes_above(body: &impl PrimitiveTree, primitives: impl Iterator<Item = u32>) -> Vec<Bits> {
    let mut bits: Vec<Bits> = Vec::new();
    for (n, primitive) in primitives.enumerate() {
        let primitive = primitive as usize;
        if bits.len() <= primitive {
            bits.resize(primitive + 1, 0);
        }
        bits[primitive] |= 1 << (n as u32 % Bits::BITS);
    }
    let mut above = Vec::new();
    for root in 0..body.roots() {
        gather(body, root, &bits, &mut above);
    }
    above
}

fn gather(body: &impl PrimitiveTree, node: u32, bits: &[Bits], above: &mut Vec<Bits>) -> Bits {
    let below = match body.kind(node) {
        NodeKind::Primitive(p) => bits.get(p as usize).copied().unwrap_or(0),
        NodeKind::Nodes(first, second) => {
            gather(body, first, bits, above) | gather(body, second, bits, above)
        }
    };
    if below != 0 {
        let at = node as usize;
        if above.len() <= at {
            above.resize(at + 1, 0);
        }
        above[at] = below;
    }
    below
}
