//! What a whole step costs, by what the bodies collide as: three of them fall on each other.

use crate::bodies::Bodies;
use crate::common::mesh::Mesh;
use crate::common::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::PI;
use std::time::Instant;

const COUNT: usize = 3;
/// Three seconds: they fall, meet, and lie on each other.
const STEPS: usize = 180;
/// How they come to lie is chance: so many times, turned otherwise.
const RUNS: u64 = 5;

/// Means over all steps of all runs.
pub struct Stack {
    /// Of a step.
    pub milliseconds: f64,
    /// Elementary tests of a step; none of other shapes than medial ones.
    pub tests: Option<f64>,
}

/// Drops copies of the flying body on each other, a few times.
pub fn stack(bodies: &Bodies, source: &Mesh) -> Stack {
    let runs: Vec<(f64, u64)> = (0..RUNS).map(|seed| run(bodies, source, seed)).collect();
    let steps = (RUNS as usize * STEPS) as f64;
    let tests = runs.iter().map(|run| run.1).sum::<u64>() as f64 / steps;
    Stack {
        milliseconds: runs.iter().map(|run| run.0).sum::<f64>() / steps,
        tests: bodies.is_medial().then_some(tests),
    }
}

/// Copies one above the other, every second one upside down: milliseconds and tests of all steps.
fn run(bodies: &Bodies, source: &Mesh, seed: u64) -> (f64, u64) {
    let mut world = PhysicsWorld::default();
    let ground = ColliderBuilder::cuboid(50.0, 0.5, 50.0).translation(Vector::NEG_Y * 0.5);
    world.insert_collider(ground, None);
    let mut random = Random(seed);
    let (low, high) = source.bounds();
    for k in 0..COUNT {
        let upside = Rotation::from_rotation_z(PI * (k % 2) as Real);
        let turn = Rotation::from_rotation_y(random.between(-PI, PI)) * upside;
        let middle = Vector::Y * ((k as Real + 0.52) * 1.1 * (high - low).y);
        let place = middle - turn * (0.5 * (low + high));
        let body = RigidBodyBuilder::dynamic().pose(Pose::from_parts(place, turn));
        world.insert(body, bodies.collider());
    }
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    if bodies.is_medial() {
        pipeline.attach(&mut world);
    }
    let mut tests = 0;
    let start = Instant::now();
    for _ in 0..STEPS {
        if bodies.is_medial() {
            tests += pipeline.step(&mut world).elementary_tests;
        } else {
            world.step();
        }
    }
    (1.0e3 * start.elapsed().as_secs_f64(), tests)
}
