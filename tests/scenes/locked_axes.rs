//! Bodies whose velocity drives them along an axis that is locked: no contact slows them down along it, since none
//! moves them.

use crate::bodies::{attached, ring, world_with_ground};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Speed along the locked axis, metres per second.
const DOWN: Real = 5.0;

/// Symptom: a box of which the vertical axis is locked, and which moves down, touched the ground below its centre and
/// got 10⁶ rad/s and more; rods and rings lost their velocity instead. Cause: the impulse that stops the point of
/// contact by turning the body alone has no bound where its lever is short, and forces that rapier never adds along a
/// locked axis were taken back. rapier's own shapes pass through the ground, some of them at hundreds of rad/s.
#[test]
fn bodies_driven_along_a_locked_axis_are_held_by_the_ground() {
    let meshes = [
        MedialMesh::round_cuboid(Vector::splat(0.135), 0.015),
        MedialMesh::capsule(Vector::X * -0.2, Vector::X * 0.2, 0.06),
        Ok(ring(12, 0.2, 0.05)),
    ];
    for mesh in meshes {
        let mesh = mesh.expect("a mesh");
        for axes in [
            LockedAxes::TRANSLATION_LOCKED_Y,
            LockedAxes::TRANSLATION_LOCKED,
            LockedAxes::TRANSLATION_LOCKED_Y | LockedAxes::ROTATION_LOCKED,
        ] {
            let mut world = world_with_ground();
            let mut pipeline = attached(&mut world);
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(Vector::Y * 0.4, Vector::Z * 0.1))
                .linvel(Vector::new(1.0, -DOWN, 0.0))
                .locked_axes(axes);
            let (body, _) = world.insert(body, ColliderBuilder::medial_mesh(mesh.clone()));
            let mut fastest: [Real; 2] = [0.0; 2];
            for _ in 0..120 {
                pipeline.step(&mut world);
                let body = &world.bodies[body];
                let now = [body.linvel().length(), body.angvel().length()];
                fastest = [0, 1].map(|k| fastest[k].max(now[k]));
            }
            let body = &world.bodies[body];
            let (y, down) = (body.translation().y, -body.linvel().y);
            println!("{axes:?}: at {y}, {down} m/s down; at most {fastest:?} m/s and rad/s");
            assert!(y > -1.0e-3, "{axes:?}: it is at {y}");
            assert!((down - DOWN).abs() < 1.0e-3, "{axes:?}: {down} m/s down");
            assert!(fastest[0] < 2.0 * DOWN, "{axes:?}: {} m/s", fastest[0]);
            assert!(fastest[1] < 100.0, "{axes:?}: {} rad/s", fastest[1]);
        }
    }
}

/// Steps in which a heavy cube that falls at `speed` on a light plate hangs in the air, though it moves: the plate has
/// locked axes, or a fixed joint holds it to the world.
fn hanging_steps(mass_ratio: Real, speed: Real, aside: Real, axes: Option<LockedAxes>) -> usize {
    let half = Vector::new(0.5, 0.05, 0.4);
    let cube = 0.3;
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let plate = MedialMesh::cuboid(half).expect("a plate");
    let body = RigidBodyBuilder::dynamic().locked_axes(axes.unwrap_or(LockedAxes::empty()));
    let (plate, _) = world.insert(body, ColliderBuilder::medial_mesh(plate).mass(1.0));
    if axes.is_none() {
        let anchor = world.insert_body(RigidBodyBuilder::fixed());
        world.insert_impulse_joint(anchor, plate, FixedJointBuilder::new());
    }
    let mesh = MedialMesh::cuboid(Vector::splat(cube)).expect("a cube");
    let start = RigidBodyBuilder::dynamic()
        .translation(Vector::new(aside, half.y + cube + 0.06, 0.0))
        .linvel(Vector::NEG_Y * speed)
        .can_sleep(false);
    let (body, _) = world.insert(start, ColliderBuilder::medial_mesh(mesh).mass(mass_ratio));
    let mut pipeline = attached(&mut world);
    let hangs = |_: &usize| {
        let before = world.bodies[body].translation();
        pipeline.step(&mut world);
        let body = &world.bodies[body];
        let way = (body.translation() - before).length();
        way < 0.1 * body.linvel().length() / 60.0 && body.linvel().length() > 0.1 * speed
    };
    let hanging = (0..60).filter(hangs).count();
    if axes.is_some_and(|axes| axes.contains(LockedAxes::ROTATION_LOCKED)) {
        let above = world.bodies[body].translation().y - half.y - cube;
        assert!(above > -0.01, "{above} m above a plate that nothing moves");
    }
    hanging
}

/// Symptom: heavy bodies that fell on light ones with locked axes or joints hung in the air for ever, with all of their
/// velocity, as if the locked axes held them too. Cause: a contact counted as held where an impulse moves the two much
/// less than it would move the light one alone, and so it is with any heavy body.
#[test]
fn heavy_bodies_do_not_hang_above_light_ones_that_are_held() {
    let turns = LockedAxes::TRANSLATION_LOCKED | LockedAxes::ROTATION_LOCKED_Y;
    let held = [None, Some(turns), Some(turns | LockedAxes::ROTATION_LOCKED)];
    for axes in held {
        for mass_ratio in [10.0, 100.0, 1000.0] {
            for (speed, aside) in [(1.5, 0.0), (4.0, 0.2), (20.0, 0.4)] {
                let steps = hanging_steps(mass_ratio, speed, aside, axes);
                println!(
                    "{axes:?}, {mass_ratio} times as heavy, {speed} m/s, {aside} m aside: {steps}"
                );
                assert!(
                    steps < 5,
                    "{axes:?}, {mass_ratio} times as heavy, {speed} m/s, {aside} m aside: {steps} steps"
                );
            }
        }
    }
}
