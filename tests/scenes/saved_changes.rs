//! Worlds that are saved right after a collider was changed go on bit by bit once loaded.

use crate::bodies::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::{load_world, save_world};

/// Eight boxes of unlike sides that fall on each other.
fn heap_of_boxes() -> PhysicsWorld {
    let mut world = world_with_ground();
    let mut random = Random(3);
    for k in 0..8u8 {
        let half = Vector::from_array([0.1, 0.05, 0.08]) + Vector::splat(random.within(0.0, 0.1));
        let side = random.direction() * Vector::new(0.2, 0.0, 0.2);
        let at = Vector::Y * (0.4 + 0.3 * Real::from(k)) + side;
        let turn = random.direction() * 3.0;
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
        let mesh = MedialMesh::cuboid(half).expect("a box");
        world.insert(body, ColliderBuilder::medial_mesh(mesh).friction(0.5));
    }
    world
}

/// Symptom: worlds of bodies in contact, one of which had got another friction, restitution or events since the last
/// step, went on with other bits. Cause: the collider counted as one with a new shape.
#[test]
fn a_loaded_world_in_which_a_property_was_changed_goes_on_bit_by_bit() {
    let changes: [fn(&mut Collider); 4] = [
        |c| c.set_friction(0.1),
        |c| c.set_restitution(0.5),
        |c| c.set_active_events(ActiveEvents::COLLISION_EVENTS),
        |c| c.set_active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS),
    ];
    for (k, change) in changes.iter().enumerate() {
        for changed in [0, 2, 5, 7] {
            let mut world = heap_of_boxes();
            let mut pipeline = attached(&mut world);
            (0..70).for_each(|_| _ = pipeline.step(&mut world));
            let collider = world.colliders.iter().nth(changed).expect("a collider").0;
            change(&mut world.colliders[collider]);
            let bytes = save_world(&world).expect("a world that can be saved");
            let mut loaded = load_world(&bytes).expect("what was saved");
            let mut other = attached(&mut loaded);
            for step in 0..60 {
                pipeline.step(&mut world);
                other.step(&mut loaded);
                let same = bits(&world) == bits(&loaded);
                assert!(same, "change {k} of collider {changed}, after {step} steps");
            }
        }
    }
}
