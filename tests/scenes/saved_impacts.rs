//! Worlds saved right after impacts, or while bodies that were put into each other come apart: what the next step has
//! to know of these is no part of rapier's world.

use crate::bodies::*;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::{load_world, save_world};

/// A brick at rest beside which a tilted plate is thrown on the ground: the boxes of the two overlap.
fn world_with_a_blow_beside_a_brick() -> (PhysicsWorld, RigidBodyHandle) {
    let mut world = world_with_ground();
    let cuboid = |x, y, z| {
        let mesh = MedialMesh::cuboid(Vector::new(x, y, z)).expect("a cuboid");
        ColliderBuilder::medial_mesh(mesh).density(1000.0)
    };
    let at = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 0.1, 0.0));
    let brick = world.insert(at, cuboid(0.4, 0.1, 0.2)).0;
    let pose = Pose::new(Vector::new(0.55, 1.5, 0.0), Vector::Z * -0.8);
    let thrown = RigidBodyBuilder::dynamic()
        .pose(pose)
        .linvel(Vector::NEG_Y * 6.0);
    world.insert(thrown, cuboid(0.3, 0.01, 0.3));
    (world, brick)
}

/// rapier restarts the time of what is beside a body that an impact moved, however fast that one is.
#[test]
fn a_loaded_world_knows_how_long_neighbours_of_fast_bodies_have_been_slow() {
    let (mut world, brick) = world_with_a_blow_beside_a_brick();
    let slow = |world: &PhysicsWorld| world.bodies[brick].activation().time_since_can_sleep;
    let mut pipeline = attached(&mut world);
    let mut events = 0;
    for step in 0..28 {
        let bytes = save_world(&world).expect("a world that can be saved");
        let mut loaded = load_world(&bytes).expect("what was saved");
        attached(&mut loaded).step(&mut loaded);
        events += pipeline.step(&mut world).events;
        assert_eq!(slow(&loaded), slow(&world), "saved after {step} steps");
        assert_eq!(bits(&loaded), bits(&world), "saved after {step} steps");
    }
    assert!(events > 0);
    assert!(slow(&world) > 0.0);
}

/// A game that predicts, as netcode does, steps ahead, puts the world back, and steps again with the same pipeline.
#[test]
fn a_world_put_back_goes_on_as_if_it_had_not_been_stepped_ahead() {
    let (mut world, brick) = world_with_a_blow_beside_a_brick();
    let (mut ahead, _) = world_with_a_blow_beside_a_brick();
    let mut pipeline = attached(&mut world);
    let mut predicting = attached(&mut ahead);
    let slow = |world: &PhysicsWorld| world.bodies[brick].activation().time_since_can_sleep;
    for step in 0..60 {
        let bytes = save_world(&ahead).expect("a world that can be saved");
        let (overlaps, starts) = (predicting.overlaps(), predicting.told_starts().to_vec());
        for _ in 0..1 + step % 7 {
            predicting.step(&mut ahead);
        }
        ahead = load_world(&bytes).expect("what was saved");
        predicting.attach(&mut ahead);
        predicting.resume_overlaps(overlaps, &ahead);
        predicting.resume_told_starts(starts);
        predicting.step(&mut ahead);
        pipeline.step(&mut world);
        assert_eq!(slow(&ahead), slow(&world), "put back at step {step}");
        assert_eq!(bits(&ahead), bits(&world), "put back at step {step}");
    }
    assert!(slow(&world) > 0.0);
}

/// A ball that is added before the world is saved takes nothing from what is known of the bodies that impacts moved.
#[test]
fn what_impacts_moved_is_known_beside_a_new_collider() {
    for saved in 8..28 {
        let (mut world, brick) = world_with_a_blow_beside_a_brick();
        let mut pipeline = attached(&mut world);
        for _ in 0..saved {
            pipeline.step(&mut world);
        }
        let far = RigidBodyBuilder::dynamic().translation(Vector::new(9.0, 3.0, 0.0));
        world.insert(far, ColliderBuilder::ball(0.1));
        let bytes = save_world(&world).expect("a world that can be saved");
        let mut loaded = load_world(&bytes).expect("what was saved");
        attached(&mut loaded).step(&mut loaded);
        pipeline.step(&mut world);
        let slow = |world: &PhysicsWorld| world.bodies[brick].activation().time_since_can_sleep;
        assert_eq!(slow(&loaded), slow(&world), "saved after {saved} steps");
        assert_eq!(bits(&loaded), bits(&world), "saved after {saved} steps");
    }
}

/// Two slabs spawned in each other are left to the solver after loading too.
#[test]
fn bodies_spawned_in_each_other_part_the_same_way_after_loading() {
    let mut world = world_with_ground();
    let slab = MedialMesh::cuboid(Vector::new(0.4, 0.03, 0.3)).expect("a slab");
    for (y, turn) in [(0.8, 0.0), (0.81, 0.6), (0.83, 1.2)] {
        let pose = Pose::new(Vector::new(0.0, y, 0.0), Vector::X * turn);
        let slab = ColliderBuilder::medial_mesh(slab.clone()).density(500.0);
        world.insert(RigidBodyBuilder::dynamic().pose(pose), slab);
    }
    let mut pipeline = attached(&mut world);
    for step in 0..40 {
        let bytes = save_world(&world).expect("a world that can be saved");
        let record = pipeline.overlaps();
        let mut loaded = load_world(&bytes).expect("what was saved");
        let mut other = attached(&mut loaded);
        other.resume_overlaps(record, &loaded);
        other.step(&mut loaded);
        pipeline.step(&mut world);
        assert_eq!(bits(&loaded), bits(&world), "saved after {step} steps");
    }
}
