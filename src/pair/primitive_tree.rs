//! Tree that a query searches: a hierarchy of bounding spheres with primitives of 1 to 3 spheres at its leaves. A
//! medial mesh is one; loose primitives (the faces of a cuboid, a capsule, the triangles of a terrain near the body)
//! are another.

use crate::elementary::test_list::OwnedFeatures;
use crate::math::{Real, Vector};
use crate::medial::convex_pieces::ConvexPiece;
use crate::medial::proxy_hull::ProxyHull;
use crate::medial::simplex::Simplex;
use crate::medial::tree::NodeKind;
use crate::medial::{MedialMesh, MedialSphere};
use std::ops::Range;
use std::sync::Arc;

/// One to four spheres, by their number; unused entries repeat the last one.
pub type Hull = ([MedialSphere; 4], usize);

/// The spheres of a primitive as a hull.
fn hull_of([a, b, c]: [MedialSphere; 3], len: usize) -> Hull {
    ([a, b, c, c], len)
}

/// A sphere as a hull.
fn hull_of_sphere((center, radius): (Vector, Real)) -> Hull {
    ([MedialSphere::new(center, radius); 4], 1)
}

/// A body made of primitives, in its own frame.
pub trait PrimitiveTree {
    /// Number of root nodes; they are the nodes `0..roots()`.
    fn roots(&self) -> u32;
    /// Bounding sphere of a node.
    fn bound(&self, node: u32) -> (Vector, Real);
    /// Contents of a node.
    fn kind(&self, node: u32) -> NodeKind;
    /// One to four spheres whose hull holds what is below a node, a tighter bound than its sphere: those of its
    /// primitive, or the corners of a swept rectangle. By default the node's sphere.
    fn hull(&self, node: u32) -> Hull {
        hull_of_sphere(self.bound(node))
    }
    /// Spheres of a primitive (unused entries repeat the last one), and which edges and spheres it tests.
    fn primitive(&self, index: u32) -> ([MedialSphere; 3], OwnedFeatures);
    /// Thickness of a primitive, a length (`medial/thickness.rs`). Infinite for surfaces, and for solids
    /// that are represented by their surface.
    fn thickness(&self, _primitive: u32) -> Real {
        Real::INFINITY
    }
    /// The convex piece of several primitives that a node holds, neither more nor less, if it is known to hold one.
    fn convex_piece(&self, _node: u32) -> Option<&ConvexPiece> {
        None
    }
    /// The node that holds the convex piece of several primitives that a primitive is of, if it is of one.
    fn piece_of(&self, _primitive: u32) -> Option<u32> {
        None
    }
    /// Whether it is a medial mesh, whose primitives make one solid, so that some are inside others.
    fn is_medial(&self) -> bool {
        false
    }
    /// Whether what is below a node is known to be convex.
    fn is_convex(&self, node: u32) -> bool {
        matches!(self.kind(node), NodeKind::Primitive(_)) || self.convex_piece(node).is_some()
    }
    /// The range of primitives that bound the same convex body as this one. By default the primitive itself.
    fn convex_part(&self, index: u32) -> Range<u32> {
        index..index + 1
    }
    /// A few balls that enclose the body, if there are any.
    fn proxy_hull(&self) -> Option<&Arc<ProxyHull>> {
        None
    }
}

/// The largest radius below a node that holds a convex piece or a primitive, or less; 0 of any other.
pub(super) fn thickness(body: &impl PrimitiveTree, node: u32) -> Real {
    match (body.convex_piece(node), body.kind(node)) {
        (Some(piece), _) => piece.thickness,
        (None, NodeKind::Primitive(p)) => body.thickness(p),
        (None, NodeKind::Nodes(..)) => 0.0,
    }
}

