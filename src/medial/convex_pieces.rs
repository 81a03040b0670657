//! Convex pieces of a medial mesh: connected parts of it whose primitives together fill the convex hull of their
//! spheres, as those of a box do. A query may then look at the hull of a piece instead of at each of its primitives.

use super::exact::{balls, tangent_normals};
use super::simplex::{Simplex, primitive_of};
use super::sphere::MedialSphere;
use super::thickness;
use super::tree::{NodeKind, SphereTree};
use crate::math::fast_hash::FastSet;
use crate::math::lane::Vec3;
use crate::math::{Real, Vector};

/// Cosine from which two outward normals are one: a hundredth of a degree.
const SAME_NORMAL: f64 = 1.0 - 1.5e-8;

/// Distance from the plane of a face up to which spheres end on it, in units of the largest coordinate.
const ON_FACE: f64 = 1.0e-4;

/// A flat face of a convex piece.
#[derive(Clone, Debug)]
pub struct PieceFace {
    /// Outward unit normal.
    pub normal: Vector,
    /// The spheres at its corners by their places in [`ConvexPiece::spheres`], counter-clockwise seen from outside. At
    /// least three.
    pub corners: Vec<u32>,
}

/// The edges of a polyhedron, grown by a radius.
#[derive(Clone, Debug)]
pub struct PieceEdges {
    /// An edge of each direction, the longest: its ends by their places in [`ConvexPiece::spheres`].
    pub ends: Vec<[u32; 2]>,
    /// The radius of all corners, a length.
    pub radius: Real,
}

/// A connected part of a mesh that is the convex hull of its spheres, in the body's frame.
#[derive(Clone, Debug)]
pub struct ConvexPiece {
    /// The thinnest primitive of the piece. Contacts of the piece are reported as of this primitive, and with its
    /// thickness.
    pub primitive: u32,
    /// Spheres of the piece.
    pub spheres: Vec<MedialSphere>,
    /// Flat faces of the piece.
    pub faces: Vec<PieceFace>,
    /// Edges of the piece, if it is a polyhedron grown by one radius; `None` otherwise.
    pub edges: Option<PieceEdges>,
    /// Thickness of [`Self::primitive`], a length (`thickness.rs`).
    pub thickness: Real,
    /// Whether each primitive of the piece is blunt (`thickness.rs`).
    pub is_blunt: bool,
}

impl ConvexPiece {
    fn new(
        spheres: &[MedialSphere],
        primitives: &[Simplex],
        thicknesses: &[Real],
        group: &[u32],
    ) -> Self {
        let of_group = || group.iter().map(|p| &primitives[*p as usize]);
        let mut vertices: Vec<u32> = of_group().flat_map(|p| p.vertices).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut normals: Vec<Vec3<f64>> = Vec::new();
        for p in of_group() {
            let slab = primitive_of(spheres, p).as_slab();
            for n in tangent_normals(&balls(slab)).into_iter().flatten() {
                if normals.iter().all(|other| other.dot(n) < SAME_NORMAL) {
                    normals.push(n);
                }
            }
        }
        let own = |p: &Simplex| {
            let own = p.vertices.map(|v| spheres[v as usize]);
            (own, usize::from(p.len).clamp(1, 3))
        };
        let is_blunt = of_group().all(|p| {
            let (spheres, count) = own(p);
            thickness::is_blunt(&spheres[..count])
        });
        let of_each = group.iter().map(|p| (*p, thicknesses[*p as usize]));
        let thinnest = of_each.min_by(|p, q| p.1.total_cmp(&q.1));
        let (primitive, thickness) = thinnest.unwrap_or((group[0], 0.0));
        let spheres: Vec<_> = vertices.iter().map(|v| spheres[*v as usize]).collect();
        let mut faces: Vec<PieceFace> = Vec::new();
        for found in normals.iter().filter_map(|n| face(&spheres, *n)) {
            // A face that many slabs touch has several normals, by rounding.
            let holds = |a: &PieceFace, b: &PieceFace| {
                let all = b.corners.iter().all(|k| a.corners.contains(k));
                all && a.normal.dot(b.normal) > 0.0
            };
            if !faces.iter().any(|other| holds(other, &found)) {
                faces.retain(|other| !holds(&found, other));
                faces.push(found);
            }
        }
        Self {
            primitive,
            edges: edges(&spheres, &faces),
            faces,
            thickness,
            is_blunt,
            spheres,
        }
    }
}

