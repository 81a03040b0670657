//! Batches on the device beside the CPU, in the same run and in interleaved rounds: elementary tests
//! against the scalar kernel and eight lanes on one and two threads, and mesh pairs of 1,236
//! primitives against the search on the CPU.
//!
//! `cargo bench --features gpu --bench gpu_batch`. Any adapter serves; its name is printed. The
//! device's time includes packing, upload, one submission and the answers.

#[allow(dead_code, reason = "no hash of results is printed here")]
mod common;

use common::{median, processor};
use pollster::block_on;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::batch::gpu::layout::SEPARATED;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions};
use rapier3d_medial::batch::{Job, ToiJob, cpu};
use rapier3d_medial::elementary::bracket::{Limits, bracket};
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::Domain;
use rapier3d_medial::elementary::{ToiOptions, ToiStatus};
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 5;

struct Random(u64);
impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 40) as f32 / (1u64 << 24) as f32) * 2.0 - 1.0
    }
    fn vector(&mut self) -> Vector {
        Vector::new(self.next(), self.next(), self.next())
    }
}

/// Cones a quarter across that fly at each other from 1 away; about half of them meet.
fn path(random: &mut Random) -> LinearPath<f32> {
    let away = random.vector().normalize_or_zero();
    let fly = random.vector() * 0.3 - away * 1.2;
    let ends = [0; 4].map(|_| random.vector() * 0.25);
    let corners = [[0, 2], [1, 2], [0, 3], [1, 3]];
    let vector = Vec3::from_vector;
    let radii = [0; 4].map(|_| 0.08 + 0.06 * random.next());
    LinearPath {
        start: corners.map(|[a, b]| vector(away + ends[b] - ends[a])),
        rate: [vector(fly); 4],
        radius: corners.map(|[a, b]| radii[a] + radii[b]),
    }
}

fn milliseconds(mut f: impl FnMut()) -> f64 {
    let start = Instant::now();
    f();
    start.elapsed().as_secs_f64() * 1.0e3
}

fn on_two_threads(paths: &[LinearPath<f32>], limits: &Limits<f32>) {
    let (first, second) = paths.split_at(paths.len() / 2);
    let run = |part| {
        drop(black_box(brackets(
            part,
            Domain::Box,
            limits,
            Lanes::Fastest,
        )))
    };
    std::thread::scope(|scope| {
        scope.spawn(|| run(first));
        run(second);
    });
}

fn elementary(gpu: &mut Gpu) {
    println!("cone-cone tests, ms       scalar   lanes  lanes x2  device   settled");
    let limits = Limits {
        tolerance: 1.0e-4,
        time_tolerance: 1.0e-4,
        start: 0.0,
        horizon: 1.0,
        max_iterations: 64,
    };
    for count in [1_000, 10_000, 100_000, 1_000_000] {
        let mut random = Random(5);
        let paths: Vec<_> = (0..count).map(|_| path(&mut random)).collect();
        let mut bounds = Vec::new();
        let mut times = [const { Vec::new() }; 4];
        for _ in 0..ROUNDS {
            times[0].push(milliseconds(|| {
                for path in &paths {
                    black_box(bracket(path, Domain::Box, &limits));
                }
            }));
            times[1].push(milliseconds(|| {
                black_box(brackets(&paths, Domain::Box, &limits, Lanes::Fastest));
            }));
            times[2].push(milliseconds(|| on_two_threads(&paths, &limits)));
            times[3].push(milliseconds(|| {
                let asked = gpu.bounds(&paths, Domain::Box, limits.tolerance, &mut bounds);
                block_on(asked).expect("bounds");
            }));
        }
        let settled = bounds.iter().filter(|b| b.status == SEPARATED).count();
        let exact = brackets(&paths, Domain::Box, &limits, Lanes::Fastest);
        let wrong = bounds.iter().zip(&exact);
        let wrong = wrong.filter(|(b, e)| b.status == SEPARATED && !e.separated);
        assert_eq!(wrong.count(), 0, "free on the device, not on the CPU");
        let [a, b, c, d] = times.map(|mut t| median(&mut t));
        let free = exact.iter().filter(|e| e.separated).count();
        println!("{count:>20} {a:>11.2} {b:>7.2} {c:>9.2} {d:>7.2}   {settled} of {free} free");
    }
}

