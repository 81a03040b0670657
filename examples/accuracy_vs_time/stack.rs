//! What a whole step costs, by what the bodies collide as: three of them fall on each other.

use crate::bodies::Bodies;
use crate::common::mesh::Mesh;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::time::Instant;

const COUNT: usize = 3;
/// Three seconds: they fall, meet, and lie on each other.
const STEPS: usize = 180;

/// What the steps gave.
pub struct Stack {
    /// Of each step.
    pub milliseconds: Vec<f64>,
    /// Elementary tests of a step, mean; none of other shapes than medial ones.
    pub tests: Option<f64>,
}

/// Copies of the flying body one above the other, every second one upside down.
pub fn stack(bodies: &Bodies, source: &Mesh) -> Stack {
    let mut world = PhysicsWorld::default();
    let ground = ColliderBuilder::cuboid(50.0, 0.5, 50.0).translation(Vector::NEG_Y * 0.5);
    world.insert_collider(ground, None);
    let (low, high) = source.bounds();
    for k in 0..COUNT {
        let turn = Vector::Z * std::f32::consts::PI * (k % 2) as Real;
        let middle = Vector::Y * ((k as Real + 0.52) * 1.1 * (high - low).y);
        let turned = Pose::from_rotation(Rotation::from_scaled_axis(turn));
        let place = middle - turned.transform_point(0.5 * (low + high));
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(place, turn));
        world.insert(body, bodies.collider());
    }
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    if bodies.is_medial() {
        pipeline.attach(&mut world);
    }
    let mut tests = 0;
    let step = |_| {
        let start = Instant::now();
        if bodies.is_medial() {
            tests += pipeline.step(&mut world).elementary_tests;
        } else {
            world.step();
        }
        1.0e3 * start.elapsed().as_secs_f64()
    };
    let milliseconds = (0..STEPS).map(step).collect();
    Stack {
        milliseconds,
        tests: bodies.is_medial().then(|| tests as f64 / STEPS as f64),
    }
}
