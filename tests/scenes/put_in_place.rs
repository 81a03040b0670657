//! Bodies that are in each other because they were something else the step before: from then on they come apart as
//! rapier's own do.

use crate::bodies::attached;
use crate::changed_shapes::{Heap, heap};
use crate::let_go::let_go;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Heaps of [`bodies_that_get_another_shape_in_each_other_come_apart`].
const SEEDS: u64 = 24;

/// The heap of these in which a pair hangs in each other in the end (`tests/known_issues.rs`).
const HANGS: u64 = 20;

/// Symptom: a pair that was deep because a body had got another shape was held by the event loop for ever, two or three
/// bodies in each step. In the same heaps rapier's own are 1.0 to 6.9 mm in each other in the end, 1.87 in the mean of
/// these seeds; they are not stepped here because rapier panics in debug builds when a compound in contact gets another
/// shape (`tests/known_issues.rs`).
#[test]
fn bodies_that_get_another_shape_in_each_other_come_apart() {
    let mut sum = 0.0;
    for seed in (0..SEEDS).filter(|seed| *seed != HANGS) {
        let Heap { depth, frozen } = heap(seed);
        println!("seed {seed}: {depth} m deep, held {frozen} times");
        assert!(depth < 0.0069, "seed {seed}: {depth} m deep");
        assert!(frozen < 10, "seed {seed}: held {frozen} times");
        sum += depth;
    }
    let mean = sum / (SEEDS - 1) as Real;
    assert!(mean < 0.00187, "{mean} m deep in the mean");
}

/// Symptom: what a joint without contacts had held in each other was held so by the event loop once the joint was gone.
#[test]
fn bodies_that_a_joint_lets_go_of_in_each_other_come_apart() {
    for seed in 0..8 {
        let [ours, own] = [true, false].map(|medial| let_go(medial, false, seed));
        println!("seed {seed}: {ours} m deep, rapier's own {own}");
        assert!(ours < own.max(0.0) + 0.002, "seed {seed}: {ours} m, {own}");
    }
}

/// The most energy that a brick gains in a step, J/kg, after it was put across a floor 0.3 m thick on which it lay, and
/// whether it is still in the floor six seconds later.
fn across_a_floor(medial: bool, seed: u64) -> (Real, bool) {
    let half = Vector::new(0.3, 0.2, 0.1);
    let shape = match medial {
        true => SharedShape::medial_mesh(MedialMesh::cuboid(half).expect("a brick")),
        false => SharedShape::cuboid(half.x, half.y, half.z),
    };
    let mut random = crate::random::Random(seed);
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let floor = ColliderBuilder::cuboid(9.0, 0.15, 9.0).translation(Vector::NEG_Y * 0.15);
    world.insert_collider(floor, None);
    let pose = Pose::new(Vector::Y * 0.6, random.direction() * 3.0);
    let body = RigidBodyBuilder::dynamic().pose(pose).can_sleep(false);
    let (body, collider) = world.insert(body, ColliderBuilder::new(shape));
    let mut most: Real = 0.0;
    let mut before: Real = 0.0;
    for step in 0..480 {
        if step == 120 {
            let below = Vector::new(0.0, -0.3, 0.0) + random.direction() * 0.1;
            let body = &mut world.bodies[body];
            let put = Pose::new(body.translation() + below, random.direction() * 0.5);
            body.set_position(put * Pose::from_rotation(*body.rotation()), true);
        }
        match medial {
            true => _ = pipeline.step(&mut world),
            false => world.step(),
        }
        let body = &world.bodies[body];
        let height = body.translation().y;
        let energy = body.kinetic_energy() / body.mass() + 9.81 * height;
        if step > 122 {
            most = most.max(energy - before);
        }
        before = energy;
    }
    let aabb = world.colliders[collider].compute_aabb();
    (most, aabb.mins.y < -0.02 && aabb.maxs.y > -0.28)
}

/// Symptom: slabs of the brick that are out sooner above the floor and others that are out sooner below pulled it to
/// and fro, and threw it, by up to 57 J/kg. rapier's own cuboids gain nothing.
#[test]
fn a_brick_put_across_a_thin_floor_is_not_thrown() {
    let mut stay = [0; 2];
    for seed in 0..24 {
        let ends = [true, false].map(|medial| across_a_floor(medial, seed));
        let [ours, own] = ends.map(|end| end.0);
        println!("seed {seed}: gains {ours} J/kg, rapier's own {own}");
        assert!(ours < own.max(0.5), "seed {seed}: {ours} J/kg, {own}");
        for (stay, end) in stay.iter_mut().zip(ends) {
            *stay += usize::from(end.1);
        }
    }
    println!("{stay:?} are still in the floor");
    assert!(stay[0] <= stay[1], "{stay:?} are still in the floor");
}

/// Two plates that cross come apart within two seconds after one that was disabled is enabled. Its collider was enabled
/// the step before, so that rapier had contacts of the two already.
#[test]
fn a_body_enabled_after_its_collider_in_another_comes_out() {
    let half = Vector::new(0.4, 0.05, 0.3);
    let plate = SharedShape::medial_mesh(MedialMesh::cuboid(half).expect("a plate"));
    let own = SharedShape::cuboid(half.x, half.y, half.z);
    for seed in 0..8 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let mut random = crate::random::Random(seed);
        let bodies = [0, 1].map(|k| {
            let pose = Pose::new(random.direction() * 0.1, random.direction() * 3.0);
            let body = RigidBodyBuilder::dynamic().pose(pose).enabled(k == 0);
            let collider = ColliderBuilder::new(plate.clone());
            world.insert(body, collider.enabled(k == 0))
        });
        for _ in 0..10 {
            pipeline.step(&mut world);
        }
        world.colliders[bodies[1].1].set_enabled(true);
        pipeline.step(&mut world);
        world.bodies[bodies[1].0].set_enabled(true);
        let mut frozen = 0;
        for _ in 0..120 {
            frozen += pipeline.step(&mut world).frozen;
        }
        let [p, q] = bodies.map(|(body, _)| *world.bodies[body].position());
        let contact = rapier3d::parry::query::contact(&p, &*own, &q, &*own, 0.0);
        let depth = contact.expect("rapier knows both").map_or(0.0, |c| -c.dist);
        println!("seed {seed}: {depth} m deep, held {frozen} times");
        assert!(frozen < 10, "seed {seed}: held {frozen} times");
        assert!(depth < 0.01, "seed {seed}: {depth} m deep");
    }
}
