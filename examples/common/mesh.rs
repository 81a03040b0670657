//! Closed triangle meshes made in code.

use rapier3d::prelude::{Real, TriMesh, Vector};
use std::collections::HashMap;
use std::f32::consts::TAU;

/// A triangle mesh in its body's frame; triangles run counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions.
    pub vertices: Vec<Vector>,
    /// Corners of each triangle.
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [Vector; 3] {
        triangle.map(|i| self.vertices[i as usize])
    }

    /// Volume enclosed: positive when the triangles face outwards.
    pub fn volume(&self) -> Real {
        let six_fold = |&t: &[u32; 3]| {
            let [a, b, c] = self.corners(t);
            a.dot(b.cross(c))
        };
        self.indices.iter().map(six_fold).sum::<Real>() / 6.0
    }

    /// Refuses a mesh that is not one closed, consistently oriented manifold facing outwards: each
    /// directed edge must occur once, and so must its reverse; the triangles at a vertex must form
    /// one fan.
    pub fn check_closed(&self) -> Result<(), String> {
        let mut next_in_fan = HashMap::new();
        for &[a, b, c] in &self.indices {
            for [from, to, last] in [[a, b, c], [b, c, a], [c, a, b]] {
                if next_in_fan.insert([from, to], last).is_some() {
                    return Err(format!("two triangles run along the edge {from} → {to}"));
                }
            }
        }
        let mut valence = vec![0; self.vertices.len()];
        for &[from, to] in next_in_fan.keys() {
            valence[from as usize] += 1;
            if !next_in_fan.contains_key(&[to, from]) {
                return Err(format!("the edge {from} → {to} is open"));
            }
        }
        for &[center, first, _] in &self.indices {
            let mut fan = 1;
            let mut spoke = next_in_fan[&[center, first]];
            while spoke != first {
                spoke = next_in_fan[&[center, spoke]];
                fan += 1;
            }
            if fan != valence[center as usize] {
                return Err(format!("two sheets of triangles touch at vertex {center}"));
            }
        }
        match self.volume() {
            volume if volume > 0.0 => Ok(()),
            volume => Err(format!("the volume is {volume}, must be above 0")),
        }
    }

    /// Smooth unit normals at the vertices, each triangle weighted by its area.
    pub fn normals(&self) -> Vec<Vector> {
        let mut normals = vec![Vector::ZERO; self.vertices.len()];
        for &t in &self.indices {
            let [a, b, c] = self.corners(t);
            let normal = (b - a).cross(c - a);
            for i in t {
                normals[i as usize] += normal;
            }
        }
        normals.iter().map(|n| n.normalize_or_zero()).collect()
    }

    /// The mesh moved and scaled: centred at the origin, its longest side `size`.
    pub fn fitted(mut self, size: Real) -> Self {
        let (low, high) = self.bounds();
        let (center, side) = ((low + high) / 2.0, (high - low).max_element());
        for v in &mut self.vertices {
            *v = (*v - center) * (size / side);
        }
        self
    }

    /// Lowest and highest coordinates.
    pub fn bounds(&self) -> (Vector, Vector) {
        let start = (Vector::splat(Real::MAX), Vector::splat(Real::MIN));
        self.vertices
            .iter()
            .fold(start, |(low, high), v| (low.min(*v), high.max(*v)))
    }

    /// The mesh as parry's shape, for exact distances.
    pub fn to_parry(&self) -> TriMesh {
        TriMesh::new(self.vertices.clone(), self.indices.clone()).expect("a mesh with triangles")
    }
}

/// A ring round the y axis: `major` is the radius of its centre circle, `minor` that of its tube.
/// It has `2 · around · across` triangles.
pub fn ring(major: Real, minor: Real, around: u32, across: u32) -> Mesh {
    let point = |i: u32, j: u32| {
        let (along, round) = (
            TAU * i as Real / around as Real,
            TAU * j as Real / across as Real,
        );
        let reach = major + minor * round.cos();
        Vector::new(
            reach * along.cos(),
            minor * round.sin(),
            -reach * along.sin(),
        )
    };
    let vertices = (0..around * across)
        .map(|k| point(k / across, k % across))
        .collect();
    let index = |i: u32, j: u32| (i % around) * across + j % across;
    let indices = (0..around * across)
        .flat_map(|k| {
            let (i, j) = (k / across, k % across);
            let [a, b, c, d] = [
                index(i, j),
                index(i + 1, j),
                index(i + 1, j + 1),
                index(i, j + 1),
            ];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh { vertices, indices }
}

/// A ball about the origin, `around` quads round its axis and half as many from pole to pole.
pub fn ball(radius: Real, around: u32) -> Mesh {
    let rows = around / 2;
    let point = |k: u32| {
        let (row, column) = (k / around + 1, k % around);
        let (down, round) = (
            TAU / 2.0 * row as Real / rows as Real,
            TAU * column as Real / around as Real,
        );
        let out = down.sin();
        Vector::new(out * round.cos(), down.cos(), -out * round.sin()) * radius
    };
    let inner = (rows - 1) * around;
    let mut vertices: Vec<Vector> = (0..inner).map(point).collect();
    vertices.extend([Vector::Y * radius, Vector::NEG_Y * radius]);
    let next = |k: u32| k / around * around + (k + 1) % around;
    let caps = (0..around).flat_map(|k| {
        let last = inner - around + k;
        [[inner, k, next(k)], [inner + 1, next(last), last]]
    });
    let sides = (0..inner - around).flat_map(|k| {
        let below = k + around;
        [[k, below, next(below)], [k, next(below), next(k)]]
    });
    let indices = caps.chain(sides).collect();
    Mesh { vertices, indices }
}