impl PrimitiveTree for MedialMesh {
    fn is_medial(&self) -> bool {
        true
    }
    fn roots(&self) -> u32 {
        1
    }
    fn bound(&self, node: u32) -> (Vector, Real) {
        let n = &self.tree().nodes()[node as usize];
        (n.center, n.radius)
    }
    fn kind(&self, node: u32) -> NodeKind {
        self.tree().nodes()[node as usize].kind()
    }
    fn hull(&self, node: u32) -> Hull {
        match self.tree().nodes()[node as usize].kind() {
            NodeKind::Nodes(first, _) => (self.rectangles().of(first).corners, 4),
            NodeKind::Primitive(index) => {
                let (spheres, share) = PrimitiveTree::primitive(self, index);
                hull_of(spheres, share.spheres)
            }
        }
    }
    fn primitive(&self, index: u32) -> ([MedialSphere; 3], OwnedFeatures) {
        let s: &Simplex = &self.simplices()[index as usize];
        let spheres = s.vertices.map(|v| self.spheres()[v as usize]);
        let share = OwnedFeatures {
            spheres: s.len as usize,
            edges: s.owns_edge,
            vertices: s.owns_vertex,
        };
        (spheres, share)
    }
    fn thickness(&self, primitive: u32) -> Real {
        self.thicknesses().primitives[primitive as usize]
    }
    fn convex_piece(&self, node: u32) -> Option<&ConvexPiece> {
        self.convex_pieces().of_node(node)
    }
    fn piece_of(&self, primitive: u32) -> Option<u32> {
        self.convex_pieces().node_of(primitive)
    }
    fn proxy_hull(&self) -> Option<&Arc<ProxyHull>> {
        Some(MedialMesh::proxy_hull(self))
    }
}

/// Loose primitives from which on a list has a hierarchy of nodes: fewer are looked at one by one, which costs less in
/// a search of many pieces, as each begins at the root.
const TREE_FROM: usize = 64;

/// A node of a list: its bounding sphere, and what is below it.
type ListNode = (Vector, Real, NodeKind);

/// A list of loose primitives, with a hierarchy if it is asked for ([`Self::build_tree`]).
#[derive(Clone, Debug, Default)]
pub struct PrimitiveList {
    primitives: Vec<([MedialSphere; 3], usize)>,
    /// A node for each primitive; in a hierarchy the root, and all below it.
    nodes: Vec<ListNode>,
    has_tree: bool,
    /// For each primitive of a part that is complete, the range of the part's primitives: its first, and the one behind
    /// its last.
    parts: Vec<[u32; 2]>,
}

impl PrimitiveList {
    /// Adds a primitive of 1 to 3 spheres; others are ignored.
    pub fn push(&mut self, spheres: &[MedialSphere]) {
        debug_assert!(!self.has_tree, "a primitive after the tree was built");
        let &[a, ..] = spheres else { return };
        let get = |i: usize| spheres.get(i).copied();
        let b = get(1).unwrap_or(a);
        let c = get(2).unwrap_or(b);
        let all = [a, b, c];
        let center = all[..spheres.len().min(3)]
            .iter()
            .fold(Vector::ZERO, |sum, s| sum + s.center)
            / spheres.len().min(3) as Real;
        let radius = radius_around(center, all.map(|s| (s.center, s.radius)));
        let kind = NodeKind::Primitive(self.primitives.len() as u32);
        self.primitives.push((all, spheres.len().min(3)));
        self.nodes.push((center, radius, kind));
    }

    /// Puts the primitives under one root, if they are many. None can be added after that.
    pub fn build_tree(&mut self) {
        if self.has_tree || self.primitives.len() < TREE_FROM {
            return;
        }
        self.has_tree = true;
        let mut leaves = std::mem::take(&mut self.nodes);
        self.nodes = Vec::with_capacity(2 * leaves.len());
        self.nodes.push(leaves[0]);
        self.fill(0, &mut leaves);
    }

    /// Makes a node one that holds these leaves, halved at the median of their longest spread.
    fn fill(&mut self, node: usize, leaves: &mut [ListNode]) {
        if let [only] = leaves {
            self.nodes[node] = *only;
            return;
        }
        let mins = leaves.iter().fold(Vector::MAX, |mins, l| mins.min(l.0));
        let maxs = leaves.iter().fold(Vector::MIN, |maxs, l| maxs.max(l.0));
        let (center, spread) = ((mins + maxs) * 0.5, (maxs - mins).to_array());
        let radius = radius_around(center, leaves.iter().map(|l| (l.0, l.1)));
        let first = self.nodes.len();
        self.nodes[node] = (
            center,
            radius,
            NodeKind::Nodes(first as u32, first as u32 + 1),
        );
        self.nodes.extend([leaves[0]; 2]);
        let axis = (0..3).fold(0, |a, k| if spread[k] > spread[a] { k } else { a });
        let middle = leaves.len() / 2;
        leaves.select_nth_unstable_by(middle, |a, b| {
            a.0[axis].total_cmp(&b.0[axis]).then(a.2.cmp(&b.2))
        });
        let (low, high) = leaves.split_at_mut(middle);
        self.fill(first, low);
        self.fill(first + 1, high);
    }

