//! Two meshes of 1,236 primitives each (800 slabs, 436 cones, made here), one continuous query: the
//! best-first search over both trees beside the paper's reading, all elementary pairs by brute
//! force, one at a time and in lanes.
//!
//! `cargo bench --bench mesh_pairs`. Prints medians, 99th percentiles, counts (median and most), and a
//! hash of the results.

mod common;
#[path = "../tests/common/creature.rs"]
mod creature;

use common::{Hash, median, processor};
use creature::{SCENES, SECONDS, combs, creature, motion, motions};
use rapier3d::math::{Real, Vector};
use rapier3d_medial::elementary::bracket::Limits;
use rapier3d_medial::elementary::first_contact;
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, for_each_test};
use rapier3d_medial::elementary::{MovingSphere, ToiOptions, ToiStatus};
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::math::tolerance;
use rapier3d_medial::pair::PrimitiveTree;
use rapier3d_medial::pair::first_contact::{Counts, first_contact_counted};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::time::Instant;

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
        let (a, share_a) = PrimitiveTree::primitive(mesh, i);
        let mut paths = [Vec::new(), Vec::new()];
        for j in 0..n {
            let (b, share_b) = PrimitiveTree::primitive(mesh, j);
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
    let mut part = |of: fn(&Counts) -> u64| {
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
    let options = ToiOptions::default();
    for scene in SCENES {
        let (mut times, mut all_counts, mut hits) = (Vec::new(), Vec::new(), 0);
        let mut hash = Hash::new();
        for [m1, m2] in motions(&scene, 200) {
            let (time, (toi, counts)) =
                timed(|| first_contact_counted(&mesh, &m1, &mesh, &m2, SECONDS, &options));
            times.push(time);
            all_counts.push(counts);
            hits += usize::from(toi.status != ToiStatus::Separated);
            hash.add(u64::from(toi.lower.to_bits()));
            hash.add(u64::from(toi.upper.to_bits()));
        }
        row(scene.name, &mut times, &mut all_counts, hits, &hash);
    }
    let (combs, [m1, m2]) = combs();
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
