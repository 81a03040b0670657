//! Random convex polyhedra against half-space distances in `f64`: each sphere of the result is measured
//! against every plane of the source, which is exact, as primitives are hulls of their spheres.

use crate::creases::convex;
use crate::meshes::*;
use crate::oracle::{Random, signed_distance};
use parry3d::math::{Rotation, Vector};
use parry3d::transformation::convex_hull;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, MedialSphere, Quality};

/// The error of a medial axis (longest side 1).
const EXACT: f64 = 1e-6;

fn f64s(v: Vector) -> [f64; 3] {
    [v.x, v.y, v.z].map(f64::from)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

pub fn hull(points: &[Vector]) -> Mesh {
    let (vertices, indices) = convex_hull(points);
    Mesh { vertices, indices }
}

/// The hull of points no four of which are in one plane, by trying all triples: exact, where parry's is in `f32`.
fn exact_hull(points: &[Vector]) -> Mesh {
    let at: Vec<[f64; 3]> = points.iter().map(|&p| f64s(p)).collect();
    let count = points.len() as u32;
    let mut indices = Vec::new();
    for i in 0..count {
        for (j, k) in (i + 1..count).flat_map(|j| (i + 1..count).map(move |k| (j, k))) {
            let [a, b, c] = [i, j, k].map(|v| at[v as usize]);
            let n = cross(minus(b, a), minus(c, a));
            let below = |v: &u32| [i, j, k].contains(v) || dot(n, minus(at[*v as usize], a)) < 0.0;
            if j != k && (0..count).all(|v| below(&v)) {
                indices.push([i, j, k]);
            }
        }
    }
    Mesh {
        vertices: points.to_vec(),
        indices,
    }
}

/// Unit normal and offset of each triangle that is no sliver.
fn planes(mesh: &Mesh) -> Vec<([f64; 3], f64)> {
    let side = f64::from(mesh.longest_side());
    let count = mesh.vertices.len() as f64;
    let middle = mesh.vertices.iter().fold([0.0; 3], |sum, &v| {
        let v = f64s(v);
        [0, 1, 2].map(|k| sum[k] + v[k] / count)
    });
    let plane = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| f64s(mesh.vertices[v as usize]));
        let n = cross(minus(b, a), minus(c, a));
        let length = dot(n, n).sqrt();
        // Away from the middle, however the triangle is wound.
        let sign = dot(n, minus(a, middle)).signum();
        let n = n.map(|x| sign * x / length);
        (length > 1e-4 * side * side).then(|| (n, dot(n, a)))
    };
    mesh.indices.iter().filter_map(plane).collect()
}

/// How far a sphere is beyond the farthest plane.
fn beyond(planes: &[([f64; 3], f64)], sphere: &MedialSphere) -> f64 {
    let (c, r) = (f64s(sphere.center), f64::from(sphere.radius));
    let heights = planes.iter().map(|(n, d)| dot(*n, c) + r - d);
    heights.fold(f64::MIN, f64::max)
}

/// How far the result's spheres stick out of the planes, and points of the faces out of the result, over the
/// longest side.
pub fn off(mesh: &Mesh, medial: &MedialMesh, seed: u64, samples: usize) -> (f64, f64) {
    let side = f64::from(mesh.longest_side());
    let planes = planes(mesh);
    let spheres = medial.spheres().iter();
    let bloat = spheres.map(|s| beyond(&planes, s)).fold(0.0, f64::max) / side;
    let mut random = Random(seed);
    let mut uncovered: f64 = 0.0;
    for i in 0..samples {
        let t = mesh.indices[i % mesh.indices.len()];
        let [a, b, c] = t.map(|v| f64s(mesh.vertices[v as usize]));
        let (u, v) = (random.within(0.0, 1.0), random.within(0.0, 1.0));
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let p = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
        let nearest = medial.primitives().map(|q| signed_distance(q.spheres(), p));
        uncovered = uncovered.max(nearest.fold(f64::MAX, f64::min) / side);
    }
    (bloat, uncovered)
}

