//! Characters on lifts and among turning paddles: rapier's controller takes the velocities of kinematic bodies at the
//! contacts that parry's own dispatcher finds.

use crate::bodies::boxes;
use crate::random::Random;
use rapier3d::control::{CharacterLength, KinematicCharacterController};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A box of rapier's, or the medial mesh of one.
fn block(half: Vector, is_medial: bool) -> SharedShape {
    match is_medial {
        true => SharedShape::medial_mesh(MedialMesh::cuboid(half).expect("a cuboid")),
        false => SharedShape::cuboid(half.x, half.y, half.z),
    }
}

/// A tray with two rims.
fn tray(is_medial: bool) -> SharedShape {
    let parts = [
        (Vector::ZERO, Vector::new(1.2, 0.1, 0.9)),
        (Vector::new(1.1, 0.3, 0.0), Vector::new(0.1, 0.2, 0.9)),
        (Vector::new(-1.1, 0.3, 0.0), Vector::new(0.1, 0.2, 0.9)),
    ];
    if is_medial {
        let (vertices, triangles) = boxes(&parts);
        let built = MedialMesh::from_trimesh(&vertices, &triangles, &BuildOptions::default());
        return SharedShape::medial_mesh(built.expect("a tray").0);
    }
    let child = |(at, half): (Vector, Vector)| {
        let child = SharedShape::cuboid(half.x, half.y, half.z);
        (Pose::from_translation(at), child)
    };
    SharedShape::compound(parts.into_iter().map(child).collect())
}

/// How far a character that stands on a lift is carried aside while it goes up and down.
fn drift(lift: &SharedShape, character: &SharedShape, seed: u64) -> Real {
    let mut random = Random(seed);
    let mut world = PhysicsWorld::new();
    let mut pipeline = MedialPipeline::default();
    pipeline.attach(&mut world);
    let at = |y: Real| RigidBodyBuilder::kinematic_position_based().translation(Vector::Y * y);
    let lift = world.insert(at(0.1), ColliderBuilder::new(lift.clone())).0;
    let [x, z] = [0, 1].map(|_| random.within(-0.3, 0.3));
    let start = Vector::new(x, 0.71, z);
    let body = RigidBodyBuilder::kinematic_position_based().translation(start);
    let walker = world
        .insert(body, ColliderBuilder::new(character.clone()))
        .0;
    let controller = KinematicCharacterController {
        snap_to_ground: Some(CharacterLength::Absolute(0.2)),
        ..Default::default()
    };
    let dt = world.integration_parameters.dt;
    let (mut falling, mut most): (Real, Real) = (0.0, 0.0);
    let mut on_ground = 0;
    for step in 0..240 {
        let pose = *world.bodies[walker].position();
        falling -= 9.81 * dt;
        let filter = QueryFilter::new().exclude_rigid_body(walker);
        let queries = world.query_pipeline_with_filter(filter);
        let wanted = Vector::Y * falling * dt;
        let moved = controller.move_shape(dt, &queries, &**character, &pose, wanted, |_| ());
        if moved.grounded {
            falling = 0.0;
            on_ground += 1;
        }
        let height = 0.1 + 0.5 * (1.0 - (0.03 * step as Real).cos());
        world.bodies[walker].set_next_kinematic_translation(pose.translation + moved.translation);
        world.bodies[lift].set_next_kinematic_translation(Vector::Y * height);
        pipeline.step(&mut world);
        let aside = (world.bodies[walker].translation() - start) * Vector::new(1.0, 0.0, 1.0);
        most = most.max(aside.length());
    }
    let above = world.bodies[walker].translation().y - world.bodies[lift].translation().y;
    assert!((0.5..0.7).contains(&above), "{above} m above the lift");
    assert!(on_ground > 230, "on the ground in {on_ground} of 240 steps");
    most
}

