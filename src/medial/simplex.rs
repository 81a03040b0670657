//! The primitives of a medial mesh as indices of spheres, and which of them tests a shared edge or sphere.

use super::primitive::MedialPrimitive;
use super::sphere::MedialSphere;
use std::collections::HashSet;

/// A primitive as indices of its spheres, and the edges and spheres that it tests for its neighbours too.
///
/// An edge or sphere that several primitives share is owned by the first of them, so that a query that visits all
/// primitives tests it once.
#[derive(Clone, Copy, Debug)]
pub struct Simplex {
    /// Indices of its spheres; those beyond [`Self::len`] repeat the last one.
    pub vertices: [u32; 3],
    /// Number of spheres: 1, 2 or 3.
    pub len: u8,
    /// Bit `i` is set if it owns sphere `vertices[i]`.
    pub owns_vertex: u8,
    /// Bit `i` is set if it owns the edge from `vertices[i]` to `vertices[(i + 1) % 3]`.
    pub owns_edge: u8,
}

/// An edge, smaller index first.
pub fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The edges of a triangle, each smaller index first: from its first corner to the second, the second to the third, the
/// third to the first.
pub fn sides(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(sorted)
}

/// Slabs in the order of the faces, then the cones of no slab, then the spheres of neither.
pub fn primitives_of(spheres: usize, edges: &[[u32; 2]], faces: &[[u32; 3]]) -> Vec<Simplex> {
    let mut edge_taken = HashSet::new();
    let mut vertex_taken = vec![false; spheres];
    let mut own_vertex = |v: u32, bit: u8| {
        let first = !std::mem::replace(&mut vertex_taken[v as usize], true);
        u8::from(first) << bit
    };
    let mut primitives = Vec::with_capacity(faces.len());
    for &vertices in faces {
        let [a, b, c] = vertices;
        let mut owns_edge = 0;
        for (bit, e) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
            owns_edge |= u8::from(edge_taken.insert(sorted(e))) << bit;
        }
        let owns_vertex = own_vertex(a, 0) | own_vertex(b, 1) | own_vertex(c, 2);
        primitives.push(Simplex {
            vertices,
            len: 3,
            owns_vertex,
            owns_edge,
        });
    }
    for &[a, b] in edges {
        if edge_taken.insert([a, b]) {
            primitives.push(Simplex {
                vertices: [a, b, b],
                len: 2,
                owns_vertex: own_vertex(a, 0) | own_vertex(b, 1),
                owns_edge: 1,
            });
        }
    }
    for v in 0..spheres as u32 {
        let owns_vertex = own_vertex(v, 0);
        if owns_vertex != 0 {
            primitives.push(Simplex {
                vertices: [v; 3],
                len: 1,
                owns_vertex,
                owns_edge: 1,
            });
        }
    }
    primitives
}

/// The volume of a simplex.
pub fn primitive_of(spheres: &[MedialSphere], p: &Simplex) -> MedialPrimitive {
    let [a, b, c] = p.vertices.map(|v| spheres[v as usize]);
    match p.len {
        1 => MedialPrimitive::Sphere(a),
        2 => MedialPrimitive::Cone([a, b]),
        _ => MedialPrimitive::Slab([a, b, c]),
    }
}