/// A curved sheet of 20 × 20 cells (800 slabs) with a tail of 436 cones.
fn creature() -> MedialMesh {
    let (mut spheres, mut faces, mut edges) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..21u32 {
        for j in 0..21u32 {
            let (x, z) = (i as Real / 20.0 - 0.5, j as Real / 20.0 - 0.5);
            let y = 0.3 * (3.0 * x).cos() * (2.0 * z).cos();
            spheres.push(MedialSphere::new(Vector::new(x, y, z), 0.03));
            if i < 20 && j < 20 {
                let at = i * 21 + j;
                faces.extend([[at, at + 21, at + 22], [at, at + 22, at + 1]]);
            }
        }
    }
    for k in 0..436u32 {
        let s = k as Real / 436.0;
        let at = Vector::new((20.0 * s).cos(), s - 0.5, (20.0 * s).sin()) * (0.6 + 0.2 * s);
        spheres.push(MedialSphere::new(at, 0.02));
        edges.push([440 + k, 441 + k]);
    }
    MedialMesh::new(spheres, edges, faces).expect("a medial mesh")
}

fn mesh_pairs(gpu: &mut Gpu) {
    println!("mesh pairs of 1,236 x 1,236, ms    CPU  device  device and CPU   free / proven");
    let mesh = creature();
    for count in [1, 4, 16, 64, 256] {
        let mut random = Random(6);
        let jobs: Vec<ToiJob> = (0..count)
            .map(|_| {
                let away = random.vector().normalize_or_zero();
                let at = |p: Vector, v: Vector, r: &mut Random| {
                    let pose = Pose::new(p, r.vector() * 3.0);
                    NonlinearRigidMotion::new(pose, Vector::ZERO, v, r.vector() * 3.0)
                };
                ToiJob {
                    mesh1: mesh.clone(),
                    motion1: at(Vector::ZERO, Vector::ZERO, &mut random),
                    mesh2: mesh.clone(),
                    motion2: at(away * 1.4, away * -6.0, &mut random),
                    seconds: 1.0 / 60.0,
                    options: ToiOptions::default(),
                }
            })
            .collect();
        let sweeps: Vec<_> = jobs.iter().filter_map(Job::sweep).collect();
        let mut proposals = Vec::new();
        let mut times = [const { Vec::new() }; 3];
        let mut answers = Vec::new();
        for _ in 0..ROUNDS {
            times[0].push(milliseconds(|| answers = cpu::run(&jobs)));
            let device = milliseconds(|| {
                block_on(gpu.propose(&sweeps, &mut proposals)).expect("proposals");
            });
            let open = jobs.iter().zip(&proposals).filter(|(_, p)| !p.is_free());
            let open: Vec<_> = open.map(|(job, _)| job).collect();
            times[1].push(device);
            times[2].push(device + milliseconds(|| drop(black_box(cpu::run(&open)))));
        }
        let apart = |s: ToiStatus| s == ToiStatus::Separated;
        let free = answers.iter().filter(|a| apart(a.toi.status)).count();
        let both = answers.iter().zip(&proposals);
        let wrong = both.filter(|(a, p)| p.is_free() && !apart(a.toi.status));
        assert_eq!(wrong.count(), 0, "free on the device, not on the CPU");
        let proven = proposals.iter().filter(|p| p.is_free()).count();
        let [a, b, c] = times.map(|mut t| median(&mut t));
        println!("{count:>30} {a:>7.2} {b:>7.2} {c:>15.2}   {free} / {proven}");
        println!("{:>30} {:?}", "", gpu.counts());
    }
}

fn main() {
    let options = GpuOptions {
        software: true,
        ..GpuOptions::default()
    };
    match block_on(Gpu::open(options)) {
        Ok(mut gpu) => {
            println!("{}; device: {}", processor(), gpu.name());
            elementary(&mut gpu);
            mesh_pairs(&mut gpu);
        }
        Err(error) => println!("SKIP: {error}"),
    }
}
