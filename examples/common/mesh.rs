//! Closed triangle meshes made in code.

use rapier3d::prelude::{Real, Rotation, TriMesh, Vector};
use rapier3d_medial::meshing::mesh_file;
use std::collections::HashMap;
use std::f32::consts::TAU;
use std::path::Path;

/// A triangle mesh in its body's frame; triangles run counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions.
    pub vertices: Vec<Vector>,
    /// Corners of each triangle.
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// Reads a file: OBJ, STL, PLY or OFF.
    pub fn read(file: &Path) -> Result<Self, String> {
        let read = mesh_file::read(file).map_err(|e| e.to_string())?;
        Ok(Self {
            vertices: read.vertices,
            indices: read.indices,
        })
    }

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

    /// The mesh without the vertices that no triangle uses, which would be part of its hull.
    pub fn without_unused(self) -> Self {
        let mut used = Self::default();
        let mut places = vec![None; self.vertices.len()];
        for triangle in self.indices {
            used.indices.push(triangle.map(|v| {
                *places[v as usize].get_or_insert_with(|| {
                    used.vertices.push(self.vertices[v as usize]);
                    used.vertices.len() as u32 - 1
                })
            }));
        }
        used
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
    wound(around, across, point)
}

/// A wire round a closed planar line in y = 0 that runs clockwise seen from above, `across` corners
/// to each of its cuts. The line must not bend tighter than the wire's radius.
pub fn tube(line: &[Vector], radius: Real, across: u32) -> Mesh {
    let count = line.len();
    let point = |i: u32, j: u32| {
        let i = i as usize;
        let along = line[(i + 1) % count] - line[(i + count - 1) % count];
        let out = along.cross(Vector::Y).normalize();
        let (sin, cos) = (TAU * j as Real / across as Real).sin_cos();
        line[i] + (out * cos + Vector::Y * sin) * radius
    };
    wound(count as u32, across, point)
}

/// A wire round any closed line. The cuts are turned along by the smallest rotation from each to the
/// next, and what is missing to a whole turn is spread over all.
pub fn tube_in_space(line: &[Vector], radius: Real, across: u32) -> Mesh {
    let count = line.len();
    let along = |i: usize| (line[(i + 1) % count] - line[(i + count - 1) % count]).normalize();
    let mut out = vec![along(0).any_orthonormal_pair().0];
    for i in 0..count {
        let turn = Rotation::from_rotation_arc(along(i), along((i + 1) % count));
        out.push(turn * out[i]);
    }
    let (end, sideways) = (out[count], along(0).cross(out[0]));
    let missing = -end.dot(sideways).atan2(end.dot(out[0]));
    let point = |i: u32, j: u32| {
        let (i, share) = (i as usize, i as Real / count as Real);
        let angle = missing * share - TAU * j as Real / across as Real;
        let (sin, cos) = angle.sin_cos();
        line[i] + (out[i] * cos + along(i).cross(out[i]) * sin) * radius
    };
    wound(count as u32, across, point)
}

/// A trefoil knot.
pub fn knot() -> Mesh {
    let line = (0..150).map(|k| {
        let t = TAU * k as Real / 150.0;
        Vector::new(
            t.sin() + 2.0 * (2.0 * t).sin(),
            t.cos() - 2.0 * (2.0 * t).cos(),
            -(3.0 * t).sin(),
        )
    });
    tube_in_space(&line.collect::<Vec<_>>(), 0.42, 14)
}

/// A closed grid of `around` by `across` quads, two triangles each.
fn wound(around: u32, across: u32, point: impl Fn(u32, u32) -> Vector) -> Mesh {
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

/// All points within `radius` of the segment from −`half` to `half` on the y axis.
pub fn capsule(half: Real, radius: Real, around: u32) -> Mesh {
    let mut mesh = ball(radius, around);
    for v in &mut mesh.vertices {
        v.y += if v.y > -1.0e-3 * radius { half } else { -half };
    }
    mesh
}
