//! Batches on the device beside the CPU, in the same run and in interleaved rounds: elementary tests
//! against the scalar kernel and eight lanes on one and two threads, all elementary tests of two
//! meshes of 1,236 primitives (the paper's reading), and pairs of such meshes against the search on the
//! CPU.
//!
//! `cargo bench --features gpu --bench gpu_batch`, with `-- --json FILE` the same figures as JSON. Any
//! adapter serves; its name is printed. The device's time includes packing, upload, one submission and
//! the answers; stage is its own account of the shader, where it has a clock, of a batch by itself.

#[allow(dead_code, reason = "no hash of results is printed here")]
mod common;
#[allow(dead_code, reason = "the creature; its scenes belong to another bench")]
#[path = "../tests/common/creature.rs"]
mod creature;

use common::{median, processor};
use creature::creature;
use pollster::block_on;
use rapier3d::math::{Pose, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions, Proposals};
use rapier3d_medial::batch::{Calibration, Job, Sweep, ToiJob, cpu};
use rapier3d_medial::elementary::bracket::{Limits, bracket};
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, for_each_test};
use rapier3d_medial::elementary::{ToiOptions, ToiStatus};
use rapier3d_medial::error::GpuError;
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::pair::PrimitiveTree;
use rapier3d_medial::{MedialMesh, MedialSphere};
use serde_json::{Value, json};
use std::hint::black_box;
use std::time::Instant;

/// Interleaved repetitions; the fastest of each counts, because other programs interrupt some.
const ROUNDS: usize = 7;

/// More of them where a batch takes a few milliseconds, which an interruption would double.
const SHORT_ROUNDS: usize = 70;
/// Tests in one batch where all tests of two meshes are asked: what the portable binding holds.
const CHUNK: usize = 1 << 19;

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
        size: 0.0,
    }
}

fn milliseconds(f: impl FnOnce()) -> f64 {
    let start = Instant::now();
    f();
    start.elapsed().as_secs_f64() * 1.0e3
}

const LIMITS: Limits<f32> = Limits {
    tolerance: 1.0e-4,
    time_tolerance: 1.0e-4,
    start: 0.0,
    horizon: 1.0,
    max_iterations: 64,
};

fn on_two_threads(paths: &[LinearPath<f32>]) {
    let (first, second) = paths.split_at(paths.len() / 2);
    let run = |part| {
        let found = brackets(part, Domain::Box, &LIMITS, Lanes::Fastest);
        drop(black_box(found));
    };
    std::thread::scope(|scope| {
        scope.spawn(|| run(first));
        run(second);
    });
}

fn least(times: Vec<f64>) -> f64 {
    times.into_iter().fold(f64::MAX, f64::min)
}

/// The device once as users have it and once with a clock, which takes time of its own.
struct Devices {
    gpu: Gpu,
    clocked: Gpu,
}

impl Devices {
    fn open() -> Result<Self, GpuError> {
        let open = |timed| {
            block_on(Gpu::open(GpuOptions {
                software: true,
                timed,
                ..GpuOptions::default()
            }))
        };
        Ok(Self {
            gpu: open(false)?,
            clocked: open(true)?,
        })
    }

    /// Milliseconds of the last batch in the shader.
    fn shader(&self) -> f64 {
        self.clocked.shader_seconds() * 1.0e3
    }
}

/// One test there and back.
fn round_trip(gpu: &mut Gpu) -> Value {
    let paths = [path(&mut Random(4))];
    let mut free = Vec::new();
    let mut times: Vec<f64> = (0..200)
        .map(|_| {
            let asked = gpu.prove(&paths, Domain::Box, LIMITS.tolerance, &mut free);
            milliseconds(|| block_on(asked).expect("proposals")) * 1.0e3
        })
        .collect();
    let middle = median(&mut times);
    println!(
        "round trip of one test: {middle:.0} µs, least {:.0}",
        times[0]
    );
    json!({ "median_us": middle, "least_us": times[0] })
}

