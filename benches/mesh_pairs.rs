//! Two meshes of 1,236 primitives each (800 slabs, 436 cones, made here), one continuous query: the
//! best-first search over both trees beside the paper's reading, all elementary pairs by brute
//! force, one at a time and in lanes.
//!
//! `cargo bench --bench mesh_pairs`. Prints medians, 99th percentiles, counts (median and most), and a
//! hash of the results.

mod common;

use common::{Hash, median, processor};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::bracket::Limits;
use rapier3d_medial::elementary::first_contact;
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, for_each_test};
use rapier3d_medial::elementary::{MovingSphere, ToiOptions, ToiStatus};
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::math::tolerance;
use rapier3d_medial::pair::Volumes;
use rapier3d_medial::pair::first_contact::{Counts, first_contact_counted};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::time::Instant;

const SECONDS: Real = 1.0 / 60.0;

/// A curved sheet of 20 × 20 cells (800 slabs) with a rim of 12 spikes (436 cones in all).
fn creature() -> MedialMesh {
    let mut spheres = Vec::new();
    let mut faces = Vec::new();
    let n = 21;
    for i in 0..n {
        for j in 0..n {
            let (x, z) = (i as Real / 20.0 - 0.5, j as Real / 20.0 - 0.5);
            let y = 0.3 * (3.0 * x).cos() * (2.0 * z).cos();
            let radius = 0.03 + 0.05 * (0.5 - x.abs()).min(0.5 - z.abs());
            spheres.push(MedialSphere::new(Vector::new(x, y, z), radius));
        }
    }
    let at = |i: u32, j: u32| i * n as u32 + j;
    for i in 0..20 {
        for j in 0..20 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut edges = Vec::new();
    for spike in 0..12u32 {
        let angle = spike as Real / 12.0 * std::f32::consts::TAU;
        let out = Vector::new(angle.cos(), 0.4 * (2.0 * angle).sin(), angle.sin());
        let rim = |v: Real| ((v * 0.5 + 0.5) * 20.0).round() as u32;
        let mut last = at(rim(out.x), rim(out.z));
        let cones = if spike < 4 { 37 } else { 36 };
        for k in 1..=cones {
            let s = k as Real / cones as Real;
            let wave = Vector::new(0.0, 0.05 * (9.0 * s).sin(), 0.0);
            let base = spheres[at(rim(out.x), rim(out.z)) as usize].center;
            let next = spheres.len() as u32;
            spheres.push(MedialSphere::new(
                base + out * (0.6 * s) + wave,
                0.03 * (1.0 - s) + 0.004,
            ));
            edges.push([last, next]);
            last = next;
        }
    }
    MedialMesh::new(spheres, edges, faces).expect("a medial mesh")
}

/// A comb of long teeth; two of them interleave without touching.
fn comb(teeth: u32) -> MedialMesh {
    let mut spheres = Vec::new();
    let mut edges = Vec::new();
    for t in 0..teeth {
        let x = t as Real * 0.02;
        for k in 0..=20 {
            let v = spheres.len() as u32;
            spheres.push(MedialSphere::new(
                Vector::new(x, k as Real * 0.05, 0.0),
                0.004,
            ));
            if k > 0 {
                edges.push([v - 1, v]);
            } else if t > 0 {
                edges.push([v - 21, v]);
            }
        }
    }
    MedialMesh::new(spheres, edges, vec![]).expect("a medial mesh")
}

struct Random(u64);
impl Random {
    fn next(&mut self) -> Real {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 40) as Real / (1u64 << 24) as Real) * 2.0 - 1.0
    }
    fn vector(&mut self) -> Vector {
        Vector::new(self.next(), self.next(), self.next())
    }
}

fn motion(at: Vector, turn: Vector, velocity: Vector, spin: Vector) -> NonlinearRigidMotion {
    NonlinearRigidMotion::new(Pose::new(at, turn), Vector::ZERO, velocity, spin)
}

