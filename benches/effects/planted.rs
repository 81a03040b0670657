//! Scenes in which the answer is planted: slow presses, fast turns, landings with both ends at once.

use crate::random::Random;
use crate::scenes::{Stage, Stepper, medial};
use rapier3d::parry::query::distance;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Cases of each kind.
const CASES: u32 = 64;

fn rod(half: Real, axis: Vector, radius: Real) -> MedialMesh {
    MedialMesh::capsule(axis * half, axis * -half, radius).expect("a rod")
}

fn floating() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    world
}

/// A free rod lies before a wall, a driven one comes across it, slowly, and goes on: whether their axes
/// cross. They come nearer by at most 9 mm in a step, so in one of them they are 5 mm apart or less.
fn pressed(random: &mut Random, stepper: Stepper) -> bool {
    let mut world = floating();
    let wall = ColliderBuilder::cuboid(0.5, 2.0, 2.0).translation(Vector::new(-0.56, 0.0, 0.0));
    world.insert_collider(wall, None);
    let bar = rod(0.2, Vector::Z, 0.05);
    let free = RigidBodyBuilder::dynamic();
    let free = world.insert(free, medial(&bar)).0;
    let turn = Vector::X * random.within(0.8, 1.6);
    let driven = RigidBodyBuilder::kinematic_velocity_based()
        .pose(Pose::new(Vector::X * random.within(0.11, 0.14), turn))
        .linvel(Vector::X * -random.within(0.2, 0.5));
    let driven = world.insert(driven, medial(&bar)).0;
    let mut stage = Stage::new(world, stepper);
    let axis = Segment::new(Vector::Z * -0.2, Vector::Z * 0.2);
    let mut nearest = Real::MAX;
    for _ in 0..90 {
        stage.step();
        let [a, b] = [free, driven].map(|h| *stage.world.bodies[h].position());
        let apart = distance(&a, &axis, &b, &axis).expect("two segments");
        nearest = nearest.min(apart.distance);
    }
    nearest <= 5.0e-3
}

/// A rod turns by more than a radian in a step, through a ball that lies in its way: whether the ball stays
/// untouched.
fn overlooked(random: &mut Random, stepper: Stepper) -> bool {
    let mut world = floating();
    let turn = random.within(1.2, 1.5);
    let body = RigidBodyBuilder::dynamic().angvel(Vector::Y * turn * 60.0);
    let collider = medial(&rod(1.0, Vector::X, 0.03));
    let body = world.insert(body, collider).0;
    world.bodies[body].set_allow_fast_rotation(true);
    let (sin, cos) = (turn * random.within(0.3, 0.7)).sin_cos();
    let at = Vector::new(cos, 0.0, -sin) * random.within(0.6, 0.98);
    let ball = RigidBodyBuilder::dynamic().translation(at);
    let mesh = MedialMesh::ball(0.04).expect("a ball");
    let ball = world.insert(ball, medial(&mesh)).0;
    let mut stage = Stage::new(world, stepper);
    stage.step();
    stage.world.bodies[ball].linvel() == Vector::ZERO
}

/// Two equal rods land on each other flat, without a bounce: how deep the ends get, of the radii of both.
fn sunk(random: &mut Random, stepper: Stepper) -> Real {
    let mut world = floating();
    let speed = random.within(10.0, 40.0);
    let apart = 0.1 + speed / 60.0 * random.within(1.5, 2.5);
    let bar = rod(0.5, Vector::Z, 0.1);
    let pair = [-1.0, 1.0].map(|side| {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::X * side * apart)
            .linvel(Vector::X * -side * speed);
        world.insert(body, medial(&bar)).0
    });
    let mut stage = Stage::new(world, stepper);
    let mut least: Real = 0.2;
    for _ in 0..6 {
        stage.step();
        for z in [-0.5, 0.5] {
            let ends = pair.map(|h| stage.world.bodies[h].position() * (Vector::Z * z));
            least = least.min(ends[1].x - ends[0].x);
        }
    }
    1.0 - least / 0.2
}

/// One row: presses passed, balls overlooked, and the mean depth of landings in per cent.
fn row(seed: u64, stepper: Stepper) -> String {
    let mut random = Random(seed);
    let count = |random: &mut Random, wrong: fn(&mut Random, Stepper) -> bool| {
        (0..CASES).filter(|_| wrong(random, stepper)).count()
    };
    let passed = count(&mut random, pressed);
    let missed = count(&mut random, overlooked);
    let depth: Real = (0..CASES).map(|_| sunk(&mut random, stepper)).sum();
    format!("{passed} | {missed} | {:.1}", 100.0 * depth / CASES as Real)
}

/// Prints the table.
pub fn table(rows: &[(&str, Stepper)]) {
    println!("\nPlanted, {CASES} cases each\n");
    println!(
        "| | slow presses crossed | balls overlooked by a turning rod | depth of flat landings, % of the radii |"
    );
    println!("|---|---|---|---|");
    for (name, stepper) in rows {
        println!("| {name} | {} |", row(7_501, *stepper));
    }
}
