//! Worlds whose parameters change as they go, steps of no length and of unusual ones: boxes that lie on each other do
//! so as rapier's rounded cuboids do, and no fast rod passes a floor.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

type Change = fn(&mut IntegrationParameters, usize);

const CHANGES: [(&str, Change); 11] = [
    ("none", |_, _| {}),
    ("every third step has no length", |p, step| {
        p.dt = if step % 3 == 0 { 0.0 } else { 1.0 / 60.0 };
    }),
    ("every third step is tiny", |p, step| {
        p.dt = if step % 3 == 0 { 1.0e-7 } else { 1.0 / 60.0 };
    }),
    ("steps of a tenth of a second", |p, _| p.dt = 0.1),
    ("another length unit", |p, step| {
        p.length_unit = if step < 30 { 1.0 } else { 10.0 };
    }),
    ("prediction", |p, step| {
        p.normalized_prediction_distance = if step < 30 { 0.1 } else { 0.0005 };
    }),
    ("softer contacts", |p, step| {
        p.contact_softness.natural_frequency = if step < 30 { 30.0 } else { 15.0 };
    }),
    ("harder contacts", |p, step| {
        p.contact_softness.natural_frequency = if step < 30 { 30.0 } else { 120.0 };
    }),
    ("no sweeps", |p, _| p.max_ccd_substeps = 0),
    ("one iteration", |p, _| p.num_solver_iterations = 1),
    ("16 iterations", |p, _| p.num_solver_iterations = 16),
];

/// Heights of three boxes on each other, kept awake, after 300 steps, and their mean speeds in the last 240: in long
/// steps all boxes tremble.
fn boxes(medial: bool, change: Change) -> Vec<(Real, Real)> {
    let mut world = PhysicsWorld::new();
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground, None);
    let inner = Vector::splat(0.18);
    let boxes: Vec<RigidBodyHandle> = (0..3)
        .map(|i| {
            let collider = match medial {
                true => ColliderBuilder::medial_mesh(
                    MedialMesh::round_cuboid(inner, 0.02).expect("a box"),
                ),
                false => ColliderBuilder::round_cuboid(0.18, 0.18, 0.18, 0.02),
            };
            let at = Vector::Y * (0.201 + 0.401 * i as Real);
            let body = RigidBodyBuilder::dynamic().translation(at).can_sleep(false);
            world.insert(body, collider).0
        })
        .collect();
    let mut speeds = [0.0; 3];
    for step in 0..300 {
        change(&mut world.integration_parameters, step);
        if medial {
            pipeline.step(&mut world);
        } else {
            world.step();
        }
        if step >= 60 {
            for (speed, h) in speeds.iter_mut().zip(&boxes) {
                *speed += world.bodies[*h].linvel().length() / 240.0;
            }
        }
    }
    let height = |h: &RigidBodyHandle| world.bodies[*h].translation().y;
    boxes.iter().map(height).zip(speeds).collect()
}

#[test]
fn boxes_lie_as_rapiers_whatever_changes() {
    for (name, change) in CHANGES {
        let [ours, own] = [true, false].map(|medial| boxes(medial, change));
        let mut last = IntegrationParameters::default();
        change(&mut last, 299);
        let dt = last.dt;
        for (ours, own) in ours.iter().zip(&own) {
            let off = (ours.0 - own.0).abs();
            println!("{name}: {ours:.4?}, rapier's own {own:.4?}");
            let step = (ours.1 + own.1) * dt;
            assert!(
                off < 3.0e-3 + step,
                "{name}: {ours:?}, rapier's own {own:?}"
            );
            // Twice as much, and a tenth of what gravity adds in a step: with one iteration the upper box trembles at
            // 3.8 cm/s, rapier's own at 1.4.
            let trembling = 2.0 * own.1 + 0.98 * dt;
            assert!(ours.1 < trembling, "{name}: {ours:?}, rapier's own {own:?}");
        }
    }
}