fn elementary(devices: &mut Devices) -> Vec<Value> {
    println!(
        "cone-cone tests, ms       scalar   lanes  lanes x2  device   stage   proven of the free"
    );
    let row = |count: usize| {
        let mut random = Random(5);
        let paths: Vec<_> = (0..count).map(|_| path(&mut random)).collect();
        let mut free = Vec::new();
        let mut times = [const { Vec::new() }; 5];
        let rounds = if count <= 10_000 {
            SHORT_ROUNDS
        } else {
            ROUNDS
        };
        for _ in 0..rounds {
            let ask = async |gpu: &mut Gpu, free: &mut Vec<bool>| {
                gpu.prove(&paths, Domain::Box, LIMITS.tolerance, free).await
            };
            times[0].push(milliseconds(|| {
                for path in &paths {
                    black_box(bracket(path, Domain::Box, &LIMITS));
                }
            }));
            times[1].push(milliseconds(|| {
                black_box(brackets(&paths, Domain::Box, &LIMITS, Lanes::Fastest));
            }));
            times[2].push(milliseconds(|| on_two_threads(&paths)));
            times[3].push(milliseconds(|| {
                block_on(ask(&mut devices.gpu, &mut free)).expect("proposals");
            }));
            block_on(ask(&mut devices.clocked, &mut free)).expect("proposals");
            times[4].push(devices.shader());
        }
        let proven = free.iter().filter(|f| **f).count();
        let exact = brackets(&paths, Domain::Box, &LIMITS, Lanes::Fastest);
        let wrong = free.iter().zip(&exact);
        let wrong = wrong.filter(|(f, e)| **f && !e.separated);
        assert_eq!(wrong.count(), 0, "free on the device, not on the CPU");
        let [a, b, c, d, e] = times.map(least);
        let free = exact.iter().filter(|e| e.separated).count();
        println!("{count:>20} {a:>11.2} {b:>7.2} {c:>9.2} {d:>7.2} {e:>7.2}   {proven} of {free}");
        json!({
            "tests": count, "scalar_ms": a, "lanes_ms": b, "lanes_two_threads_ms": c,
            "device_ms": d, "stage_ms": e, "tests_per_second": count as f64 / d * 1.0e3,
            "proven": proven, "free": free,
        })
    };
    [1_000, 10_000, 100_000, 1_000_000].map(row).to_vec()
}

/// All elementary tests of two meshes, a straight approach; shared edges and spheres once.
fn every_test(devices: &mut Devices) -> Value {
    let mesh = creature();
    let place = |s: MedialSphere, second: bool| {
        let (at, by) = match second {
            true => (Vector::new(2.6, 0.0, 0.0), Vector::new(-1.0, 0.0, 0.0)),
            false => (Vector::ZERO, Vector::ZERO),
        };
        (
            Vec3::from_vector(s.center + at),
            Vec3::from_vector(by),
            s.radius,
        )
    };
    let mut lists = [(Domain::Box, Vec::new()), (Domain::Triangle, Vec::new())];
    let (mut all, mut proven, mut on_cpu, mut on_device, mut stage) = (0, 0, 0.0, 0.0, 0.0);
    let mut free: Vec<bool> = Vec::new();
    let mut ask = |domain, paths: &mut Vec<LinearPath<f32>>| {
        on_cpu +=
            milliseconds(|| drop(black_box(brackets(paths, domain, &LIMITS, Lanes::Fastest))));
        let asked = devices
            .gpu
            .prove(paths, domain, LIMITS.tolerance, &mut free);
        on_device += milliseconds(|| block_on(asked).expect("proposals"));
        let asked = devices
            .clocked
            .prove(paths, domain, LIMITS.tolerance, &mut free);
        block_on(asked).expect("proposals");
        stage += devices.shader();
        all += paths.len();
        proven += free.iter().filter(|f| **f).count();
        paths.clear();
    };
    let count = mesh.primitive_count() as u32;
    for i in 0..count {
        let (a, share_a) = PrimitiveTree::primitive(&mesh, i);
        for j in 0..count {
            let (b, share_b) = PrimitiveTree::primitive(&mesh, j);
            for_each_test(share_a, share_b, |test| {
                let path = LinearPath::new(&test, 0.0, |second, k| {
                    place(if second { b } else { a }[k as usize], second)
                });
                lists[usize::from(test.domain == Domain::Triangle)]
                    .1
                    .push(path);
                true
            });
        }
        for (domain, paths) in &mut lists {
            if paths.len() > CHUNK {
                ask(*domain, paths);
            }
        }
    }
    lists
        .iter_mut()
        .for_each(|(domain, paths)| ask(*domain, paths));
    // The same approach with culling on the device.
    let still = NonlinearRigidMotion::identity();
    let sweep = Sweep {
        meshes: [&mesh; 2],
        motions: [
            still,
            NonlinearRigidMotion {
                start: Pose::translation(2.6, 0.0, 0.0),
                linvel: Vector::new(-1.0, 0.0, 0.0),
                ..still
            },
        ],
        seconds: 1.0,
        reach: f64::from(LIMITS.tolerance),
        lists: false,
    };
    let mut proposals = Proposals::default();
    let sweeps = [sweep];
    let culled = (0..ROUNDS).map(|_| {
        let asked = devices.gpu.propose(&sweeps, &mut proposals);
        milliseconds(|| block_on(asked).expect("a proposal"))
    });
    let culled = least(culled.collect());
    println!("with culling, ms: device {culled:.2}, {:?}", &proposals[..]);
    println!(
        "all {all} elementary tests of two meshes, ms: lanes {on_cpu:.0}, device {on_device:.0}, stage {stage:.0}; {proven} proven free"
    );
    json!({
        "tests": all, "lanes_ms": on_cpu, "device_ms": on_device, "stage_ms": stage, "proven": proven,
        "culled_device_ms": culled,
    })
}

