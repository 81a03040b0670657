//! Kinematic bodies of both kinds that strike, and that press.

use crate::bodies::*;
use crate::impacts::ball_bar;
use crate::partners::smooth;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

fn ball(radius: Real) -> ColliderBuilder {
    smooth(ColliderBuilder::medial_mesh(
        MedialMesh::ball(radius).expect("a ball"),
    ))
}

/// A bar that turns at 100 rad/s, which nothing stops, hits a ball at radius 0.15 m: of equal normal
/// speed there, `v' = 2 ω r` along the path of the contact.
#[test]
fn a_turning_paddle_throws_a_ball_at_twice_its_own_speed() {
    for kind in [
        RigidBodyType::KinematicVelocityBased,
        RigidBodyType::KinematicPositionBased,
    ] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let (spin, r) = (100.0, 0.15);
        let body = RigidBodyBuilder::new(kind).angvel(Vector::new(0.0, spin, 0.0));
        let collider = smooth(ColliderBuilder::medial_mesh(ball_bar()));
        let paddle = world.insert(body, collider).0;
        world.bodies[paddle].set_allow_fast_rotation(true);
        // The bar lies along Z; about Y its end at +Z moves towards +X.
        let struck = RigidBodyBuilder::dynamic().translation(Vector::new(0.12, 0.0, r));
        let struck = world.insert(struck, ball(0.05)).0;
        let mut pipeline = attached(&mut world);
        let mut events = 0;
        for step in 1..=3 {
            if kind == RigidBodyType::KinematicPositionBased {
                let turn = Rotation::from_rotation_y(spin * step as Real / 60.0);
                world.bodies[paddle].set_next_kinematic_rotation(turn);
            }
            events += pipeline.step(&mut world).events;
        }
        // Where along the bar they touch: from the turn at which the bar is 0.1 m from the ball.
        let far = Real::hypot(0.12, r);
        let arm = (far * far - 0.01).sqrt();
        let speed = world.bodies[struck].linvel().length();
        let planted = 2.0 * spin * arm;
        assert!(
            events > 0 && (speed / planted - 1.0).abs() < 0.05,
            "{kind:?}: {speed}, {planted}"
        );
    }
}

/// A ball between two plates that fly on, both kinds of kinematic: it bounces more than it may, and rides
/// along.
#[test]
fn a_frozen_body_rides_along() {
    for kind in [
        RigidBodyType::KinematicVelocityBased,
        RigidBodyType::KinematicPositionBased,
    ] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let speed = 60.0;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let spheres = corners.map(|[y, z]| MedialSphere::new(Vector::new(0.0, y, z), 0.05));
        let faces = vec![[0, 1, 2], [0, 2, 3]];
        let plate = MedialMesh::new(spheres.to_vec(), vec![], faces).expect("a plate");
        let plates = [-0.11, 0.11].map(|x| {
            let body = RigidBodyBuilder::new(kind).linvel(Vector::new(speed, 0.0, 0.0));
            let mesh = smooth(ColliderBuilder::medial_mesh(plate.clone()));
            (
                world
                    .insert(body.translation(Vector::new(x, 0.0, 0.0)), mesh)
                    .0,
                x,
            )
        });
        let body = RigidBodyBuilder::dynamic().linvel(Vector::new(speed + 250.0, 0.0, 0.0));
        let inside = world.insert(body, ball(0.05)).0;
        let mut pipeline = attached(&mut world);
        let mut frozen = 0;
        for step in 1..=20 {
            let on = speed * step as Real / 60.0;
            for (plate, x) in plates {
                if kind == RigidBodyType::KinematicPositionBased {
                    let to = Vector::new(x + on, 0.0, 0.0);
                    world.bodies[plate].set_next_kinematic_translation(to);
                }
            }
            frozen += pipeline.step(&mut world).frozen;
            let x = world.bodies[inside].translation().x;
            let aside = x - world.bodies[plates[0].0].translation().x - 0.11;
            assert!(
                aside.abs() < 0.06,
                "{kind:?}, step {step}: {aside} aside of the middle"
            );
        }
        assert!(frozen > 0, "{kind:?}");
    }
}

/// rapier's `ccd_enabled` changes no bit of what medial bodies do, dynamic and kinematic ones that turn by 3 to 10 rad
/// in a step, against medial bodies, rapier's, and fixed ones: their impacts are the event loop's, with the flag or
/// without.
#[test]
fn the_ccd_flag_changes_nothing() {
    let mut impacts = 0;
    for case in 0..96 {
        let [without, with] = [false, true].map(|ccd| {
            let mut random = Random(900 + case);
            let mut world = PhysicsWorld::new();
            world.gravity = Vector::ZERO;
            let mut body = || {
                let body = if case % 2 == 0 {
                    RigidBodyBuilder::kinematic_velocity_based()
                } else {
                    RigidBodyBuilder::dynamic()
                };
                body.angvel(random.direction() * random.within(180.0, 600.0))
            };
            let turning = body().ccd_enabled(ccd);
            let turning = world.insert(turning, ColliderBuilder::medial_mesh(ball_bar()));
            world.bodies[turning.0].set_allow_fast_rotation(true);
            let partner = match case / 2 % 3 {
                0 => ball(0.05),
                1 => ColliderBuilder::ball(0.05),
                _ => ColliderBuilder::cuboid(0.05, 0.03, 0.04),
            };
            let body = RigidBodyBuilder::dynamic().ccd_enabled(ccd);
            let body = body.linvel(random.direction() * random.within(0.0, 30.0));
            let at = random.direction() * random.within(0.15, 0.3);
            let struck = world.insert(body.translation(at), partner).0;
            let wall = ColliderBuilder::cuboid(0.05, 2.0, 2.0).translation(Vector::X);
            world.insert_collider(wall, None);
            let mut pipeline = attached(&mut world);
            let events: usize = (0..8).map(|_| pipeline.step(&mut world).events).sum();
            let ends = [turning.0, struck].map(|h| {
                let body = &world.bodies[h];
                (*body.position(), body.linvel(), body.angvel())
            });
            (ends, events)
        });
        assert_eq!(without, with, "case {case}");
        impacts += usize::from(with.1 > 0);
    }
    println!("{impacts} of 96 with impacts");
    assert!(impacts > 30, "{impacts}");
}