/// Repetitions of each query; the fastest counts, because other programs interrupt some.
const REPEATS: usize = 5;

/// Fastest of a few runs in µs, and the answer.
fn timed<T>(mut query: impl FnMut() -> T) -> (f64, T) {
    let mut run = || {
        let clock = Instant::now();
        let answer = query();
        (clock.elapsed().as_secs_f64() * 1e6, answer)
    };
    let (mut best, mut answer) = run();
    for _ in 1..REPEATS {
        let (time, again) = run();
        best = best.min(time);
        answer = again;
    }
    (best, answer)
}

/// Every two primitives, one query of the public kind each, straight paths.
fn brute_force(mesh: &MedialMesh, offset: Vector, displacement: Vector) -> Real {
    let moving = |at: Vector, by: Vector| -> Vec<Vec<MovingSphere>> {
        let place = |s: &MedialSphere| MovingSphere {
            center: s.center + at,
            radius: s.radius,
            displacement: by,
        };
        mesh.primitives()
            .map(|p| p.spheres().iter().map(place).collect())
            .collect()
    };
    let (a, b) = (
        moving(Vector::ZERO, Vector::ZERO),
        moving(offset, displacement),
    );
    let options = ToiOptions::default();
    let all = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    all.map(|(p, q)| first_contact(p, q, &options).lower)
        .fold(1.0, Real::min)
}

/// Every elementary test, shared edges and spheres once, eight lanes at a time; how many, and the
/// earliest lower bound.
fn brute_force_lanes(mesh: &MedialMesh, offset: Vector, displacement: Vector) -> (usize, Real) {
    let limits = Limits {
        tolerance: tolerance::TOLERANCE,
        time_tolerance: tolerance::TIME_TOLERANCE,
        start: 0.0,
        horizon: 1.0,
        max_iterations: tolerance::MAX_ITERATIONS,
    };
    let (mut count, mut first) = (0, 1.0);
    let n = mesh.primitive_count() as u32;
    for i in 0..n {
        let (a, share_a) = Volumes::primitive(mesh, i);
        let mut paths = [Vec::new(), Vec::new()];
        for j in 0..n {
            let (b, share_b) = Volumes::primitive(mesh, j);
            for_each_test(share_a, share_b, |test| {
                let path = LinearPath::new(&test, 0.0, |second, k| {
                    let s = if second { b } else { a }[k as usize];
                    let (at, by) = if second {
                        (offset, displacement)
                    } else {
                        (Vector::ZERO, Vector::ZERO)
                    };
                    let vec = Vec3::from_vector;
                    (vec(s.center + at), vec(by), s.radius)
                });
                paths[usize::from(test.domain == Domain::Triangle)].push(path);
                true
            });
        }
        for (paths, domain) in paths.iter().zip([Domain::Box, Domain::Triangle]) {
            count += paths.len();
            for b in brackets(paths, domain, &limits, Lanes::Fastest) {
                first = f32::min(first, b.lower);
            }
        }
    }
    (count, first)
}

fn row(name: &str, times: &mut [f64], counts: &mut [Counts], hits: usize, hash: &Hash) {
    let mut part = |of: fn(&Counts) -> u32| {
        counts.sort_by_key(of);
        let of = |k: usize| counts.get(k).map_or(0, of);
        (of(counts.len() / 2), of(counts.len() - 1))
    };
    let (nodes, most_nodes) = part(|c| c.nodes);
    let (tests, most_tests) = part(|c| c.tests);
    let runs = times.len();
    let middle = median(times);
    let p99 = times[runs * 99 / 100];
    println!(
        "{name:<28}{hits:>5}/{runs:<5}{middle:>9.1}{p99:>9.1}{nodes:>9}{most_nodes:>9}{tests:>7}{most_tests:>7}{:>11}",
        hash.short()
    );
}