fn toi_jobs(mesh: &MedialMesh, count: usize) -> Vec<ToiJob> {
    let mut random = Random(6);
    let job = |_| {
        let away = random.vector().normalize_or_zero();
        let mut at = |p: Vector, v: Vector| {
            let pose = Pose::new(p, random.vector() * 3.0);
            NonlinearRigidMotion::new(pose, Vector::ZERO, v, random.vector() * 3.0)
        };
        ToiJob {
            mesh1: mesh.clone(),
            motion1: at(Vector::ZERO, Vector::ZERO),
            mesh2: mesh.clone(),
            motion2: at(away * 1.9, away * -12.0),
            seconds: creature::SECONDS,
            options: ToiOptions::default(),
        }
    };
    (0..count).map(job).collect()
}

fn mesh_pairs(devices: &mut Devices) -> Vec<Value> {
    println!(
        "mesh pairs of 1,236 x 1,236, ms    CPU  CPU x2  device  device and CPU   stage   device to CPU x2, least and median   proven of the free"
    );
    let mesh = creature();
    let row = |count: usize| {
        let jobs = toi_jobs(&mesh, count);
        let sweeps: Vec<_> = jobs.iter().filter_map(Job::sweep).collect();
        let mut proposals = Proposals::default();
        let mut times = [const { Vec::new() }; 5];
        let mut answers = Vec::new();
        let before = devices.gpu.counts().given_up;
        for _ in 0..SHORT_ROUNDS {
            times[0].push(milliseconds(|| answers = cpu::run(&jobs)));
            times[3].push(milliseconds(|| {
                let (first, second) = jobs.split_at(jobs.len() / 2);
                std::thread::scope(|scope| {
                    scope.spawn(|| drop(black_box(cpu::run(first))));
                    drop(black_box(cpu::run(second)));
                });
            }));
            let device = milliseconds(|| {
                block_on(devices.gpu.propose(&sweeps, &mut proposals)).expect("proposals");
            });
            let asked = devices.clocked.propose(&sweeps, &mut proposals);
            block_on(asked).expect("proposals");
            times[4].push(devices.shader());
            let open = jobs
                .iter()
                .zip(proposals.iter())
                .filter(|(_, p)| !p.is_free());
            let open: Vec<_> = open.map(|(job, _)| job).collect();
            times[1].push(device);
            times[2].push(device + milliseconds(|| drop(black_box(cpu::run(&open)))));
        }
        let apart = |s: ToiStatus| s == ToiStatus::Separated;
        let free = answers.iter().filter(|a| apart(a.toi.status)).count();
        let both = answers.iter().zip(proposals.iter());
        let wrong = both.filter(|(a, p)| p.is_free() && !apart(a.toi.status));
        assert_eq!(wrong.count(), 0, "free on the device, not on the CPU");
        let proven = proposals.iter().filter(|p| p.is_free()).count();
        let [_, middle, _, middle_two, _] = times.each_mut().map(|t| median(t));
        let [a, b, c, two, stage] = times.map(least);
        let ratios = [b / two, middle / middle_two];
        let given_up = (devices.gpu.counts().given_up - before) / SHORT_ROUNDS as u64;
        println!(
            "{count:>30} {a:>7.2} {two:>7.2} {b:>7.2} {c:>15.2} {stage:>7.2} {:>18.2} {:>18.2}   {proven} of {free}, {given_up} given up",
            ratios[0], ratios[1]
        );
        json!({
            "mesh_pairs": count, "cpu_ms": a, "cpu_two_threads_ms": two, "device_ms": b, "device_and_cpu_ms": c,
            "cpu_two_threads_median_ms": middle_two, "device_median_ms": middle,
            "stage_ms": stage, "proven": proven, "free": free, "given_up": given_up,
        })
    };
    [1, 4, 16, 64, 256].map(row).to_vec()
}

fn main() {
    let mut arguments = std::env::args().skip_while(|a| a != "--json").skip(1);
    let mut devices = match Devices::open() {
        Ok(devices) => devices,
        Err(error) => return println!("SKIP: {error}"),
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!(
        "{}, {threads} threads; device: {}",
        processor(),
        devices.gpu.name()
    );
    let round_trip = round_trip(&mut devices.gpu);
    let elementary = elementary(&mut devices);
    let every_test = every_test(&mut devices);
    let mesh_pairs = mesh_pairs(&mut devices);
    let calibration = Calibration::measure(&mut devices.gpu, &creature()).expect("a calibration");
    print!("{calibration}");
    let figures = json!({
        "processor": processor(), "threads": threads, "adapter": devices.gpu.name(),
        "driver": devices.gpu.driver(), "hardware": devices.gpu.is_hardware(),
        "features": if cfg!(feature = "parallel") { "gpu, parallel" } else { "gpu" },
        "round_trip": round_trip, "elementary": elementary, "every_test": every_test,
        "mesh_pairs": mesh_pairs,
        "pays_from": { "jobs": calibration.jobs, "tests": calibration.tests },
    });
    if let Some(path) = arguments.next() {
        std::fs::write(&path, format!("{figures:#}\n")).expect("a file to write to");
    }
}