/// The half spaces of a box, `n·p ≤ d`.
fn box_planes(half: [f64; 3]) -> Vec<([f64; 3], f64)> {
    let side = |k: usize| {
        let mut n = [0.0; 3];
        n[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        (n, half[k / 2])
    };
    (0..6).map(side).collect()
}

fn is_axis(report: &BuildReport) -> bool {
    report
        .notes
        .iter()
        .any(|n| n.starts_with("a convex polyhedron"))
}

pub fn points_in_ball(random: &mut Random, count: usize) -> Vec<Vector> {
    let mut points = Vec::new();
    while points.len() < count {
        let p = random.vector(1.0);
        if p.length() < 1.0 {
            points.push(p);
        }
    }
    points
}

/// A polygon of `n` corners on a circle, evenly, at height `z`.
fn ring(n: usize, radius: f32, z: f32, turn: f32) -> Vec<Vector> {
    let corner = |k: usize| {
        let (s, c) = ((k as f32 + turn) / n as f32 * std::f32::consts::TAU).sin_cos();
        Vector::new(radius * c, radius * s, z)
    };
    (0..n).map(corner).collect()
}

fn family(name: &str, random: &mut Random) -> Mesh {
    let n = 3 + (random.bits() % 8) as usize;
    let mut size = || random.within(0.2, 1.5) as f32;
    let (a, b, h) = (size(), size(), size());
    match name {
        "hull of 5 to 20" => {
            let count = 5 + (random.bits() % 16) as usize;
            exact_hull(&points_in_ball(random, count))
        }
        "hull of 4 to 30, stretched 1:100" => {
            let count = 4 + (random.bits() % 27) as usize;
            let stretch = random.within(0.0, 2.0);
            let stretch = 10f64.powf(stretch) as f32;
            let points = points_in_ball(random, count);
            let stretched = points.iter().map(|v| Vector::new(v.x, v.y, stretch * v.z));
            exact_hull(&stretched.collect::<Vec<_>>())
        }
        "hull of 4 to 30, 1e-4 to 1e4" => {
            let count = 4 + (random.bits() % 27) as usize;
            let scale = [1e-4, 1e-2, 1e2, 1e4][(random.bits() % 4) as usize];
            exact_hull(&points_in_ball(random, count)).map(|v| v * scale)
        }
        "hull with slivers" => {
            // Beside the middles of a tetrahedron's edges, a hundredth to a thousandth of them out.
            let corners = points_in_ball(random, 4);
            let mut points = corners.clone();
            for (i, j) in [(0, 1), (1, 2), (2, 3)] {
                let middle = (corners[i] + corners[j]) * 0.5;
                let out = 10f64.powf(random.within(-3.0, -2.0)) as f32;
                points.push(middle * (1.0 + out));
            }
            exact_hull(&points)
        }
        "box with chamfers of .001 to .1" => {
            let mut planes = box_planes([a, b, h].map(f64::from));
            let sides = [a, b, h].map(f64::from);
            let width =
                10f64.powf(random.within(-3.0, -1.0)) * sides[0].min(sides[1]).min(sides[2]);
            let half = std::f64::consts::FRAC_1_SQRT_2;
            for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
                planes.push((
                    [x * half, y * half, 0.0],
                    half * (sides[0] + sides[1] - width),
                ));
            }
            convex(&planes)
        }
        "box with cut corners" => {
            let sides = [a, b, h].map(f64::from);
            let mut planes = box_planes(sides);
            for k in 0..1 + random.bits() % 8 {
                let n = [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { 1.0 } else { -1.0 });
                let n = n.map(|x| x * random.within(0.5, 2.0));
                let length = dot(n, n).sqrt();
                let n = n.map(|x| x / length);
                let corner = (0..3).map(|axis| n[axis].abs() * sides[axis]).sum::<f64>();
                planes.push((
                    n,
                    corner - random.within(0.05, 0.4) * sides[0].min(sides[1]).min(sides[2]),
                ));
            }
            convex(&planes)
        }
        "plate 1:1:.001" => cuboid(Vector::new(a, b, 1e-3 * a.max(b))),
        "hull of 21 to 60" => {
            let count = 21 + (random.bits() % 40) as usize;
            exact_hull(&points_in_ball(random, count))
        }
        "prism" => hull(&[ring(n, a, 0.0, 0.0), ring(n, a, h, 0.0)].concat()),
        "pyramid" => hull(&[ring(n, a, 0.0, 0.0), vec![Vector::new(0.1, 0.05, h)]].concat()),
        "frustum" => hull(&[ring(n, a, 0.0, 0.0), ring(n, b, h, 0.0)].concat()),
        "antiprism" => hull(&[ring(n, a, 0.0, 0.0), ring(n, a, h, 0.5)].concat()),
        "bipyramid" => {
            let tips = vec![Vector::new(0.0, 0.0, h), Vector::new(0.0, 0.0, -b)];
            hull(&[ring(n, a, 0.0, 0.0), tips].concat())
        }
        "wedge" => {
            let ridge = vec![Vector::new(-0.3 * a, 0.0, h), Vector::new(0.3 * a, 0.0, h)];
            hull(&[ring(4, a, 0.0, 0.5), ridge].concat())
        }
        "flat 1:1000" => {
            let points = points_in_ball(random, 10);
            let flat = points.iter().map(|v| Vector::new(v.x, v.y, 1e-3 * v.z));
            exact_hull(&flat.collect::<Vec<_>>())
        }
        "needle 1:1:500" => cuboid(Vector::new(a, b, 500.0 * a.max(b))),
        "turned, far, 1e-4" | "turned, 1e4" => {
            let (s, c) = random.within(0.0, 6.0).sin_cos();
            let (s, c) = (s as f32, c as f32);
            let scale = if name.ends_with("1e4") { 1e4 } else { 1e-4 };
            let far = Vector::new(3.0, -2.0, 1.0);
            let body = hull(&[ring(n, a, 0.0, 0.0), ring(n, b, h, 0.0)].concat());
            body.map(|v| (Vector::new(c * v.x - s * v.z, v.y, s * v.x + c * v.z) + far) * scale)
        }
        "cut fine, every triangle its own vertices" => {
            let body = refine(
                hull(
                    &ring(n, a, 0.0, 0.0)
                        .into_iter()
                        .chain(ring(n, b, h, 0.5))
                        .collect::<Vec<_>>(),
                ),
                2,
            );
            let vertices = body
                .indices
                .iter()
                .flatten()
                .map(|&v| body.vertices[v as usize]);
            let vertices: Vec<Vector> = vertices.collect();
            let indices = (0..body.indices.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
            Mesh {
                indices: indices.collect(),
                vertices,
            }
        }
        "T-junctions" => {
            let mut body = cuboid(Vector::new(a, b, h));
            // One triangle of a face is split at an edge that its neighbour keeps whole.
            let [p, q, r] = body.indices[0];
            let middle = (body.vertices[p as usize] + body.vertices[q as usize]) * 0.5;
            body.vertices.push(middle);
            let m = body.vertices.len() as u32 - 1;
            body.indices[0] = [p, m, r];
            body.indices.push([m, q, r]);
            body
        }
        "flipped triangles" => {
            let mut body = hull(&points_in_ball(random, 12));
            body.indices
                .iter_mut()
                .step_by(3)
                .for_each(|t| t.swap(0, 1));
            body
        }
        "duplicated triangles" => {
            let mut body = hull(&points_in_ball(random, 12));
            let twice: Vec<[u32; 3]> = body.indices.iter().step_by(4).copied().collect();
            body.indices.extend(twice);
            body
        }
        _ => panic!("no family {name}"),
    }
}

const FAMILIES: [&str; 22] = [
    "hull of 5 to 20",
    "hull of 21 to 60",
    "hull of 4 to 30, stretched 1:100",
    "hull of 4 to 30, 1e-4 to 1e4",
    "hull with slivers",
    "box with chamfers of .001 to .1",
    "box with cut corners",
    "plate 1:1:.001",
    "prism",
    "pyramid",
    "frustum",
    "antiprism",
    "bipyramid",
    "wedge",
    "flat 1:1000",
    "needle 1:1:500",
    "turned, far, 1e-4",
    "turned, 1e4",
    "cut fine, every triangle its own vertices",
    "T-junctions",
    "flipped triangles",
    "duplicated triangles",
];

/// What rounding the spheres to `f32` adds, over the longest side: each coordinate moves by half its last place,
/// and the radius grows by as much.
fn rounding(mesh: &Mesh) -> f64 {
    let far = mesh.vertices.iter().flat_map(|&v| f64s(v));
    let far = far.fold(0.0, |far: f64, x| far.max(x.abs()));
    4.0 * 2f64.powi(-24) * far / f64::from(mesh.longest_side())
}

#[test]
fn random_convex_polyhedra_are_exact() {
    let count = std::env::var("POLYHEDRA").map_or(1, |n| n.parse().expect("a count"));
    let wanted = std::env::var("FAMILY").unwrap_or_default();
    for name in FAMILIES.iter().filter(|name| name.contains(&wanted)) {
        let mut random = Random(name.len() as u64);
        let (mut worst, mut seconds) = ((0.0f64, 0.0f64, 0.0f64), 0.0f64);
        for seed in 0..count {
            let mesh = family(name, &mut random);
            let start = std::time::Instant::now();
            let (medial, report) =
                MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &BuildOptions::default())
                    .expect("builds");
            seconds = seconds.max(start.elapsed().as_secs_f64());
            let error = f64::from(report.hausdorff.error() / report.longest_side);
            assert!(is_axis(&report), "{name} {seed}: {:?}", report.notes);
            let (bloat, uncovered) = off(&mesh, &medial, seed as u64, 30);
            assert!(
                bloat <= EXACT + rounding(&mesh),
                "{name} {seed}: bloat {bloat:e}"
            );
            assert!(uncovered <= 0.0, "{name} {seed}: uncovered {uncovered:e}");
            assert!(error <= EXACT, "{name} {seed}: {error:e}");
            worst = (
                worst.0.max(bloat),
                worst.1.max(uncovered),
                worst.2.max(error),
            );
        }
        println!(
            "{name}: {count}; bloat {:.1e}, uncovered {:.1e}, reported {:.1e}; slowest {seconds:.2} s",
            worst.0, worst.1, worst.2,
        );
    }
}

