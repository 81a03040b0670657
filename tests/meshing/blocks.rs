//! Bodies of flat faces that are not convex: random sets of boxes on uneven grids, turned, scaled and moved, and prisms
//! over polygons. Inside and outside are known in `f64` from the grid or the polygon, not from the triangles.

use crate::meshes::*;
use crate::oracle::Random;
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::meshing::Variant;
use rapier3d_medial::{BuildOptions, MedialMesh, Quality};
use std::collections::{HashMap, HashSet};

/// How far such a medial mesh may be off (longest side 1): rounding of the triangle mesh, which is enlarged by it.
const EXACT: f32 = 1.2e-5;

/// Cells of an uneven grid.
pub struct Grid {
    pub lines: [Vec<f64>; 3],
    cells: HashSet<[usize; 3]>,
}

impl Grid {
    /// A grid of `size` cells with random lines, of which a connected set is solid.
    pub fn random(random: &mut Random, size: [usize; 3]) -> Self {
        let mut line = |n: usize| {
            let mut at = 0.0;
            let mut next = || {
                at += 0.1 + random.within(0.0, 1.0);
                at
            };
            (0..=n).map(|_| next()).collect::<Vec<_>>()
        };
        let lines = size.map(&mut line);
        let mut grid = Self {
            lines,
            cells: HashSet::from([[0; 3]]),
        };
        let wanted = size.iter().product::<usize>() * 3 / 5;
        for _ in 0..1_000 {
            if grid.cells.len() >= wanted {
                break;
            }
            let cell = size.map(|n| (random.within(0.0, n as f64) as usize).min(n - 1));
            let near = |other: &[usize; 3]| {
                let ways = (0..3).map(|k| cell[k].abs_diff(other[k]));
                ways.sum::<usize>() == 1
            };
            if !grid.cells.iter().any(near) || !grid.cells.insert(cell) {
                continue;
            }
            if !grid.is_manifold() {
                grid.cells.remove(&cell);
            }
        }
        grid
    }

    /// Its boundary's rectangles as corners on the grid, outward.
    fn sides(&self) -> Vec<[[usize; 3]; 4]> {
        let mut sides = Vec::new();
        for cell in &self.cells {
            for axis in 0..3 {
                for up in [false, true] {
                    let mut beyond = cell.map(|c| c as isize);
                    beyond[axis] += if up { 1 } else { -1 };
                    if self.cells.contains(&beyond.map(|c| c as usize)) {
                        continue;
                    }
                    let corner = |du: usize, dv: usize| {
                        let mut p = *cell;
                        p[axis] += usize::from(up);
                        p[(axis + 1) % 3] += du;
                        p[(axis + 2) % 3] += dv;
                        p
                    };
                    let mut side = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    if !up {
                        side.reverse();
                    }
                    sides.push(side);
                }
            }
        }
        sides.sort_unstable();
        sides
    }

    /// Whether each edge of the boundary is of two rectangles, and those about each corner join.
    fn is_manifold(&self) -> bool {
        let sides = self.sides();
        let mut edges: HashMap<[[usize; 3]; 2], usize> = HashMap::new();
        for side in &sides {
            for k in 0..4 {
                let mut edge = [side[k], side[(k + 1) % 4]];
                edge.sort_unstable();
                *edges.entry(edge).or_default() += 1;
            }
        }
        let corners: HashSet<_> = sides.iter().flatten().collect();
        let joined = corners.iter().all(|corner| {
            let mut about: Vec<_> = sides.iter().filter(|s| s.contains(corner)).collect();
            let mut fan = vec![about.pop().expect("a side")];
            while let Some(at) = about.iter().position(|s| {
                let shared = |t: &&[[usize; 3]; 4]| s.iter().filter(|p| t.contains(p)).count() == 2;
                fan.iter().any(shared)
            }) {
                fan.push(about.remove(at));
            }
            about.is_empty()
        });
        joined && edges.values().all(|n| *n == 2)
    }

    fn point(&self, at: [usize; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.lines[k][at[k]])
    }

    pub fn holds(&self, p: [f64; 3]) -> bool {
        let cell = [0, 1, 2].map(|k| {
            self.lines[k]
                .partition_point(|x| *x <= p[k])
                .wrapping_sub(1)
        });
        self.cells.contains(&cell)
    }