/// The edges of the hull of spheres that has these faces, if they close and their corners have one radius.
fn edges(spheres: &[MedialSphere], faces: &[PieceFace]) -> Option<PieceEdges> {
    let radius = spheres[*faces.first()?.corners.first()? as usize].radius;
    // Each edge of a closed surface is passed once in each direction.
    let mut passed = FastSet::default();
    let mut all = Vec::new();
    for face in faces {
        let next = face.corners.iter().cycle().skip(1);
        for (a, b) in face.corners.iter().zip(next) {
            if spheres[*a as usize].radius != radius || !passed.insert([*a, *b]) {
                return None;
            }
            all.extend((a < b).then_some([*a, *b]));
        }
    }
    if !passed.iter().all(|[a, b]| passed.contains(&[*b, *a])) {
        return None;
    }
    let way = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|k| Vec3::<f64>::from_vector(spheres[k as usize].center));
        b - a
    };
    all.sort_by(|a, b| {
        way(*b)
            .length_sq()
            .total_cmp(&way(*a).length_sq())
            .then(a.cmp(b))
    });
    let mut ends: Vec<[u32; 2]> = Vec::new();
    for edge in all {
        let e = way(edge);
        let is_along = |other: &[u32; 2]| {
            let other = way(*other);
            other.dot(e).abs() >= SAME_NORMAL * other.length() * e.length()
        };
        if !ends.iter().any(is_along) {
            ends.push(edge);
        }
    }
    Some(PieceEdges { ends, radius })
}

/// The face of the hull of spheres that looks along a unit normal, if it is one.
fn face(spheres: &[MedialSphere], normal: Vec3<f64>) -> Option<PieceFace> {
    let center = |s: &MedialSphere| Vec3::<f64>::from_vector(s.center);
    let height = |s: &MedialSphere| normal.dot(center(s)) + f64::from(s.radius);
    let size = (spheres.iter()).map(|s| f64::from(s.center.abs().max_element() + s.radius));
    let on = ON_FACE * size.fold(0.0, f64::max);
    let most = spheres.iter().map(height).fold(f64::MIN, f64::max);
    let [x, y]: [Vector; 2] = normal.to_vector().any_orthonormal_pair().into();
    let [x, y] = [x, y].map(Vec3::<f64>::from_vector);
    let at = |k: u32| {
        let c = center(&spheres[k as usize]);
        [x.dot(c), y.dot(c)]
    };
    let mut corners: Vec<u32> = (0..spheres.len() as u32)
        .filter(|k| height(&spheres[*k as usize]) >= most - on)
        .collect();
    corners.sort_by(|i, j| {
        let (p, q) = (at(*i), at(*j));
        p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1]))
    });
    let corners = convex_polygon(&corners, |k| at(*k));
    (corners.len() > 2).then(|| PieceFace {
        normal: normal.to_vector(),
        corners,
    })
}

