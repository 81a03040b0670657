//! Prisms over rings of random polygons and gears, turned, scaled and moved, against the polygons themselves in `f64`:
//! no point farther outside than the error is in the solid, and none farther inside out of it.

use crate::meshes::*;
use crate::oracle::{Random, inside};
use crate::planted::uncovered;
use parry3d::math::{Rotation, Vector};
use rapier3d_medial::meshing::Variant;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality};
use std::f64::consts::TAU;

/// A ring between two polygons of as many corners, 0.3 high.
struct Ring {
    outer: Vec<[f64; 2]>,
    inner: Vec<[f64; 2]>,
}

const HEIGHT: f64 = 0.3;

const SCALES: [f32; 3] = [1.0, 1e-3, 1e3];

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

    /// A gear of involute teeth, in as many pieces a flank.
    fn gear(teeth: usize, pieces: usize, bore: f64) -> Self {
        // Sizes for a pitch radius of 1, and those of the prism.
        const SIZE: f64 = 0.4;
        let module = 2.0 / teeth as f64;
        let pressure = 20f64.to_radians();
        let base = pressure.cos();
        let involute = |angle: f64| angle.tan() - angle;
        let (top, root) = (1.0 + module, 1.0 - 1.25 * module);
        let half_angle = |radius: f64| {
            let angle = (base / radius.max(base)).acos();
            let foot = 0.3 * (base - radius).max(0.0);
            TAU / (4.0 * teeth as f64) + involute(pressure) - involute(angle) + foot
        };
        let at = |radius: f64, angle: f64| {
            [radius * angle.cos(), radius * angle.sin()].map(|x| f64::from((SIZE * x) as f32))
        };
        let mut outer = Vec::new();
        for tooth in 0..teeth {
            let middle = TAU * tooth as f64 / teeth as f64;
            let radius = |k: usize| root + (top - root) * k as f64 / pieces as f64;
            let flank = (0..=pieces).map(radius);
            outer.extend(flank.clone().map(|r| at(r, middle - half_angle(r))));
            outer.extend(flank.rev().map(|r| at(r, middle + half_angle(r))));
        }
        let points = 2 * (pieces + 1);
        let around = |k: usize| {
            let middle = TAU * (k / points) as f64 / teeth as f64;
            let along = (k % points) as f64 / (points - 1) as f64;
            at(bore, middle + (2.0 * along - 1.0) * half_angle(root))
        };
        Self {
            inner: (0..outer.len()).map(around).collect(),
            outer,
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

/// Builds a ring turned at random, with vertices `off` along each axis at most, and judges points around it; its error
/// over its longest side.
fn judged(
    ring: &Ring,
    off: f64,
    scale: f32,
    options: &BuildOptions,
    random: &mut Random,
) -> (f64, BuildReport) {
    let axis = random.vector(1.0).normalize();
    let turn = Rotation::from_axis_angle(axis, random.within(0.0, 3.0) as f32);
    let mut mesh = ring.mesh();
    let mut noise = Random(7);
    for v in &mut mesh.vertices {
        *v = turn * (*v + noise.vector(off)) * scale;
    }
    let (medial, report) = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, options)
        .expect("a planted mesh builds");
    let error = f64::from(report.hausdorff.error() / report.longest_side);
    let longest = f64::from(report.longest_side / scale);
    println!("{error} with {}: {:?}", report.primitives, report.notes);
    let (points, out) = uncovered(&medial, &mesh, report.longest_side, 4e-6);
    assert!(out == 0 && points > 100, "{out} of {points}");
    let (mut decided, mut holds) = (0u32, 0u32);
    for _ in 0..4_000 {
        let p = [0.6, 0.6, 0.0].map(|half| random.within(-half, half));
        let p = [p[0], p[1], random.within(-0.1, 0.4)];
        let height = ring.height(p);
        if height.abs() <= 1.1 * error * longest + 1e-5 + 2.0 * off {
            continue;
        }
        decided += 1;
        holds += u32::from(height < 0.0);
        let v = turn * Vector::new(p[0] as f32, p[1] as f32, p[2] as f32) * scale;
        let at = [v.x, v.y, v.z].map(f64::from);
        assert_eq!(inside(&medial, at), height < 0.0, "{p:?} {height}");
    }
    let share = f64::from(holds) / f64::from(decided);
    assert!((0.1..0.7).contains(&share), "{share} inside");
    (error, report)
}

fn fast(primitives: Option<usize>, max_error: Option<f32>) -> BuildOptions {
    BuildOptions {
        primitives,
        max_error,
        quality: Quality::Fast,
        ..Default::default()
    }
}

#[test]
fn rings_of_polygons_become_prisms_of_fewer_edges() {
    let mut random = Random(41);
    for case in 0..5 {
        let ring = Ring::random(&mut random);
        let (error, report) = judged(
            &ring,
            0.0,
            SCALES[case % 3],
            &fast(Some(400), None),
            &mut random,
        );
        assert!(report.primitives <= 400 && error < 0.01, "{case}: {error}");
        assert!(matches!(report.variant, Variant::Creased { .. }), "{case}");
    }
}

/// Vertices of files of four decimals: no cap is flat, and no wall quite along the axis.
#[test]
fn rings_with_uneven_vertices_become_prisms() {
    let mut random = Random(53);
    for off in [2e-5, 5e-5] {
        let ring = Ring::random(&mut random);
        let (error, report) = judged(&ring, off, 1.0, &fast(Some(400), None), &mut random);
        assert!(report.primitives <= 400 && error < 0.01, "{off}: {error}");
        assert!(
            report.notes.iter().any(|note| note.contains("a prism")),
            "{off}"
        );
    }
}

/// Teeth are ribs of the prism: 16 slabs each where these are exact, 2 or 4 as plates with round rims.
#[test]
fn gears_keep_all_their_teeth() {
    let mut random = Random(43);
    let gears = [(20, 500, 0.013), (20, 200, 0.025), (12, 300, 0.02)];
    for (case, (teeth, primitives, most)) in gears.into_iter().enumerate() {
        let pieces = 2 + (random.bits() % 6) as usize;
        let ring = Ring::gear(teeth, pieces, random.within(0.2, 0.4));
        let (error, report) = judged(
            &ring,
            0.0,
            SCALES[case % 3],
            &fast(Some(primitives), None),
            &mut random,
        );
        assert!(
            report.primitives <= primitives && error < most,
            "{teeth}: {error}"
        );
        assert!(
            report.notes.iter().any(|note| note.contains("ribs")),
            "{teeth}"
        );
    }
}

#[test]
fn an_error_alone_gives_the_smallest_prism_that_keeps_it() {
    let mut random = Random(47);
    for case in 0..2 {
        let ring = Ring::random(&mut random);
        let (error, report) = judged(
            &ring,
            0.0,
            SCALES[case % 3],
            &fast(None, Some(0.002)),
            &mut random,
        );
        assert!(report.target_reached && error <= 0.002, "{case}: {error}");
        assert!(
            report.notes.iter().any(|note| note.contains("a prism")),
            "{case}"
        );
        let fewer = fast(Some(report.primitives * 3 / 4), None);
        let (error, _) = judged(&ring, 0.0, SCALES[case % 3], &fewer, &mut random);
        assert!(error > 0.002, "{case}: {error} with fewer");
    }
}