    /// Ends a part: the primitives added since the last call bound one convex body.
    pub fn end_part(&mut self) {
        let part = [self.parts.len() as u32, self.primitives.len() as u32];
        self.parts.resize(self.primitives.len(), part);
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.primitives.len()
    }

    /// Whether there are no primitives.
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }
}

/// Radius of the sphere about `center` that holds these spheres, and a few ulps of the coordinates for rounding.
fn radius_around(center: Vector, spheres: impl IntoIterator<Item = (Vector, Real)>) -> Real {
    let reaches = spheres.into_iter();
    let reaches = reaches.map(|(place, radius)| (place - center).length() + radius);
    let reach = reaches.fold(0.0, Real::max);
    reach + 8.0 * Real::EPSILON * (reach + center.abs().max_element())
}

impl PrimitiveTree for PrimitiveList {
    fn roots(&self) -> u32 {
        match self.has_tree {
            true => 1,
            false => self.primitives.len() as u32,
        }
    }
    fn bound(&self, node: u32) -> (Vector, Real) {
        let (center, radius, _) = self.nodes[node as usize];
        (center, radius)
    }
    fn kind(&self, node: u32) -> NodeKind {
        self.nodes[node as usize].2
    }
    fn hull(&self, node: u32) -> Hull {
        match self.kind(node) {
            NodeKind::Primitive(index) => {
                let (spheres, len) = self.primitives[index as usize];
                hull_of(spheres, len)
            }
            NodeKind::Nodes(..) => hull_of_sphere(self.bound(node)),
        }
    }
    fn primitive(&self, index: u32) -> ([MedialSphere; 3], OwnedFeatures) {
        let (spheres, n) = self.primitives[index as usize];
        (spheres, OwnedFeatures::whole(n))
    }
    fn convex_part(&self, index: u32) -> Range<u32> {
        let part = self.parts.get(index as usize);
        part.map_or(index..index + 1, |&[first, end]| first..end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundred triangles with rounded edges, spread out along a curve.
    fn list() -> PrimitiveList {
        let mut list = PrimitiveList::default();
        for i in 0..100 {
            let t = i as Real * 0.37;
            let at = Vector::new(t.sin() * 5.0, t * 0.1, (1.7 * t).cos());
            let corner = |k: u32| at + Vector::new(0.3, 0.1 * k as Real, 0.2 * (k * k) as Real);
            list.push(&[0, 1, 2].map(|k| MedialSphere::new(corner(k), 0.01 * k as Real)));
        }
        list
    }

    /// The primitives below a node, whose spheres all lie in the spheres of the nodes above them.
    fn below(list: &PrimitiveList, node: u32, above: &[(Vector, Real)]) -> Vec<u32> {
        let mut bounds = above.to_vec();
        bounds.push(list.bound(node));
        match list.kind(node) {
            NodeKind::Nodes(a, b) => [a, b].map(|n| below(list, n, &bounds)).concat(),
            NodeKind::Primitive(index) => {
                for s in list.primitive(index).0 {
                    let holds = |b: &(Vector, Real)| (s.center - b.0).length() + s.radius <= b.1;
                    assert!(bounds.iter().all(holds), "primitive {index}");
                }
                vec![index]
            }
        }
    }

    #[test]
    fn a_tree_holds_every_primitive_once_and_encloses_it() {
        let mut list = list();
        assert_eq!(list.roots(), 100);
        list.build_tree();
        assert_eq!(list.roots(), 1);
        let mut found = below(&list, 0, &[]);
        found.sort_unstable();
        assert_eq!(found, (0..100).collect::<Vec<u32>>());
    }

    #[test]
    fn few_primitives_and_those_at_one_place_are_fine() {
        let sphere = MedialSphere::new(Vector::X, 1.0);
        for n in [0, 1, TREE_FROM - 1, TREE_FROM, 200] {
            let mut list = PrimitiveList::default();
            (0..n).for_each(|_| list.push(&[sphere]));
            list.build_tree();
            let found: usize = (0..list.roots()).map(|r| below(&list, r, &[]).len()).sum();
            assert_eq!(found, n);
        }
    }
}