#[test]
fn two_polyhedra_are_exact_together() {
    let one = exact_hull(&points_in_ball(&mut Random(3), 10));
    let other = cuboid(Vector::new(0.3, 0.9, 0.5)).map(|v| v + Vector::new(3.0, 0.0, 0.0));
    let planes = [planes(&one), planes(&other)];
    let both = one.and(other);
    let (medial, report) =
        MedialMesh::from_trimesh(&both.vertices, &both.indices, &BuildOptions::default())
            .expect("builds");
    assert!(is_axis(&report), "{:?}", report.notes);
    assert_eq!(report.euler, 2);
    let side = f64::from(both.longest_side());
    for sphere in medial.spheres() {
        let out = planes.iter().map(|planes| beyond(planes, sphere) / side);
        assert!(out.fold(f64::INFINITY, f64::min) <= EXACT + rounding(&both));
    }
}

/// A body that lacks a face is no polyhedron, and one with more slabs than asked for is built as others are.
#[test]
fn bodies_that_are_no_polyhedra_are_rounded() {
    let mut body = hull(&points_in_ball(&mut Random(1), 10));
    let fewer = BuildOptions {
        primitives: Some(20),
        quality: Quality::Fast,
        ..Default::default()
    };
    let (medial, report) =
        MedialMesh::from_trimesh(&body.vertices, &body.indices, &fewer).expect("builds");
    assert!(!is_axis(&report) && medial.primitive_count() <= 20);
    body.indices.pop();
    let fast = BuildOptions {
        quality: Quality::Fast,
        ..Default::default()
    };
    let (_, report) =
        MedialMesh::from_trimesh(&body.vertices, &body.indices, &fast).expect("builds");
    assert!(!is_axis(&report));
}

