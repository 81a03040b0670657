//! Many small worlds that share one GPU: the contacts of the next step of all of them are one submission. Each world is
//! the same, bit by bit, as when it is stepped by itself on the CPU, which is checked after every step.
//!
//! ```text
//! cargo run --release --features gpu --example many_worlds
//! cargo run --release --features gpu --example many_worlds -- --worlds 1000 --steps 60
//! ```
//! Options: `--worlds N` (default 256), `--steps N` (default 120), `--hardware` (takes no adapter that is itself code
//! on the CPU). Exits with 1 when a world differs from itself alone.

mod common;

use common::arguments::{Arguments, example};
use rapier3d::prelude::*;
use rapier3d_medial::batch::Batch;
use rapier3d_medial::prelude::*;
use std::num::NonZeroUsize;
use std::process::ExitCode;

/// Rings in each world.
const RINGS: usize = 6;

struct Options {
    worlds: usize,
    steps: usize,
    backend: Backend,
}

/// One world twice: with contacts from the shared GPU, and alone on the CPU.
struct Twins {
    worlds: [PhysicsWorld; 2],
    pipelines: [MedialPipeline; 2],
}

impl Twins {
    /// Rings that fall in a heap, tilted otherwise in each world.
    fn new(ring: &MedialMesh, number: usize) -> Self {
        let world = || {
            let mut world = PhysicsWorld::new();
            world.insert_collider(ColliderBuilder::cuboid(9.0, 0.5, 9.0), None);
            for k in 0..RINGS {
                let turn = 0.37 * (number * RINGS + k) as Real;
                let at = Vector::new(0.1 * turn.sin(), 0.9 + 0.4 * k as Real, 0.1 * turn.cos());
                let tilt = Vector::new(turn.sin(), 0.3 * turn, turn.cos());
                let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, tilt));
                world.insert(body, ColliderBuilder::medial_mesh(ring.clone()));
            }
            world
        };
        Self {
            worlds: [world(), world()],
            pipelines: [(); 2].map(|()| MedialPipeline::default()),
        }
    }

    fn step(&mut self) -> [StepReport; 2] {
        let [a, b] = &mut self.worlds;
        let [shared, alone] = &mut self.pipelines;
        [shared.step(a), alone.step(b)]
    }

    fn are_equal(&self) -> bool {
        let [a, b] = self.worlds.each_ref().map(|world| {
            let numbers = |b: &RigidBody| {
                let (pose, v, w) = (b.position(), b.linvel(), b.angvel());
                let [t, v, w] = [pose.translation, v, w].map(|v| v.to_array().map(Real::to_bits));
                (t, pose.rotation.to_array().map(Real::to_bits), v, w)
            };
            let all = world.bodies.iter().map(|(_, body)| numbers(body));
            all.collect::<Vec<_>>()
        });
        a == b
    }
}

fn main() -> ExitCode {
    let options = |arguments: &mut Arguments| {
        let count = |n: Option<NonZeroUsize>, default| n.map_or(default, NonZeroUsize::get);
        Ok(Options {
            worlds: count(arguments.value("--worlds")?, 256),
            steps: count(arguments.value("--steps")?, 120),
            backend: match arguments.flag("--hardware") {
                true => Backend::Auto,
                false => Backend::Gpu,
            },
        })
    };
    example(options, run)
}

fn run(options: Options) -> Result<(), String> {
    let ring = MedialMesh::torus(0.5, 0.1, 16).map_err(|e| e.to_string())?;
    let mut twins: Vec<_> = (0..options.worlds).map(|n| Twins::new(&ring, n)).collect();
    let mut batch = Batch::new(options.backend);
    match batch.gpu() {
        Some(gpu) => println!(
            "{} worlds of {RINGS} rings on {}",
            options.worlds,
            gpu.name()
        ),
        None => println!("no GPU, all on the CPU: {:?}", batch.report().error),
    }
    let (mut jobs, mut early, mut free, mut wrong) = (0, 0, 0, 0);
    for _ in 0..options.steps {
        let all = twins
            .iter_mut()
            .map(|twins| (&mut twins.pipelines[0], &twins.worlds[0]));
        pollster::block_on(MedialPipeline::prepare_many(&mut batch, all));
        for twins in &mut twins {
            let [report, _] = twins.step();
            jobs += report.jobs;
            early += report.batch.sent_early;
            free += report.batch.settled_by_gpu;
            wrong += usize::from(!twins.are_equal());
        }
    }
    let listed = twins
        .iter()
        .map(|t| t.pipelines[0].batch().report().counts.listed);
    let listed: u64 = listed.sum();
    let report = batch.report().counts;
    println!(
        "{} steps of each: {jobs} pairs, {early} of them sent in {} submissions; {free} free, {listed} listed, {} given up",
        options.steps, report.submissions, report.given_up,
    );
    match wrong {
        0 => Ok(()),
        _ => Err(format!(
            "{wrong} steps ended otherwise than in the world alone"
        )),
    }
}