#[test]
fn characters_stand_still_on_lifts() {
    let characters = [
        ("capsule", SharedShape::capsule_y(0.3, 0.2)),
        ("ball", SharedShape::ball(0.5)),
        ("cylinder", SharedShape::cylinder(0.5, 0.2)),
    ];
    let plate = |is_medial| block(Vector::new(0.8, 0.1, 0.8), is_medial);
    let lifts = [
        ("plate", [true, false].map(plate)),
        ("tray", [true, false].map(tray)),
    ];
    for (lift, both) in &lifts {
        for (character, shape) in &characters {
            let most = |lift: &SharedShape| {
                let drifts = (0..6).map(|seed| drift(lift, shape, seed));
                drifts.fold(0.0, Real::max)
            };
            let [medial, own] = both.each_ref().map(most);
            println!("{character} on a {lift}: {medial} m aside, on rapier's {own}");
            assert!(
                medial < 1.0e-3 && own < 1.0e-3,
                "{character} on a {lift}: {medial} m, {own}"
            );
        }
    }
}

/// How deep a character gets into paddles that turn at a speed, rad/s, as it walks past them.
fn deepest(is_medial: bool, speed: Real, seed: u64) -> Real {
    let mut random = Random(seed);
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(20.0, 0.5, 20.0);
    world.insert_collider(ground.translation(Vector::Y * -0.5), None);
    let half = Vector::new(0.8, 0.3, 0.1);
    for k in 0..4 {
        let body = RigidBodyBuilder::kinematic_velocity_based()
            .translation(Vector::new(2.0 * k as Real, 0.31, 0.0))
            .rotation(Vector::Y * random.within(0.0, 3.0))
            .angvel(Vector::Y * speed);
        world.insert(body, ColliderBuilder::new(block(half, is_medial)));
    }
    let capsule = SharedShape::capsule_y(0.3, 0.2);
    let at = Vector::new(-2.0, 0.51, random.within(-0.3, 0.3));
    let body = RigidBodyBuilder::kinematic_position_based().translation(at);
    let walker = world.insert(body, ColliderBuilder::new(capsule.clone())).0;
    let mut pipeline = MedialPipeline::default();
    pipeline.attach(&mut world);
    let controller = KinematicCharacterController::default();
    let dt = world.integration_parameters.dt;
    let (mut falling, mut deepest): (Real, Real) = (0.0, -1.0);
    for _ in 0..400 {
        let pose = *world.bodies[walker].position();
        falling -= 9.81 * dt;
        let (sin, cos) = random.within(-0.6, 0.6).sin_cos();
        let back = 0.01 * pose.translation.z;
        let wanted = Vector::new(1.5 * cos, falling, 1.5 * sin) * dt - Vector::Z * back;
        let filter = QueryFilter::new().exclude_rigid_body(walker);
        let queries = world.query_pipeline_with_filter(filter);
        let moved = controller.move_shape(dt, &queries, &*capsule, &pose, wanted, |_| ());
        if moved.grounded {
            falling = 0.0;
        }
        world.bodies[walker].set_next_kinematic_translation(pose.translation + moved.translation);
        pipeline.step(&mut world);
        // The capsule's axis is upright, as the paddles' sides are.
        let center = world.bodies[walker].translation();
        for (_, paddle) in world
            .bodies
            .iter()
            .filter(|(_, b)| b.is_kinematic())
            .take(4)
        {
            let local = paddle.position().inverse_transform_point(center).abs();
            let [x, z] = [local.x - half.x, local.z - half.z];
            let outside = Vector::new(x.max(0.0), 0.0, z.max(0.0)).length();
            let apart = if outside > 0.0 { outside } else { x.max(z) };
            if local.y < half.y + 0.2 {
                deepest = deepest.max(0.2 - apart);
            }
        }
    }
    deepest
}

#[test]
fn turning_paddles_push_characters_aside_as_rapiers_do() {
    for speed in [0.5, 1.5, 3.0] {
        let deepest = |is_medial| {
            let all = (0..8).map(|seed| deepest(is_medial, speed, seed));
            all.fold(-1.0, Real::max)
        };
        let [medial, own] = [true, false].map(deepest);
        println!("paddles at {speed} rad/s: {medial} m deep, rapier's {own}");
        // The controller keeps a centimetre away.
        assert!(medial.min(own) > -0.015, "no paddle met");
        assert!(
            medial < own + 0.02,
            "paddles at {speed} rad/s: {medial} m deep, rapier's {own}"
        );
    }
}
