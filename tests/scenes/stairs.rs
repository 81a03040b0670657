//! rapier's character controller with a box, on stairs of boxes: medial or rapier's own, the character and the stairs.

use rapier3d::control::{CharacterAutostep, CharacterLength, KinematicCharacterController};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

fn cuboid(medial: bool, half: Vector) -> SharedShape {
    match medial {
        true => SharedShape::medial_mesh(MedialMesh::cuboid(half).expect("a box")),
        false => SharedShape::cuboid(half.x, half.y, half.z),
    }
}

/// How far a character gets in four seconds that walks at four steps of 1 m length.
fn walk(stairs: bool, character: bool, seed: u64) -> Real {
    let mut world = PhysicsWorld::new();
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    pipeline.attach(&mut world);
    let mut random = crate::random::Random(seed);
    let (rise, speed) = (random.within(0.15, 0.22), random.within(2.0, 6.0));
    let turn = random.within(-0.4, 0.4);
    let mut put = |half: Vector, at: Vector| {
        let block = ColliderBuilder::new(cuboid(stairs, half));
        world.insert_collider(block.translation(at), None);
    };
    put(Vector::new(10.0, 0.5, 10.0), Vector::NEG_Y * 0.5);
    for k in 0..4 {
        let height = 0.5 * rise * (k + 1) as Real;
        let at = Vector::new(1.5 + k as Real, height, 0.0);
        put(Vector::new(0.5, height, 2.0), at);
    }
    world.detect_collisions(&(), &());
    let shape = cuboid(character, Vector::new(0.2, 0.5, 0.2));
    let controller = KinematicCharacterController {
        autostep: Some(CharacterAutostep {
            max_height: CharacterLength::Absolute(0.4),
            min_width: CharacterLength::Absolute(0.2),
            include_dynamic_bodies: true,
        }),
        offset: CharacterLength::Absolute(0.01),
        ..KinematicCharacterController::default()
    };
    let start = Vector::new(0.0, 0.52, random.within(-1.0, 1.0));
    let mut pose = Pose::new(start, Vector::Y * turn);
    let mut fall = 0.0;
    for _ in 0..240 {
        fall -= 9.81 / 60.0;
        let queries = world.query_pipeline();
        let way = Vector::new(speed, fall, 0.0) / 60.0;
        let moved = controller.move_shape(1.0 / 60.0, &queries, &*shape, &pose, way, |_| {});
        pose.translation += moved.translation;
        if moved.grounded {
            fall = 0.0;
        }
    }
    pose.translation.x
}

/// Symptom: of 60 medial boxes 31 stood before a step for ever, of rapier's none. Cause: a cast straight up, along the
/// wall of the step at the offset from it, hit that wall, within the tolerance of a hit.
#[test]
fn boxes_climb_stairs_as_rapiers_do() {
    let climbs = |stairs: bool, character: bool| {
        let of = |seed: &u64| walk(stairs, character, *seed) > 3.0;
        (0..24).filter(of).count()
    };
    let own = climbs(false, false);
    for (stairs, character) in [(true, false), (false, true), (true, true)] {
        let ours = climbs(stairs, character);
        println!(
            "medial stairs {stairs}, medial character {character}: {ours} of 24, rapier's {own}"
        );
        assert!(ours + 1 >= own, "{ours} of 24, rapier's {own}");
    }
}