    /// Distance of a point to the boundary.
    pub fn distance(&self, p: [f64; 3]) -> f64 {
        let to_side = |side: &[[usize; 3]; 4]| {
            let corners = side.map(|c| self.point(c));
            let off = [0, 1, 2].map(|k| {
                let all = corners.iter().map(|c| c[k]);
                let (lo, hi) = all.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
                p[k] - p[k].clamp(lo, hi)
            });
            off.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        self.sides().iter().map(to_side).fold(f64::MAX, f64::min)
    }

    pub fn mesh(&self, place: impl Fn([f64; 3]) -> Vector) -> Mesh {
        let mut index: HashMap<[usize; 3], u32> = HashMap::new();
        let mut mesh = Mesh {
            vertices: Vec::new(),
            indices: Vec::new(),
        };
        for side in self.sides() {
            let [a, b, c, d] = side.map(|corner| {
                *index.entry(corner).or_insert_with(|| {
                    mesh.vertices.push(place(self.point(corner)));
                    mesh.vertices.len() as u32 - 1
                })
            });
            mesh.indices.extend([[a, b, c], [a, c, d]]);
        }
        mesh
    }
}

/// A turn, a scale and a move of bodies.
pub struct Placed {
    pub rotation: Rotation,
    pub scale: f64,
    pub offset: Vector,
}

impl Placed {
    pub fn random(random: &mut Random, straight: bool) -> Self {
        let turn = random.vector(3.0);
        let scale = 10.0f64.powf(random.within(-3.0, 3.0));
        Self {
            rotation: Rotation::from_scaled_axis(if straight { Vector::ZERO } else { turn }),
            scale,
            offset: random.vector(scale),
        }
    }

    pub fn at(&self, p: [f64; 3]) -> Vector {
        let p = p.map(|x| (x * self.scale) as f32);
        self.rotation * Vector::new(p[0], p[1], p[2]) + self.offset
    }
}

pub fn built(mesh: &Mesh, quality: Quality) -> (MedialMesh, rapier3d_medial::BuildReport) {
    let options = BuildOptions {
        quality,
        ..Default::default()
    };
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("a block")
}

/// A frame of four bars with fewer primitives than it takes to be exact: the report says how many.
#[test]
fn with_too_few_primitives_the_exact_number_is_told() {
    let lines = [
        &[0.0, 1.0, 5.0, 6.0][..],
        &[0.0, 1.0, 5.0, 6.0],
        &[0.0, 1.0],
    ];
    let ring = (0..9).filter(|k| *k != 4).map(|k| [k / 3, k % 3, 0]);
    let grid = Grid {
        lines: lines.map(<[f64]>::to_vec),
        cells: ring.collect(),
    };
    let mesh = grid.mesh(|p| p.map(|x| x as f32).into());
    let with = |primitives: usize| {
        let options = BuildOptions {
            primitives: Some(primitives),
            quality: Quality::Fast,
            ..Default::default()
        };
        let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
        built.expect("a frame").1
    };
    let few = with(40);
    let count = few.exact_with.expect("a number");
    assert!(
        few.primitives <= 40 && few.variant != Variant::Exact,
        "{few:?}"
    );
    let note = format!("with {count} primitives it would be exact");
    assert!(few.notes.iter().any(|n| n.starts_with(&note)), "{few:?}");
    let enough = with(count);
    assert_eq!((enough.variant, enough.exact_with), (Variant::Exact, None));
    assert_eq!(with(count - 1).exact_with, Some(count));
}

/// Sets of boxes are exact, however they lie: what sticks out, what is left out and the holes are known from the grid.
#[test]
fn blocks_of_boxes_are_exact() {
    let mut random = Random(41);
    let mut primitives = Vec::new();
    for k in 0..14 {
        let size = [[3, 3, 1], [3, 2, 2], [3, 3, 2], [4, 3, 2]][k % 4];
        let grid = Grid::random(&mut random, size);
        let placed = Placed::random(&mut random, k % 3 == 0);
        let mesh = grid.mesh(|p| placed.at(p));
        let side = mesh.longest_side();
        let (medial, report) = built(&mesh, [Quality::Fast, Quality::Balanced][k % 2]);
        assert_eq!(report.variant, Variant::Exact, "block {k}: {report:?}");
        assert!(
            report.hausdorff.error() <= EXACT * side,
            "block {k}: {report:?}"
        );
        primitives.push(report.primitives);
        let [lo, hi] = [0, usize::MAX].map(|end| {
            [0, 1, 2].map(|k| {
                let line = &grid.lines[k];
                line[end.min(line.len() - 1)]
            })
        });
        let mut judged = 0;
        for _ in 0..3_000 {
            let p = [0, 1, 2].map(|k| {
                let part = 1.2 * random.within(0.0, 1.0) - 0.1;
                lo[k] + (hi[k] - lo[k]) * part
            });
            let rounding = f64::from(2.0 * EXACT * side) / placed.scale;
            if grid.distance(p) < rounding {
                continue;
            }
            judged += 1;
            let inside = crate::solid_distance(&medial, placed.at(p)) < 0.0;
            assert_eq!(inside, grid.holds(p), "block {k} at {p:?}");
        }
        assert!(judged > 2_900, "{judged}");
        for corner in &mesh.vertices {
            assert!(
                crate::solid_distance(&medial, *corner) <= 1.0e-6 * side,
                "block {k}"
            );
        }
    }
    println!("primitives {primitives:?}");
    assert!(primitives.iter().all(|n| (20..=500).contains(n)));
}

/// A prism over a polygon with corners at these angles (in parts of a turn) and distances.
fn star(points: usize, inner: f64) -> Mesh {
    let outline: Vec<[f64; 2]> = (0..2 * points)
        .map(|k| {
            let angle = k as f64 * std::f64::consts::PI / points as f64;
            let r = if k % 2 == 0 { 1.0 } else { inner };
            [r * angle.cos(), r * angle.sin()]
        })
        .collect();
    let n = outline.len() as u32;
    let layer = |z: f64| {
        outline
            .iter()
            .map(move |p| Vector::new(p[0] as f32, p[1] as f32, z as f32))
    };
    let middle = [0.0, 0.4].map(|z| Vector::new(0.0, 0.0, z));
    let vertices = layer(0.0).chain(layer(0.4)).chain(middle).collect();
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [
            [k, next, next + n],
            [k, next + n, k + n],
            [next, k, 2 * n],
            [k + n, next + n, 2 * n + 1],
        ]
    });
    Mesh {
        indices: sides.collect(),
        vertices,
    }
}

