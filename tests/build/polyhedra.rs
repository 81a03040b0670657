//! Random convex polyhedra against half-space distances in `f64`: each sphere of the result is measured
//! against every plane of the source, which is exact, as primitives are hulls of their spheres.

use crate::meshes::*;
use crate::oracle::{Random, signed_distance};
use parry3d::math::Vector;
use parry3d::transformation::convex_hull;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality};

/// The error of a medial axis (longest side 1): a millionth, and spheres rounded to `f32`.
const EXACT: f64 = 1.2e-6;

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

fn hull(points: &[Vector]) -> Mesh {
    let (vertices, indices) = convex_hull(points);
    Mesh { vertices, indices }
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

/// How far the result's spheres stick out of the planes, and points of the faces out of the result, over the
/// longest side.
fn off(mesh: &Mesh, medial: &MedialMesh, seed: u64, samples: usize) -> (f64, f64) {
    let side = f64::from(mesh.longest_side());
    let planes = planes(mesh);
    let beyond = |c: [f64; 3], r: f64| {
        let heights = planes.iter().map(|(n, d)| dot(*n, c) + r - d);
        heights.fold(f64::MIN, f64::max)
    };
    let spheres = medial.spheres().iter();
    let bloat = spheres.map(|s| beyond(f64s(s.center), s.radius.into()));
    let bloat = bloat.fold(0.0, f64::max) / side;
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

fn is_axis(report: &BuildReport) -> bool {
    report
        .notes
        .iter()
        .any(|n| n.starts_with("a convex polyhedron"))
}

fn points_in_ball(random: &mut Random, count: usize) -> Vec<Vector> {
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
            hull(&points_in_ball(random, count))
        }
        "hull of 21 to 60" => {
            let count = 21 + (random.bits() % 40) as usize;
            hull(&points_in_ball(random, count))
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
            hull(&points).map(|v| Vector::new(v.x, v.y, 1e-3 * v.z))
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
        "two apart" => {
            let other = cuboid(Vector::new(a, b, h)).map(|v| v + Vector::new(3.0, 0.0, 0.0));
            hull(&points_in_ball(random, 10)).and(other)
        }
        "one face missing" => {
            let mut body = hull(&points_in_ball(random, 10));
            body.indices.pop();
            body
        }
        _ => panic!("no family {name}"),
    }
}

const FAMILIES: [&str; 18] = [
    "hull of 5 to 20",
    "hull of 21 to 60",
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
    "two apart",
    "one face missing",
];

#[test]
fn random_convex_polyhedra_are_exact() {
    let count = std::env::var("POLYHEDRA").map_or(1, |n| n.parse().expect("a count"));
    for name in FAMILIES {
        let mut random = Random(name.len() as u64);
        let (mut accepted, mut worst) = (0, (0.0f64, 0.0f64, 0.0f64));
        let mut refused = Vec::new();
        let since = std::time::Instant::now();
        let mut seconds: f64 = 0.0;
        for seed in 0..count {
            let mesh = family(name, &mut random);
            let options = BuildOptions {
                quality: Quality::Fast,
                ..Default::default()
            };
            let start = std::time::Instant::now();
            let (medial, report) =
                MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("builds");
            seconds = seconds.max(start.elapsed().as_secs_f64());
            let error = f64::from(report.hausdorff.error() / report.longest_side);
            if is_axis(&report) {
                accepted += 1;
                let (bloat, uncovered) = off(&mesh, &medial, seed as u64, 60);
                worst = (
                    worst.0.max(bloat),
                    worst.1.max(uncovered),
                    worst.2.max(error),
                );
            } else {
                refused.push((seed, error, report.hausdorff.sampling));
            }
        }
        println!(
            "{name}: {accepted} of {count}; bloat {:.1e}, uncovered {:.1e}, reported {:.1e}; slowest {seconds:.2} s, all {:.1} s; refused {:?}",
            worst.0,
            worst.1,
            worst.2,
            since.elapsed().as_secs_f64(),
            &refused[..refused.len().min(3)]
        );
        assert!(
            worst.0 <= EXACT && worst.1 <= EXACT && worst.2 <= EXACT,
            "{name}: {worst:?}"
        );
    }
}