fn main() {
    println!("{}, one core", processor());
    let mesh = creature();
    assert_eq!(mesh.primitive_count(), 1236);
    println!(
        "{:<28}{:>11}{:>9}{:>9}{:>9}{:>9}{:>7}{:>7}{:>11}",
        "scene", "hits ", "median µs", "p99", "nodes", "most", "tests", "most", "hash"
    );
    let scenes: [(&str, Real, Real, Real); 5] = [
        ("apart", 6.0, 5.0, 2.0),
        ("approach", 1.9, 20.0, 5.0),
        ("fast, 4 body sizes a step", 4.0, 300.0, 10.0),
        ("overlapping at the start", 0.2, 5.0, 2.0),
        ("close", 1.5, 2.0, 2.0),
    ];
    let options = ToiOptions::default();
    for (name, distance, speed, spin) in scenes {
        let mut random = Random(11);
        let (mut times, mut all_counts, mut hits) = (Vec::new(), Vec::new(), 0);
        let mut hash = Hash::new();
        for _ in 0..200 {
            let away = random.vector().normalize_or_zero() * distance;
            let towards = -away.normalize_or_zero() * speed + random.vector() * (0.1 * speed);
            let m1 = motion(
                Vector::ZERO,
                random.vector(),
                Vector::ZERO,
                random.vector() * spin,
            );
            let m2 = motion(away, random.vector() * 3.0, towards, random.vector() * spin);
            let (time, (toi, counts)) =
                timed(|| first_contact_counted(&mesh, &m1, &mesh, &m2, SECONDS, &options));
            times.push(time);
            all_counts.push(counts);
            hits += usize::from(toi.status != ToiStatus::Separated);
            hash.add(u64::from(toi.lower.to_bits()));
            hash.add(u64::from(toi.upper.to_bits()));
        }
        row(name, &mut times, &mut all_counts, hits, &hash);
    }
    let combs = [comb(60), comb(60)];
    let m1 = motion(Vector::ZERO, Vector::ZERO, Vector::ZERO, Vector::ZERO);
    let m2 = motion(
        Vector::new(0.01, 1.2, 0.0),
        Vector::new(std::f32::consts::PI, 0.0, 0.0),
        Vector::new(0.0, -3.0, 0.0),
        Vector::ZERO,
    );
    let (time, (toi, counts)) =
        timed(|| first_contact_counted(&combs[0], &m1, &combs[1], &m2, SECONDS, &options));
    let mut hash = Hash::new();
    hash.add(u64::from(toi.lower.to_bits()));
    let hits = usize::from(toi.status != ToiStatus::Separated);
    row(
        "interleaved combs, disjoint",
        &mut [time],
        &mut [counts],
        hits,
        &hash,
    );
    if std::env::var("DBG").is_ok() {
        return;
    }
    let (offset, by) = (
        Vector::new(2.6, 0.0, 0.0),
        Vector::new(-60.0, 0.0, 0.0) * SECONDS,
    );
    let (m1, m2) = (
        motion(Vector::ZERO, Vector::ZERO, Vector::ZERO, Vector::ZERO),
        motion(offset, Vector::ZERO, by / SECONDS, Vector::ZERO),
    );
    let (time, (toi, _)) =
        timed(|| first_contact_counted(&mesh, &m1, &mesh, &m2, SECONDS, &options));
    println!(
        "straight approach, the search        {time:.1} µs, first {}",
        toi.lower
    );
    let clock = Instant::now();
    let first = brute_force(&mesh, offset, by);
    let ms = clock.elapsed().as_secs_f64() * 1e3;
    println!("all primitive pairs, scalar f32      {ms:.0} ms, first {first}");
    let clock = Instant::now();
    let (count, first) = brute_force_lanes(&mesh, offset, by);
    let ms = clock.elapsed().as_secs_f64() * 1e3;
    let path = Lanes::Fastest.path();
    println!("all {count} tests, eight lanes, {path}  {ms:.0} ms, first {first}");
}