#[test]
fn no_fast_rod_passes_a_floor_whatever_changes() {
    let odd: [(&str, Change); 4] = [
        ("one step of a second", |p, step| {
            p.dt = if step == 3 { 1.0 } else { 1.0 / 60.0 };
        }),
        ("every second step has no length", |p, step| {
            p.dt = if step % 2 == 0 { 0.0 } else { 1.0 / 60.0 };
        }),
        ("length units to and fro", |p, step| {
            p.length_unit = if step % 2 == 0 { 100.0 } else { 0.01 };
        }),
        ("no prediction", |p, _| {
            p.normalized_prediction_distance = 0.0
        }),
    ];
    for (name, change) in CHANGES.into_iter().chain(odd) {
        for speed in [5.0, 50.0, 300.0] {
            let mut world = PhysicsWorld::new();
            let mut pipeline = attached(&mut world);
            world.insert_collider(ColliderBuilder::cuboid(20.0, 0.05, 20.0), None);
            let end = Vector::X * 0.2;
            let rods: Vec<RigidBodyHandle> = (0..5)
                .map(|i| {
                    let rod = MedialMesh::capsule(-end, end, 0.05).expect("a rod");
                    let at = Vector::new(i as Real, 2.0 + 0.1 * i as Real, 0.0);
                    let body = RigidBodyBuilder::dynamic().translation(at);
                    let body = body.linvel(Vector::NEG_Y * speed);
                    world.insert(body, ColliderBuilder::medial_mesh(rod)).0
                })
                .collect();
            for step in 0..60 {
                change(&mut world.integration_parameters, step);
                pipeline.step(&mut world);
            }
            for rod in rods {
                let y = world.bodies[rod].translation().y;
                assert!(y > 0.05, "{name}, {speed} m/s: a rod is at {y}");
            }
        }
    }
}

/// A ball meets one that is at rest at 8 m/s and does not give way to it. rapier 0.36 takes a dominant body as if it
/// stood still: its own ball goes through the other, which stays where it is. Met within a step, what gives way is
/// taken along; met slowly, it is rapier's solver's, of both kinds.
#[test]
fn dominant_bodies_take_along_what_gives_way() {
    let meet = |medial: bool, speed: Real| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        world.gravity = Vector::ZERO;
        let mut ball = |x: Real, speed: Real, group: i8| {
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::X * x)
                .linvel(Vector::X * speed)
                .dominance_group(group)
                .can_sleep(false);
            let sphere = vec![MedialSphere::new(Vector::ZERO, 0.2)];
            let collider = match medial {
                true => ColliderBuilder::medial_mesh(
                    MedialMesh::new(sphere, vec![], vec![]).expect("a ball"),
                ),
                false => ColliderBuilder::ball(0.2),
            };
            world.insert(body, collider).0
        };
        let [weak, strong] = [ball(0.0, 0.0, 0), ball(0.5, -speed, 5)];
        for _ in 0..(60.0 / speed) as usize {
            if medial {
                pipeline.step(&mut world);
            } else {
                world.step();
            }
        }
        [weak, strong].map(|h| world.bodies[h].linvel().x / speed)
    };
    let [ours, own] = [true, false].map(|medial| meet(medial, 8.0));
    assert!(ours.iter().all(|v| (v + 1.0).abs() < 0.01), "{ours:?}");
    assert_eq!(own, [0.0, -1.0], "rapier takes dominant bodies along now");
    let [ours, own] = [true, false].map(|medial| meet(medial, 0.5));
    assert!(
        (ours[0] - own[0]).abs() < 0.01,
        "{ours:?}, rapier's own {own:?}"
    );
}

/// A body that rests on a platform is given a higher dominance group than the platform has, which is none for a fixed
/// one.
#[test]
fn dominant_bodies_fall_through_kinematic_platforms_as_rapiers_do() {
    let rest = |medial: bool, plate: bool, platform: RigidBodyType| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        let platform = world.bodies.insert(RigidBodyBuilder::new(platform));
        let top = ColliderBuilder::cuboid(3.0, 0.15, 3.0).translation(Vector::Y * -0.15);
        world.insert_collider(top, Some(platform));
        let ground = ColliderBuilder::cuboid(9.0, 0.5, 9.0).translation(Vector::Y * -3.0);
        world.insert_collider(ground, None);
        let half = Vector::new(0.3, if plate { 0.03 } else { 0.25 }, 0.3);
        let collider = match medial {
            true => ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a cuboid")),
            false => ColliderBuilder::cuboid(half.x, half.y, half.z),
        };
        let body = RigidBodyBuilder::dynamic().translation(Vector::Y * (half.y + 0.05));
        let (body, _) = world.insert(body, collider);
        for step in 0..300 {
            if step == 100 {
                world.bodies[body].set_dominance_group(3);
            }
            pipeline.step(&mut world);
        }
        world.bodies[body].translation().y
    };
    let kinds = [
        RigidBodyType::KinematicVelocityBased,
        RigidBodyType::KinematicPositionBased,
        RigidBodyType::Fixed,
    ];
    for (platform, plate) in kinds
        .into_iter()
        .flat_map(|kind| [(kind, true), (kind, false)])
    {
        let [ours, own] = [true, false].map(|medial| rest(medial, plate, platform));
        println!("{platform:?}, a plate {plate}: {ours}, rapier's own {own}");
        assert!(
            (ours - own).abs() < 0.005,
            "{platform:?}: {ours}, rapier's own {own}"
        );
    }
}