/// The convex hull of points of a plane that are sorted by their first coordinate, counter-clockwise (monotone chain:
/// Andrew, "Another efficient algorithm for convex hulls in two dimensions", 1979).
fn convex_polygon<T: Copy>(sorted: &[T], at: impl Fn(&T) -> [f64; 2]) -> Vec<T> {
    let turns_left = |[a, b, c]: [&T; 3]| {
        let [a, b, c] = [at(a), at(b), at(c)];
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = &T>| {
        let mut chain: Vec<T> = Vec::new();
        for p in points {
            while let [.., a, b] = &chain[..]
                && !turns_left([a, b, p])
            {
                chain.pop();
            }
            chain.push(*p);
        }
        // The last one begins the other chain.
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter());
    hull.extend(chain(&mut sorted.iter().rev()));
    hull
}

/// The convex pieces of a mesh, by the nodes of its tree.
#[derive(Clone, Debug, Default)]
pub struct ConvexPieces {
    /// One more than the number of the piece that a node holds, neither more nor less; 0 for other nodes, and for
    /// pieces of one primitive.
    of_nodes: Vec<u32>,
    /// The node of the piece that each primitive is of, if there is one.
    nodes: Vec<Option<u32>>,
    pieces: Vec<ConvexPiece>,
}

impl ConvexPieces {
    /// The connected parts of a mesh all of whose connected parts are convex, and whose primitives have these
    /// thicknesses.
    pub(super) fn new(
        spheres: &[MedialSphere],
        primitives: &[Simplex],
        thicknesses: &[Real],
        tree: &SphereTree,
    ) -> Self {
        let groups = connected(spheres.len(), primitives);
        let mut group_of = vec![0; primitives.len()];
        for (g, group) in groups.iter().enumerate() {
            group.iter().for_each(|p| group_of[*p as usize] = g);
        }
        // The group that all below a node is of, if it is one, and how many primitives that is.
        let nodes = tree.nodes();
        let mut below: Vec<(Option<usize>, usize)> = vec![(None, 0); nodes.len()];
        let mut pieces = Self {
            of_nodes: vec![0; nodes.len()],
            nodes: vec![None; primitives.len()],
            pieces: Vec::new(),
        };
        // Children come after their parents.
        for (at, node) in nodes.iter().enumerate().rev() {
            below[at] = match node.kind() {
                NodeKind::Primitive(p) => (Some(group_of[p as usize]), 1),
                NodeKind::Nodes(i, j) => {
                    let (a, b) = (below[i as usize], below[j as usize]);
                    (a.0.filter(|_| a.0 == b.0), a.1 + b.1)
                }
            };
            let (Some(group), count) = below[at] else {
                continue;
            };
            let group = &groups[group];
            if count == group.len() && count > 1 {
                let piece = ConvexPiece::new(spheres, primitives, thicknesses, group);
                pieces.pieces.push(piece);
                pieces.of_nodes[at] = pieces.pieces.len() as u32;
                (group.iter()).for_each(|p| pieces.nodes[*p as usize] = Some(at as u32));
            }
        }
        pieces
    }

    /// The piece that a node holds; `None` where that is no piece of several primitives.
    pub fn of_node(&self, node: u32) -> Option<&ConvexPiece> {
        let piece = self.of_nodes.get(node as usize)?.checked_sub(1)?;
        self.pieces.get(piece as usize)
    }

    /// The node of the piece of several primitives that a primitive is of, if it is of one.
    pub fn node_of(&self, primitive: u32) -> Option<u32> {
        self.nodes.get(primitive as usize).copied().flatten()
    }

    /// All pieces of several primitives.
    pub fn iter(&self) -> impl Iterator<Item = &ConvexPiece> {
        self.pieces.iter()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }
}

/// The primitives of each connected part of a mesh of so many spheres: primitives that share a sphere are connected.
pub(super) fn connected(spheres: usize, primitives: &[Simplex]) -> Vec<Vec<u32>> {
    // The least sphere known to be connected with each.
    let mut least: Vec<u32> = (0..spheres as u32).collect();
    let root = |least: &mut Vec<u32>, mut v: u32| {
        while least[v as usize] != v {
            least[v as usize] = least[least[v as usize] as usize];
            v = least[v as usize];
        }
        v
    };
    for primitive in primitives {
        for v in primitive.vertices {
            let (a, b) = (root(&mut least, primitive.vertices[0]), root(&mut least, v));
            least[a.max(b) as usize] = a.min(b);
        }
    }
    let mut groups: Vec<Vec<u32>> = Vec::new();
    let mut group_of = vec![None; spheres];
    for (p, primitive) in primitives.iter().enumerate() {
        let root = root(&mut least, primitive.vertices[0]) as usize;
        let group = *group_of[root].get_or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(p as u32);
    }
    groups
}
