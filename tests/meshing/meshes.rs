//! Triangle meshes of known shape, and the signed distances of the shapes.

use parry3d::math::Vector;
use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

#[derive(Clone)]
pub struct Mesh {
    pub vertices: Vec<Vector>,
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    pub fn map(mut self, f: impl Fn(Vector) -> Vector) -> Self {
        self.vertices.iter_mut().for_each(|v| *v = f(*v));
        self
    }

    pub fn and(mut self, other: Self) -> Self {
        let first = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        let moved = other.indices.iter().map(|t| t.map(|v| v + first));
        self.indices.extend(moved);
        self
    }

    pub fn inside_out(mut self) -> Self {
        self.indices.iter_mut().for_each(|t| t.swap(0, 1));
        self
    }

    pub fn longest_side(&self) -> f32 {
        let (lo, hi) = self.vertices.iter().fold(
            (Vector::splat(f32::MAX), Vector::splat(f32::MIN)),
            |(lo, hi), v| (lo.min(*v), hi.max(*v)),
        );
        (hi - lo).max_element()
    }

    /// Points of every triangle, about `spacing` apart, corners and edges among them.
    pub fn dense_points(&self, spacing: f32) -> Vec<Vector> {
        let mut points = Vec::new();
        for t in &self.indices {
            let [a, b, c] = t.map(|v| self.vertices[v as usize]);
            let longest = (b - a).length().max((c - a).length()).max((c - b).length());
            let n = (longest / spacing).ceil().max(1.0) as u32;
            for i in 0..=n {
                for j in 0..=n - i {
                    let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
                    points.push(a + (b - a) * u + (c - a) * v);
                }
            }
        }
        points
    }
}

/// Ring about the z axis: centre line of radius `big`, tube of radius `small`.
pub fn torus(big: f32, small: f32, around: u32, across: u32) -> Mesh {
    let mut vertices = Vec::new();
    let mut indices = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (
                i as f32 / around as f32 * TAU,
                j as f32 / across as f32 * TAU,
            );
            let from_axis = big + small * v.cos();
            vertices.push(Vector::new(
                from_axis * u.cos(),
                from_axis * u.sin(),
                small * v.sin(),
            ));
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh { vertices, indices }
}

pub fn torus_distance(p: Vector, big: f32, small: f32) -> f32 {
    (p.x.hypot(p.y) - big).hypot(p.z) - small
}

/// Balls of radius `radius` swept from (0, 0, −half) to (0, 0, half); a ball for `half` = 0.
pub fn capsule(half: f32, radius: f32, around: u32, rings: u32) -> Mesh {
    let mut vertices = Vec::new();
    // Rings of latitude from pole to pole; the middle one is doubled by the cylinder.
    for k in 0..=2 * rings + 1 {
        let lower = k <= rings;
        let step = if lower { k } else { k - 1 };
        let latitude = -0.5 * PI + PI * step as f32 / (2 * rings) as f32;
        let z = radius * latitude.sin() + if lower { -half } else { half };
        for i in 0..around {
            let u = i as f32 / around as f32 * TAU;
            let from_axis = radius * latitude.cos();
            vertices.push(Vector::new(from_axis * u.cos(), from_axis * u.sin(), z));
        }
    }
    let mut indices = Vec::new();
    for k in 0..2 * rings + 1 {
        for i in 0..around {
            let at = |k: u32, i: u32| k * around + i % around;
            let (a, b, c, d) = (at(k, i), at(k, i + 1), at(k + 1, i + 1), at(k + 1, i));
            indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh { vertices, indices }
}

/// Box from the origin to `size`, two triangles a side.
pub fn cuboid(size: Vector) -> Mesh {
    prism(
        &[(0.0, 0.0), (size.x, 0.0), (size.x, size.y), (0.0, size.y)],
        size.z,
        &[[0, 1, 2], [0, 2, 3]],
    )
}

/// An L of two bars of width 0.3 and length 1, 0.3 high.
pub fn l_shape() -> Mesh {
    let outline = [
        (0.0, 0.0),
        (1.0, 0.0),
        (1.0, 0.3),
        (0.3, 0.3),
        (0.3, 1.0),
        (0.0, 1.0),
    ];
    prism(&outline, 0.3, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
}

/// An outline (counterclockwise) from z = 0 to `height`; `cap` are its triangles.
pub fn prism(outline: &[(f32, f32)], height: f32, cap: &[[u32; 3]]) -> Mesh {
    let n = outline.len() as u32;
    let at = |z: f32| outline.iter().map(move |&(x, y)| Vector::new(x, y, z));
    let mut indices = Vec::new();
    for &[a, b, c] in cap {
        indices.extend([[a, c, b], [a + n, b + n, c + n]]);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        indices.extend([[i, j, j + n], [i, j + n, i + n]]);
    }
    Mesh {
        vertices: at(0.0).chain(at(height)).collect(),
        indices,
    }
}

/// Splits each triangle into four, `times` over.
pub fn refine(mut mesh: Mesh, times: u32) -> Mesh {
    for _ in 0..times {
        let mut middles = HashMap::new();
        let mut indices = Vec::new();
        for &[a, b, c] in &mesh.indices {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(u, v)| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let middle = (mesh.vertices[u as usize] + mesh.vertices[v as usize]) * 0.5;
                    mesh.vertices.push(middle);
                    mesh.vertices.len() as u32 - 1
                })
            });
            indices.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        mesh.indices = indices;
    }
    mesh
}
