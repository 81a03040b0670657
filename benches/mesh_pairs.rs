//! Two meshes of 1,236 primitives each (800 slabs, 436 cones, made here), one continuous query: the
//! best-first search over both trees beside the paper's reading, all elementary pairs by brute
//! force.
//!
//! `cargo bench --bench mesh_pairs`. Prints medians, counts, and a hash of the results.

mod common;

use common::{Hash, median, processor};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::first_contact;
use rapier3d_medial::elementary::{MovingSphere, ToiOptions, ToiStatus};
use rapier3d_medial::pair::first_contact::first_contact_counted;
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

/// Every sphere pair of primitives, one elementary query each, straight paths.
fn brute_force(a: &MedialMesh, b: &MedialMesh, velocity: Vector, offset: Vector) -> Real {
    let moving = |m: &MedialMesh, at: Vector, by: Vector| -> Vec<Vec<MovingSphere>> {
        m.primitives()
            .map(|p| {
                p.spheres()
                    .iter()
                    .map(|s| MovingSphere {
                        center: s.center + at,
                        radius: s.radius,
                        displacement: by,
                    })
                    .collect()
            })
            .collect()
    };
    let (a, b) = (
        moving(a, Vector::ZERO, Vector::ZERO),
        moving(b, offset, velocity * SECONDS),
    );
    let options = ToiOptions::default();
    let mut first: Real = 1.0;
    for p in &a {
        for q in &b {
            first = first.min(first_contact(p, q, &options).lower);
        }
    }
    first
}

fn main() {
    println!("{}, one core", processor());
    let mesh = creature();
    assert_eq!(mesh.primitive_count(), 1236);
    let combs = [comb(60), comb(60)];
    println!(
        "{:<28}{:>8}{:>12}{:>9}{:>9}{:>11}",
        "scene", "hits", "median µs", "nodes", "tests", "hash"
    );
    let scenes: [(&str, Real, Real, Real); 5] = [
        ("apart", 6.0, 5.0, 2.0),
        ("approach", 1.9, 20.0, 5.0),
        ("fast, 4 body sizes a step", 4.0, 300.0, 10.0),
        ("overlapping at the start", 0.2, 5.0, 2.0),
        ("close", 1.5, 2.0, 2.0),
    ];
    for (name, distance, speed, spin) in scenes {
        let mut random = Random(11);
        let mut times = Vec::new();
        let (mut hits, mut nodes, mut tests, mut worst) = (0, 0u64, 0u64, 0);
        let mut hash = Hash::new();
        const RUNS: usize = 200;
        for _ in 0..RUNS {
            let away = random.vector().normalize_or_zero() * distance;
            let towards = -away.normalize_or_zero() * speed + random.vector() * (0.1 * speed);
            let m1 = motion(
                Vector::ZERO,
                random.vector(),
                Vector::ZERO,
                random.vector() * spin,
            );
            let m2 = motion(away, random.vector() * 3.0, towards, random.vector() * spin);
            let options = ToiOptions::default();
            let clock = Instant::now();
            let (toi, counts) = first_contact_counted(&mesh, &m1, &mesh, &m2, SECONDS, &options);
            times.push(clock.elapsed().as_secs_f64() * 1e6);
            hits += usize::from(toi.status != ToiStatus::Separated);
            nodes += u64::from(counts.nodes);
            tests += u64::from(counts.tests);
            worst = worst.max(counts.tests);
            hash.add(u64::from(toi.lower.to_bits()));
            hash.add(u64::from(toi.upper.to_bits()));
        }
        println!(
            "{name:<28}{hits:>5}/{RUNS}{:>9.1}{:>9}{:>9}{:>11}  (most tests {worst}, p99 {:.0} µs)",
            median(&mut times),
            nodes / RUNS as u64,
            tests / RUNS as u64,
            hash.short(),
            times[RUNS * 99 / 100]
        );
    }
    let m1 = motion(Vector::ZERO, Vector::ZERO, Vector::ZERO, Vector::ZERO);
    let m2 = motion(
        Vector::new(0.01, 1.2, 0.0),
        Vector::new(std::f32::consts::PI, 0.0, 0.0),
        Vector::new(0.0, -3.0, 0.0),
        Vector::ZERO,
    );
    let clock = Instant::now();
    let (toi, counts) = first_contact_counted(
        &combs[0],
        &m1,
        &combs[1],
        &m2,
        SECONDS,
        &ToiOptions::default(),
    );
    println!(
        "interleaved combs, disjoint  {:?} {:.0} µs, nodes {}, tests {}",
        toi.status,
        clock.elapsed().as_secs_f64() * 1e6,
        counts.nodes,
        counts.tests
    );
    let clock = Instant::now();
    let first = brute_force(
        &mesh,
        &mesh,
        Vector::new(-20.0, 0.0, 0.0),
        Vector::new(1.9, 0.0, 0.0),
    );
    println!(
        "all primitive pairs, brute force  {:.0} ms, first {first}",
        clock.elapsed().as_secs_f64() * 1e3
    );
}