/// Stars are exact in the notches between their tips.
#[test]
fn stars_are_exact() {
    for (points, inner) in [(4, 0.4), (5, 0.45), (6, 0.6), (8, 0.6)] {
        let mesh = star(points, inner);
        let (medial, report) = built(&mesh, Quality::Balanced);
        assert_eq!(
            report.variant,
            Variant::Exact,
            "{points} points: {report:?}"
        );
        assert!(report.hausdorff.error() <= EXACT * mesh.longest_side());
        // In the middle of a notch, just outside and just inside.
        let angle = std::f32::consts::PI / points as f32;
        let along = Vector::new(angle.cos(), angle.sin(), 0.0);
        for (r, inside) in [
            (inner as f32 + 1.0e-4, false),
            (inner as f32 - 1.0e-4, true),
        ] {
            let p = along * r + Vector::Z * 0.2;
            assert_eq!(
                crate::solid_distance(&medial, p) < 0.0,
                inside,
                "{points} points"
            );
        }
    }
}

/// What is not exact within the count is built as before, and what is round is.
#[test]
fn too_few_primitives_are_no_error() {
    let mesh = star(5, 0.45);
    let options = BuildOptions {
        primitives: Some(30),
        quality: Quality::Fast,
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    let (medial, report) = built.expect("a star");
    assert!(medial.primitive_count() <= 30);
    assert_ne!(report.variant, Variant::Exact);
}

/// A triangle without area that sticks out of a block by a few millionths of its size is covered too.
#[test]
fn triangles_that_stick_out_of_a_block_are_covered() {
    let mut mesh = star(4, 0.4);
    let tip = Vector::new(1.0, 0.0, 0.2);
    let first = mesh.vertices.len() as u32;
    let along = [Vector::X * -0.1, Vector::ZERO, Vector::X * 1.4e-5];
    mesh.vertices.extend(along.map(|way| tip + way));
    mesh.indices.push([0, 1, 2].map(|k| first + k));
    let (medial, report) = built(&mesh, Quality::Fast);
    assert_eq!(report.hausdorff.uncovered, 0.0, "{report:?}");
    let out = crate::solid_distance(&medial, tip + along[2]);
    assert!(out <= 1.0e-6, "{out}");
}
