//! Sharp edges: convex polyhedra, whose medial axis is known to be exact, against their own faces.

use crate::meshes::*;
use crate::oracle::{Random, inside};
use parry3d::math::Vector;
use rapier3d_medial::meshing::Creases;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality};

/// How far the solid's boundary may be from a polyhedron's faces (longest side 1): a millionth, and what the
/// polyhedron's own vertices are off by as `f32`.
const EXACT: f64 = 1.2e-6;

fn built(mesh: &Mesh, options: BuildOptions) -> (MedialMesh, BuildReport) {
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)
        .expect("a planted mesh builds")
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// The intersection of half spaces `n·p ≤ d`, by trying all triples of planes.
pub fn convex(planes: &[([f64; 3], f64)]) -> Mesh {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes[..i].iter().enumerate() {
            for c in &planes[..j] {
                let (bc, ca, ab) = (cross(b.0, c.0), cross(c.0, a.0), cross(a.0, b.0));
                let det = dot(a.0, bc);
                let p = [0, 1, 2].map(|k| (a.1 * bc[k] + b.1 * ca[k] + c.1 * ab[k]) / det);
                let is_in = planes.iter().all(|(n, d)| dot(*n, p) < d + 1e-9);
                let near = |q: &[f64; 3]| (0..3).all(|k| (p[k] - q[k]).abs() < 1e-9);
                if det.abs() > 1e-9 && is_in && !points.iter().any(near) {
                    points.push(p);
                }
            }
        }
    }
    let mut indices = Vec::new();
    for (n, d) in planes {
        let on = |i: &u32| (dot(*n, points[*i as usize]) - d).abs() < 1e-8;
        let mut face: Vec<u32> = (0..points.len() as u32).filter(on).collect();
        let Some(&first) = face.first() else { continue };
        // About the face's middle, counterclockwise seen from outside.
        let mut middle = [0.0; 3];
        for &i in &face {
            (0..3).for_each(|k| middle[k] += points[i as usize][k] / face.len() as f64);
        }
        let from = |i: u32| [0, 1, 2].map(|k| points[i as usize][k] - middle[k]);
        let x = from(first);
        let y = cross(*n, x);
        let angle = |i: u32| dot(y, from(i)).atan2(dot(x, from(i)));
        face.sort_by(|&i, &j| angle(i).total_cmp(&angle(j)));
        indices.extend((1..face.len() - 1).map(|k| [face[0], face[k], face[k + 1]]));
    }
    let vertex = |p: &[f64; 3]| Vector::new(p[0] as f32, p[1] as f32, p[2] as f32);
    Mesh {
        vertices: points.iter().map(vertex).collect(),
        indices,
    }
}

/// Just outside each face is outside the solid, and just inside is inside.
fn assert_within(mesh: &Mesh, medial: &MedialMesh, error: f64, seed: u64) {
    let mut random = Random(seed);
    let step = error * f64::from(mesh.longest_side());
    for _ in 0..2_000 {
        let t = mesh.indices[random.bits() as usize % mesh.indices.len()];
        let [a, b, c] = t
            .map(|v| mesh.vertices[v as usize])
            .map(|v| [v.x, v.y, v.z].map(f64::from));
        let (u, v) = (random.within(0.0, 1.0), random.within(0.0, 1.0));
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let minus = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| p[k] - q[k]);
        let n = cross(minus(b, a), minus(c, a));
        let length = dot(n, n).sqrt();
        let at = |way: f64| {
            [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) + way * n[k] / length)
        };
        assert!(!inside(medial, at(step)), "bulges out at {:?}", at(0.0));
        assert!(inside(medial, at(-step)), "falls short at {:?}", at(0.0));
    }
}

#[test]
fn convex_polyhedra_become_their_own_medial_axis() {
    let pentagon: Vec<(f32, f32)> = (0..5)
        .map(|k| (k as f32 / 5.0 * std::f32::consts::TAU).sin_cos())
        .collect();
    let pentagon: Vec<(f32, f32)> = pentagon.into_iter().rev().collect();
    let turned = cuboid(Vector::new(0.3, 0.2, 0.5)).map(|v| {
        let (s, c) = 0.7f32.sin_cos();
        Vector::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z) + Vector::new(3.0, -1.0, 0.5)
    });
    let cases = [
        ("cube", cuboid(Vector::splat(1.0)), 12),
        ("cut cube", refine(cuboid(Vector::splat(1.0)), 2), 40),
        ("turned box", turned, 40),
        (
            "prism",
            prism(&pentagon, 1.5, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
            60,
        ),
    ];
    for (name, mesh, most) in cases {
        let (medial, report) = built(&mesh, BuildOptions::default());
        let error = f64::from(report.hausdorff.error() / report.longest_side);
        println!(
            "{name}: {} primitives, error {error:.1e}",
            report.primitives
        );
        assert!(error <= 1e-6, "{name}: {error}");
        assert!(report.primitives <= most, "{name}: {}", report.primitives);
        assert_eq!(report.hausdorff.uncovered, 0.0, "{name}");
        assert_within(&mesh, &medial, EXACT, 5);
    }
}

/// The chamfers are a hundredth of the length: few samples do not tell them apart.
#[test]
fn narrow_chamfers_are_exact() {
    let mut planes = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut n = [0.0; 3];
            n[axis] = sign;
            planes.push((n, [0.08, 0.06, 0.5][axis]));
        }
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        planes.push(([x * half, y * half, 0.0], half * 0.13));
    }
    let mesh = convex(&planes);
    let (medial, report) = built(&mesh, BuildOptions::default());
    let error = report.hausdorff.error() / report.longest_side;
    println!("{} primitives, error {error:.1e}", report.primitives);
    assert!(error <= 1e-6, "{error}");
    assert_within(&mesh, &medial, EXACT, 6);
}

#[test]
fn creases_can_be_left_out() {
    let mesh = cuboid(Vector::splat(1.0));
    let options = BuildOptions {
        creases: Creases::None,
        quality: Quality::Fast,
        primitives: Some(100),
        ..Default::default()
    };
    let (medial, report) = built(&mesh, options);
    assert!(
        report.hausdorff.error() > 1e-3,
        "{}",
        report.hausdorff.error()
    );
    assert!(medial.spheres().iter().all(|s| s.radius > 1e-3));
}

#[test]
fn an_angle_below_zero_is_refused() {
    let mesh = cuboid(Vector::splat(1.0));
    let options = BuildOptions {
        creases: Creases::Keep(-0.1),
        ..Default::default()
    };
    let refused = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    assert!(refused.is_err());
}

/// A polyhedron has no more primitives than are allowed, though its axis has.
#[test]
fn a_polyhedron_keeps_the_count() {
    let mesh = cuboid(Vector::splat(1.0));
    let options = BuildOptions {
        primitives: Some(8),
        ..Default::default()
    };
    let (medial, _) = built(&mesh, options);
    assert!(medial.primitive_count() <= 8);
}