/// Needles keep all their sides, which lie a few ten-thousandths of the length from each other.
#[test]
fn needles_of_many_sides_are_exact() {
    for (sides, thin) in [8, 16, 32]
        .into_iter()
        .flat_map(|n| [500.0, 1000.0, 2000.0].map(|t| (n, t)))
    {
        let radius = 0.5 / thin;
        let corners = [
            ring(sides, radius, -0.5, 0.3),
            ring(sides, radius, 0.5, 0.3),
        ]
        .concat();
        let n = sides as u32;
        let band = (0..n).flat_map(|i| {
            let k = (i + 1) % n;
            [[i, k, n + k], [i, n + k, n + i]]
        });
        let ends = (1..n - 1).flat_map(|i| [[0, i + 1, i], [n, n + i, n + i + 1]]);
        let turn = Rotation::from_scaled_axis(Vector::new(0.7, 0.4, -0.2));
        let mesh = Mesh {
            vertices: corners.iter().map(|&c| turn * c).collect(),
            indices: band.chain(ends).collect(),
        };
        let (medial, report) =
            MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &BuildOptions::default())
                .expect("builds");
        assert!(is_axis(&report), "{sides}, {thin}: {:?}", report.notes);
        let inner = f64::from(radius) * (std::f64::consts::PI / sides as f64).cos();
        for sphere in medial.spheres() {
            let (c, r) = (
                f64s(turn.inverse() * sphere.center),
                f64::from(sphere.radius),
            );
            let side = |k: usize| {
                let (s, t) = ((k as f64 + 0.8) / sides as f64 * std::f64::consts::TAU).sin_cos();
                t * c[0] + s * c[1] + r - inner
            };
            let out = (0..sides).map(side).fold(c[2].abs() + r - 0.5, f64::max);
            assert!(out < EXACT, "{sides}, {thin}: {out:e}");
        }
        let (_, uncovered) = off(&mesh, &medial, 1, 200);
        assert!(uncovered <= 0.0, "{sides}, {thin}: uncovered {uncovered:e}");
    }
}
