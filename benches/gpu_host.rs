//! The host's share of contacts when a device lists the primitives that are near: processor time of the calling thread
//! per step, waiting left out, beside the same contacts on the CPU alone. A device that is itself code on the CPU
//! serves too, since it runs on threads of its own.
//!
//! `cargo bench --features gpu --bench gpu_host`, with `-- --json FILE` the same figures as JSON. A world on the CPU
//! gives the poses. Of each step all pairs of near boxes are asked for, some times on each side in turn; *contacts* is
//! what a batch takes on the CPU, *host* what sending it, and finishing it by the lists, takes on the same thread. Then
//! the world is stepped on both backends: *step* is all of `MedialPipeline::step`, and *wall* its time on the clock,
//! waiting included; with `parallel` all times are the clock's. `--scene TEXT` measures the scenes whose name contains
//! the text, and only so that of 10,000 bodies.

#[allow(dead_code, reason = "no hash of results is printed here")]
mod common;
#[allow(dead_code, reason = "the creature; its scenes belong to another bench")]
#[path = "../tests/common/creature.rs"]
mod creature;
#[allow(dead_code, reason = "two of its forms")]
#[path = "../tests/common/detailed.rs"]
mod detailed;

use common::{median, processor};
use cpu_time::ThreadTime;
use detailed::{Form, detailed};
use parry3d::bounding_volume::BoundingVolume;
use rapier3d::prelude::*;
use rapier3d_medial::batch::{Batch, PairJob, cpu};
use rapier3d_medial::prelude::*;
use serde_json::{Value, json};
use std::hint::black_box;
use std::time::Instant;

/// Distance up to which contacts are asked for, a length: about what pairs at rest get.
const PREDICTION: Real = 0.01;

/// Times that the contacts of a step are asked for.
const ROUNDS: usize = 3;

/// A scene, and its steps before the first that is measured.
struct Scene {
    name: &'static str,
    mesh: MedialMesh,
    /// How many bodies, and how many of them side by side in a row.
    count: usize,
    side: usize,
    /// Distance of neighbours, and of layers.
    apart: [Real; 2],
    settle: usize,
    steps: usize,
}

fn scenes() -> Vec<Scene> {
    let ring = MedialMesh::torus(0.5, 0.1, 27).expect("a ring");
    let scene = |name, mesh, [count, side, settle, steps]: [usize; 4], apart| Scene {
        name,
        mesh,
        count,
        side,
        apart,
        settle,
        steps,
    };
    vec![
        scene(
            "200 rings of 27 cones",
            ring.clone(),
            [200, 6, 240, 40],
            [1.4, 0.5],
        ),
        scene(
            "1,000 rings of 27 cones",
            ring,
            [1000, 10, 120, 10],
            [1.4, 0.5],
        ),
        scene(
            "10,000 rings of 27 cones",
            MedialMesh::torus(0.5, 0.1, 27).expect("a ring"),
            [10_000, 32, 100, 10],
            [1.4, 0.5],
        ),
        scene(
            "60 bears of 200 primitives, falling",
            detailed(Form::Bear, 200),
            [60, 3, 60, 20],
            [2.6, 1.5],
        ),
        scene(
            "60 spiders of 200 primitives, falling",
            detailed(Form::Spider, 200),
            [60, 3, 60, 20],
            [2.6, 0.8],
        ),
        scene(
            "2 of 1,236 primitives",
            creature::creature(),
            [2, 1, 50, 20],
            [1.4, 0.7],
        ),
    ]
}

impl Scene {
    /// Bodies in layers of a square, tilted one by one, in a pen as wide as the square.
    fn world(&self) -> PhysicsWorld {
        let mut world = PhysicsWorld::default();
        let half = 0.5 * self.apart[0] * (self.side as Real + 0.1);
        let wall = |x: Real, y: Real, z: Real, at: Vector| {
            ColliderBuilder::cuboid(x, y, z).translation(at)
        };
        world.insert_collider(wall(50.0, 0.5, 50.0, Vector::NEG_Y * 0.5), None);
        for axis in [Vector::X, Vector::NEG_X] {
            world.insert_collider(wall(0.5, 60.0, 50.0, axis * (half + 0.5)), None);
        }
        for axis in [Vector::Z, Vector::NEG_Z] {
            world.insert_collider(wall(50.0, 60.0, 0.5, axis * (half + 0.5)), None);
        }
        let collider = ColliderBuilder::medial_mesh(self.mesh.clone());
        for k in 0..self.count {
            let (layer, place) = (k / self.side.pow(2), k % self.side.pow(2));
            let at = |i: usize| (i as Real - 0.5 * (self.side - 1) as Real) * self.apart[0];
            let height = 0.6 + self.apart[1] * (1 + layer) as Real;
            let center = Vector::new(at(place % self.side), height, at(place / self.side));
            let tilt = Vector::new(0.3, 0.0, 0.2) * ((k % 7) as Real - 3.0);
            let body = RigidBodyBuilder::dynamic().pose(Pose::new(center, tilt));
            world.insert(body.can_sleep(false), collider.clone());
        }
        world
    }
}

