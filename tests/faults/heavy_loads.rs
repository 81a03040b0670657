//! Heavy bodies on thin light ones.

use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A block 0.4 m high on a plate 4.5 mm thick and of a thousandth of its mass, after 100 steps: whether both sleep, how
/// high the block lies above the ground, and how often a body was frozen.
fn block_on_plate(is_medial: bool) -> (bool, Real, usize) {
    let half = Vector::new(0.15, 0.00225, 0.15);
    let plate = match is_medial {
        true => ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a plate")),
        false => ColliderBuilder::cuboid(half.x, half.y, half.z),
    };
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground, None);
    let mut put = |x: Real, y: Real, collider: ColliderBuilder, mass: Real| {
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, y, 0.0));
        world.insert(body, collider.mass(mass)).0
    };
    let block = ColliderBuilder::cuboid(0.2, 0.2, 0.2);
    let bodies = [
        put(0.0, 0.00325, plate, 0.4),
        put(0.01, 0.2145, block, 400.0),
    ];
    let mut pipeline = MedialPipeline::default();
    let frozen = (0..100).map(|_| pipeline.step(&mut world).frozen).sum();
    let sleep = bodies.iter().all(|b| world.bodies[*b].is_sleeping());
    (sleep, world.bodies[bodies[1]].translation().y - 0.2, frozen)
}

/// rapier's solver lets a heavy block sink through a plate that is far lighter: with its own shapes the block comes to
/// rest on the ground. A medial plate keeps it off by impacts, of which the plate has as many in each step as it may
/// have, and the two may be awake for ever.
#[test]
fn a_plate_under_a_block_of_a_thousand_times_its_mass_is_frozen_in_each_step() {
    let [medial, own] = [true, false].map(block_on_plate);
    println!("medial {medial:?}, own {own:?}");
    assert!(own.0 && own.1 < 1.0e-3 && own.2 == 0, "own {own:?}");
    assert!(medial.1 > 1.0e-3, "{medial:?}");
    assert!(medial.2 > 60, "{medial:?}: mended?");
}
