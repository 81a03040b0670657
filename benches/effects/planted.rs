//! Scenes in which the answer is planted: heavy loads, fast turns, landings with both ends at once.

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

/// A light rod lies on the ground, and one 10,000 times as heavy is laid across it: how deep they get into each other,
/// of the radii of both.
fn loaded(random: &mut Random, stepper: Stepper) -> Real {
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(2.0, 0.5, 2.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground, None);
    let bar = rod(0.2, Vector::Z, 0.05);
    let light = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.05);
    let light = world.insert(light, medial(&bar)).0;
    let at = Vector::Y * random.within(0.151, 0.16);
    let turn = Vector::Y * random.within(0.8, 1.6);
    let heavy = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
    let heavy = world.insert(heavy, medial(&bar).density(1.0e4)).0;
    let mut stage = Stage::new(world, stepper);
    let axis = Segment::new(Vector::Z * -0.2, Vector::Z * 0.2);
    let mut nearest: Real = 0.1;
    for _ in 0..90 {
        stage.step();
        let [a, b] = [light, heavy].map(|h| *stage.world.bodies[h].position());
        let apart = distance(&a, &axis, &b, &axis).expect("two segments");
        nearest = nearest.min(apart.distance);
    }
    1.0 - nearest / 0.1
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

/// One row: the mean depth of loads in per cent, balls overlooked, and the mean depth of landings in per cent.
fn row(seed: u64, stepper: Stepper) -> String {
    let mut random = Random(seed);
    let mean = |random: &mut Random, depth: fn(&mut Random, Stepper) -> Real| {
        let sum: Real = (0..CASES).map(|_| depth(random, stepper)).sum();
        100.0 * sum / CASES as Real
    };
    let deep = mean(&mut random, loaded);
    let missed = (0..CASES)
        .filter(|_| overlooked(&mut random, stepper))
        .count();
    let landing = mean(&mut random, sunk);
    format!("{deep:.0} | {missed} | {landing:.1}")
}

/// Prints the table.
pub fn table(rows: &[(&str, Stepper)]) {
    println!("\nPlanted, {CASES} cases each\n");
    println!(
        "| | depth of heavy loads, % of the radii | balls overlooked by a turning rod | depth of flat landings, % of the radii |"
    );
    println!("|---|---|---|---|");
    for (name, stepper) in rows {
        println!("| {name} | {} |", row(7_501, *stepper));
    }
}
