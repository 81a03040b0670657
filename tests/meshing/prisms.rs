//! Prisms over rings of random polygons, turned, scaled and moved, against the polygons themselves in `f64`: no point
//! farther outside than the error is in the solid, and none farther inside out of it.

use crate::meshes::*;
use crate::oracle::{Random, inside};
use crate::planted::uncovered;
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::meshing::Variant;
use rapier3d_medial::{BuildOptions, MedialMesh, Quality};
use std::f64::consts::TAU;

/// A ring between two polygons of as many corners, 0.3 high.
struct Ring {
    outer: Vec<[f64; 2]>,
    inner: Vec<[f64; 2]>,
}

const HEIGHT: f64 = 0.3;

impl Ring {
    /// Corners at even angles, at random radii that vary slowly.
    fn random(random: &mut Random) -> Self {
        const CORNERS: usize = 72;
        let lobes = random.within(2.0, 6.0).floor();
        let (depth, phase) = (random.within(0.0, 0.12), random.within(0.0, TAU));
        let bore = random.within(0.1, 0.25);
        let at = |k: usize, r: f64| {
            let (sin, cos) = (TAU * k as f64 / CORNERS as f64).sin_cos();
            // As the mesh has them.
            [r * cos, r * sin].map(|x| f64::from(x as f32))
        };
        let wave = |k: usize| 0.4 + depth * (lobes * TAU * k as f64 / CORNERS as f64 + phase).sin();
        Self {
            outer: (0..CORNERS).map(|k| at(k, wave(k))).collect(),
            inner: (0..CORNERS).map(|k| at(k, bore)).collect(),
        }
    }

    fn mesh(&self) -> Mesh {
        let n = self.outer.len() as u32;
        let mut vertices = Vec::new();
        for z in [0.0, HEIGHT] {
            let loops = self.outer.iter().chain(&self.inner);
            vertices.extend(loops.map(|p| Vector::new(p[0] as f32, p[1] as f32, z as f32)));
        }
        let mut indices = Vec::new();
        for i in 0..n {
            let j = (i + 1) % n;
            let quads = [
                [i, j, j + 2 * n, i + 2 * n],
                [j + n, i + n, i + 3 * n, j + 3 * n],
                [i, i + n, j + n, j],
                [i + 2 * n, j + 2 * n, j + 3 * n, i + 3 * n],
            ];
            for [a, b, c, d] in quads {
                indices.extend([[a, b, c], [a, c, d]]);
            }
        }
        Mesh { vertices, indices }
    }

    /// Signed distance to the prism, or a bound below its absolute value.
    fn height(&self, p: [f64; 3]) -> f64 {
        let flat = polygon(&self.outer, p).max(-polygon(&self.inner, p));
        flat.max(-p[2]).max(p[2] - HEIGHT)
    }
}

/// Signed distance to a polygon in the plane.
fn polygon(corners: &[[f64; 2]], p: [f64; 3]) -> f64 {
    let (mut least, mut holds) = (f64::INFINITY, false);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let (d, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let along = (to[0] * d[0] + to[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let along = along.clamp(0.0, 1.0);
        least = least.min((to[0] - along * d[0]).hypot(to[1] - along * d[1]));
        let crosses = (a[1] > p[1]) != (b[1] > p[1]);
        holds ^= crosses && to[0] < d[0] * to[1] / d[1];
    }
    if holds { -least } else { least }
}

#[test]
fn rings_of_polygons_become_prisms_of_fewer_edges() {
    let mut random = Random(41);
    let mut prisms = 0;
    for case in 0..5 {
        let ring = Ring::random(&mut random);
        let scale = [1.0, 1e-3, 1e3][case % 3];
        let axis = random.vector(1.0).normalize();
        let turn = Rotation::from_axis_angle(axis, random.within(0.0, 3.0) as f32);
        let mesh = ring.mesh().map(|v| turn * v * scale);
        let options = BuildOptions {
            primitives: Some(400),
            quality: Quality::Fast,
            ..Default::default()
        };
        let (medial, report) = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)
            .expect("a planted mesh builds");
        let error = f64::from(report.hausdorff.error() / report.longest_side);
        println!("{case}: {error} with {}", report.primitives);
        assert!(report.primitives <= 400 && error < 0.01, "{case}: {error}");
        prisms += usize::from(matches!(report.variant, Variant::Creased { .. }));
        let (points, out) = uncovered(&medial, &mesh, report.longest_side, 4e-6);
        assert!(out == 0 && points > 100, "{case}: {out} of {points}");
        let (mut decided, mut holds) = (0u32, 0u32);
        for _ in 0..4_000 {
            let p = [0.6, 0.6, 0.0].map(|half| random.within(-half, half));
            let p = [p[0], p[1], random.within(-0.1, 0.4)];
            let height = ring.height(p);
            if height.abs() <= 1.1 * error + 1e-5 {
                continue;
            }
            decided += 1;
            holds += u32::from(height < 0.0);
            let v = turn * Vector::new(p[0] as f32, p[1] as f32, p[2] as f32) * scale;
            let at = [v.x, v.y, v.z].map(f64::from);
            assert_eq!(inside(&medial, at), height < 0.0, "{case}: {p:?} {height}");
        }
        let share = f64::from(holds) / f64::from(decided);
        assert!((0.1..0.7).contains(&share), "{case}: {share} inside");
    }
    assert_eq!(prisms, 5);
}
