//! What rolls, rolls on: a ball on a plate, both medial or rapier's own.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of the ball, metres.
const BALL: Real = 0.2;

/// Half thickness of the plate, metres.
const PLATE: Real = 0.1;

/// Speed of a ball that rolls without slip, after five seconds.
fn rolled(
    ball: ColliderBuilder,
    plate: ColliderBuilder,
    density: Option<Real>,
    speed: Real,
) -> Real {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    match density {
        // Free, on the ground.
        Some(density) => {
            let ground = ColliderBuilder::cuboid(30.0, 1.0, 30.0);
            world.insert_collider(ground.translation(Vector::NEG_Y * (PLATE + 1.0)), None);
            world.insert(RigidBodyBuilder::dynamic(), plate.density(density));
        }
        None => {
            world.insert_collider(plate, None);
        }
    }
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-5.0, BALL + PLATE, 0.0))
        .linvel(Vector::X * speed)
        .angvel(Vector::NEG_Z * speed / BALL);
    let (ball, _) = world.insert(body, ball);
    for _ in 0..300 {
        pipeline.step(&mut world);
    }
    world.bodies[ball].linvel().x
}

#[test]
fn a_ball_keeps_its_speed_on_every_plate() {
    let balls = || {
        let mesh = MedialMesh::ball(BALL).expect("a ball");
        [
            ColliderBuilder::medial_mesh(mesh),
            ColliderBuilder::ball(BALL),
        ]
    };
    let plates = || {
        let mesh = MedialMesh::round_plate(8.0, 2.0, PLATE).expect("a plate");
        [
            ColliderBuilder::medial_mesh(mesh),
            ColliderBuilder::cuboid(8.0, PLATE, 2.0),
        ]
    };
    for density in [None, Some(200.0)] {
        for speed in [0.5, 2.0] {
            for (j, plate) in plates().into_iter().enumerate() {
                for (i, ball) in balls().into_iter().enumerate() {
                    let end = rolled(ball, plate.clone(), density, speed);
                    println!("density {density:?}, ball {i}, plate {j}: {speed} to {end} m/s");
                    let off = (end / speed - 1.0).abs();
                    assert!(off < 0.01, "ball {i}, plate {j}: {speed} to {end} m/s");
                }
            }
        }
    }
}
