//! A coarse hull of a medial mesh made of a few balls, however many spheres the mesh has. Directions that may keep
//! two bodies apart are tried on it before a search ([`crate::pair::outline`]).

use super::simplex::Simplex;
use super::sphere::MedialSphere;
use super::tree::{NodeKind, SphereTree};
use crate::math::{Real, Vector};

/// Most balls and primitives of an outline: the bits of a mask. A larger mesh is taken for nodes of its
/// tree.
pub const MAX_PROXY_ITEMS: usize = 64;

/// A body as a few balls and primitives, in its own frame.
#[derive(Clone, Debug, Default)]
pub struct ProxyHull {
    /// Balls whose hull holds it: centre and radius.
    pub balls: Vec<(Vector, Real)>,
    /// The balls of each primitive, whose hull holds it.
    pub primitives: Vec<u64>,
    /// Primitives that meet each node of the mesh's tree.
    pub nodes: Vec<u64>,
    /// Whether these are the mesh's own spheres and primitives.
    pub is_exact: bool,
}

impl ProxyHull {
    /// The hull of a mesh, by its spheres and primitives, or by nodes of its tree.
    pub fn of_mesh(spheres: &[MedialSphere], simplices: &[Simplex], tree: &SphereTree) -> Self {
        let count = tree.nodes().len();
        let mut proxy = Self {
            nodes: vec![0; count],
            ..Self::default()
        };
        if spheres.len() <= MAX_PROXY_ITEMS && simplices.len() <= MAX_PROXY_ITEMS {
            proxy.is_exact = true;
            let bits = |vertices: &[u32]| vertices.iter().fold(0, |m, &v| m | 1 << v);
            proxy.balls = spheres.iter().map(|s| (s.center, s.radius)).collect();
            proxy.primitives = simplices.iter().map(|s| bits(&s.vertices)).collect();
            for (at, node) in proxy.nodes.iter_mut().enumerate() {
                if let NodeKind::Primitive(primitive) = tree.nodes()[at].kind() {
                    *node = 1 << primitive;
                }
            }
        } else {
            for (k, at) in front(tree).into_iter().enumerate() {
                let node = &tree.nodes()[at as usize];
                proxy.balls.push((node.center, node.radius));
                proxy.primitives.push(1 << k);
                proxy.nodes[at as usize] = 1 << k;
            }
        }
        let nodes = &mut proxy.nodes;
        // Children come after their parents.
        for at in 0..count {
            if let NodeKind::Nodes(first, second) = tree.nodes()[at].kind() {
                nodes[first as usize] |= nodes[at];
                nodes[second as usize] |= nodes[at];
            }
        }
        for at in (0..count).rev() {
            if let NodeKind::Nodes(first, second) = tree.nodes()[at].kind() {
                nodes[at] |= nodes[first as usize] | nodes[second as usize];
            }
        }
        proxy
    }

    /// The hull of a shape that lies within the hull of these points, [`MAX_PROXY_ITEMS`] at most.
    pub fn of_points(points: &[Vector]) -> Self {
        let count = points.len().min(MAX_PROXY_ITEMS);
        Self {
            balls: points
                .iter()
                .map(|p| (*p, 0.0))
                .take(MAX_PROXY_ITEMS)
                .collect(),
            primitives: vec![(0..count).fold(0, |m, k| m | 1 << k)],
            nodes: Vec::new(),
            is_exact: false,
        }
    }
}

/// Nodes of a mesh's tree, more than half of [`MAX_PROXY_ITEMS`], that together hold all of it.
fn front(tree: &SphereTree) -> Vec<u32> {
    let mut front = vec![0];
    while front.len() <= MAX_PROXY_ITEMS / 2 {
        let split = |at: u32| match tree.nodes()[at as usize].kind() {
            NodeKind::Nodes(first, second) => [Some(first), Some(second)],
            NodeKind::Primitive(_) => [Some(at), None],
        };
        let next: Vec<u32> = front.iter().flat_map(|&at| split(at)).flatten().collect();
        if next.len() == front.len() {
            break;
        }
        front = next;
    }
    front
}