/// All pairs of medial colliders whose boxes are within the prediction distance.
fn jobs(world: &PhysicsWorld) -> Vec<PairJob> {
    let medial = world.colliders.iter().filter_map(|(_, c)| {
        let mesh = c.shape().as_shape::<MedialMesh>()?;
        Some((
            mesh,
            c.position(),
            c.compute_aabb().loosened(0.5 * PREDICTION),
        ))
    });
    let all: Vec<_> = medial.collect();
    let mut jobs = Vec::new();
    for (k, (mesh1, pose1, box1)) in all.iter().enumerate() {
        for (mesh2, pose2, box2) in &all[k + 1..] {
            if box1.intersects(box2) {
                jobs.push(PairJob {
                    mesh1: (*mesh1).clone(),
                    mesh2: (*mesh2).clone(),
                    pos12: pose1.inv_mul(pose2),
                    prediction: PREDICTION,
                });
            }
        }
    }
    jobs
}

/// Milliseconds of processor time of this thread; on the clock with `parallel`, where others do its work.
fn processor_time<T>(f: impl FnOnce() -> T) -> f64 {
    let (clock, thread) = (Instant::now(), ThreadTime::now());
    black_box(f());
    let time = if cfg!(feature = "parallel") {
        clock.elapsed()
    } else {
        thread.elapsed()
    };
    time.as_secs_f64() * 1.0e3
}

fn bits(world: &PhysicsWorld) -> Vec<u32> {
    let each = |b: &RigidBody| b.translation().to_array().map(Real::to_bits);
    world.bodies.iter().flat_map(|(_, b)| each(b)).collect()
}

fn pipeline(backend: Backend) -> MedialPipeline {
    let mut options = MedialOptions::default();
    options.backend = backend;
    MedialPipeline::new(options)
}

fn measure(scene: &Scene, batch: &mut Batch) -> Value {
    let [mut world, mut twin] = [scene.world(), scene.world()];
    let [mut on_cpu, mut on_device] = [Backend::Cpu, Backend::Gpu].map(pipeline);
    for _ in 0..scene.settle {
        on_cpu.step(&mut world);
        on_device.step(&mut twin);
    }
    let mut times = [const { Vec::new() }; 7];
    let (mut pairs, mut found) = (0, 0);
    let before = batch.report().clone();
    for _ in 0..scene.steps {
        for (k, (pipeline, world)) in [(&mut on_cpu, &mut world), (&mut on_device, &mut twin)]
            .into_iter()
            .enumerate()
        {
            let start = Instant::now();
            times[3 + k].push(processor_time(|| pipeline.step(world).contacts));
            times[5 + k].push(start.elapsed().as_secs_f64() * 1.0e3);
        }
        assert!(bits(&world) == bits(&twin), "another world on the device");
        let jobs = jobs(&world);
        let mut expected = Vec::new();
        // Of which the first meets cold caches.
        for _ in 0..ROUNDS {
            let send = processor_time(|| batch.submit(&jobs));
            let mut answers = Vec::new();
            let finish = processor_time(|| answers = batch.run(&jobs));
            let contacts = processor_time(|| expected = cpu::run(&jobs));
            for (a, b) in answers.iter().zip(&expected) {
                assert_eq!(a.contacts, b.contacts);
            }
            drop(black_box(answers));
            for (times, time) in times.iter_mut().zip([contacts, send, finish]) {
                times.push(time);
            }
        }
        pairs += jobs.len();
        found += expected.iter().map(|e| e.contacts.len()).sum::<usize>();
    }
    let after = batch.report();
    let share = |count: u64| count as f64 / (ROUNDS * pairs) as f64;
    let listed = share(after.counts.listed - before.counts.listed);
    let free = share(after.counts.settled_by_gpu - before.counts.settled_by_gpu);
    let [
        contacts,
        send,
        finish,
        step_cpu,
        step_device,
        wall_cpu,
        wall_device,
    ] = times.each_mut().map(|t| median(t));
    let each = |count: usize| count as f64 / scene.steps as f64;
    println!(
        "{:<40} {:>6.0} pairs, {:>6.0} contacts, {free:.2} free, {listed:.2} listed; ms: contacts {contacts:.3}, host {:.3} = {send:.3} + {finish:.3}, ratio {:.2}; step {step_cpu:.3} and {step_device:.3}, wall {wall_cpu:.3} and {wall_device:.3}",
        scene.name,
        each(pairs),
        each(found),
        send + finish,
        (send + finish) / contacts,
    );
    json!({
        "scene": scene.name, "pairs": each(pairs), "contacts": each(found), "free": free, "listed": listed,
        "contacts_ms": contacts, "send_ms": send, "finish_ms": finish,
        "ratio": (send + finish) / contacts,
        "step_cpu_ms": step_cpu, "step_device_ms": step_device,
        "wall_cpu_ms": wall_cpu, "wall_device_ms": wall_device,
    })
}

fn main() {
    let argument = |name: &str| std::env::args().skip_while(|a| a != name).nth(1);
    let mut batch = Batch::new(Backend::Gpu);
    let Some(gpu) = batch.gpu() else {
        return println!("SKIP: {:?}", batch.report().error);
    };
    let adapter = gpu.name().to_owned();
    println!("{}; device: {adapter}", processor());
    let only = argument("--scene").unwrap_or_default();
    let scenes = scenes();
    let wanted = scenes.iter().filter(|s| {
        let large = s.count >= 10_000 && only.is_empty();
        s.name.contains(&only) && !large
    });
    let rows: Vec<Value> = wanted.map(|scene| measure(scene, &mut batch)).collect();
    let figures = json!({ "processor": processor(), "adapter": adapter, "host": rows });
    if let Some(path) = argument("--json") {
        std::fs::write(&path, format!("{figures:#}\n")).expect("a file to write to");
    }
}
