//! Tree that a query searches: a hierarchy of bounding spheres with primitives of 1 to 3 spheres at its leaves. A
//! medial mesh is one; a few loose primitives (the faces of a cuboid, a capsule, the triangles of a terrain near the
//! body) are another.

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
        let (center, radius) = self.bound(node);
        ([MedialSphere::new(center, radius); 4], 1)
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

/// A list of loose primitives without a hierarchy.
#[derive(Clone, Debug, Default)]
pub struct PrimitiveList {
    primitives: Vec<([MedialSphere; 3], usize)>,
    bounds: Vec<(Vector, Real)>,
    /// Range of primitives of the part, for each primitive of a part that has ended: its first and the one behind its
    /// last.
    parts: Vec<[u32; 2]>,
}

impl PrimitiveList {
    /// Adds a primitive of 1 to 3 spheres; others are ignored.
    pub fn push(&mut self, spheres: &[MedialSphere]) {
        let &[a, ..] = spheres else { return };
        let get = |i: usize| spheres.get(i).copied();
        let b = get(1).unwrap_or(a);
        let c = get(2).unwrap_or(b);
        let all = [a, b, c];
        let center = all[..spheres.len().min(3)]
            .iter()
            .fold(Vector::ZERO, |sum, s| sum + s.center)
            / spheres.len().min(3) as Real;
        let reach = all
            .iter()
            .map(|s| (s.center - center).length() + s.radius)
            .fold(0.0, Real::max);
        // Rounding of the centre and of the distances: a few ulps of the coordinates.
        let size = reach + center.abs().max_element();
        self.primitives.push((all, spheres.len().min(3)));
        self.bounds
            .push((center, reach + 8.0 * Real::EPSILON * size));
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

impl PrimitiveTree for PrimitiveList {
    fn roots(&self) -> u32 {
        self.primitives.len() as u32
    }
    fn bound(&self, node: u32) -> (Vector, Real) {
        self.bounds[node as usize]
    }
    fn kind(&self, node: u32) -> NodeKind {
        NodeKind::Primitive(node)
    }
    fn hull(&self, node: u32) -> Hull {
        let (spheres, len) = self.primitives[node as usize];
        hull_of(spheres, len)
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
