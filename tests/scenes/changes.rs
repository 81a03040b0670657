//! Bodies and colliders that the user changes between two steps, right before they would meet, while they rest, or
//! while a sensor has them: beside rapier's own capsules, balls and rounded cuboids of the same sizes.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::sync::Mutex;

fn capsule(medial: bool, end: Vector, radius: Real) -> ColliderBuilder {
    match medial {
        true => {
            ColliderBuilder::medial_mesh(MedialMesh::capsule(-end, end, radius).expect("a capsule"))
        }
        false => ColliderBuilder::capsule_from_endpoints(-end, end, radius),
    }
}

fn ball(medial: bool, radius: Real) -> ColliderBuilder {
    let mesh = || {
        MedialMesh::new(
            vec![MedialSphere::new(Vector::ZERO, radius)],
            vec![],
            vec![],
        )
    };
    match medial {
        true => ColliderBuilder::medial_mesh(mesh().expect("a ball")),
        false => ColliderBuilder::ball(radius),
    }
}

/// A cuboid with edges rounded by 2 cm.
fn cuboid(medial: bool, half: Vector) -> ColliderBuilder {
    let inner = half - Vector::splat(0.02);
    match medial {
        true => {
            ColliderBuilder::medial_mesh(MedialMesh::round_cuboid(inner, 0.02).expect("a cuboid"))
        }
        false => ColliderBuilder::round_cuboid(inner.x, inner.y, inner.z, 0.02),
    }
}

/// A world and whether it is stepped with medial colliders.
struct Stepped {
    world: PhysicsWorld,
    pipeline: Option<MedialPipeline>,
}

impl Stepped {
    fn new(medial: bool) -> Self {
        let mut world = PhysicsWorld::new();
        let pipeline = attached(&mut world);
        Self {
            world,
            pipeline: medial.then_some(pipeline),
        }
    }

    fn step(&mut self, log: &Log) {
        match &mut self.pipeline {
            Some(pipeline) => _ = pipeline.step_with_events(&mut self.world, &(), log),
            None => self.world.step_with_events(&(), log),
        }
    }
}

/// Collision events, in their order.
#[derive(Default)]
struct Log(Mutex<Vec<String>>);

impl EventHandler for Log {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        event: CollisionEvent,
        pair: Option<&ContactPair>,
    ) {
        let (started, sensor, removed) = (event.started(), event.sensor(), event.removed());
        let told = format!(
            "started {started}, sensor {sensor}, removed {removed}, pair {}",
            pair.is_some()
        );
        self.0.lock().expect("not poisoned").push(told);
    }

    fn handle_contact_force_event(
        &self,
        _: Real,
        _: &RigidBodySet,
        _: &ColliderSet,
        _: &ContactPair,
        _: Real,
    ) {
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}

/// The events of a scene of either kind are the same.
fn same_events(name: &str, play: impl Fn(bool, &Log)) {
    let [ours, own] = [true, false].map(|medial| {
        let log = Log::default();
        play(medial, &log);
        log.0.into_inner().expect("not poisoned")
    });
    assert_eq!(ours, own, "{name}: rapier's own on the right");
}

type Change = fn(&mut PhysicsWorld, RigidBodyHandle, ColliderHandle, bool);

/// What is done to a body that flies along -X, and its collider.
const CHANGES: [(&str, Change); 21] = [
    ("nothing", |_, _, _, _| {}),
    ("collision groups", |w, _, c, _| {
        w.colliders[c].set_collision_groups(InteractionGroups::none());
    }),
    ("solver groups", |w, _, c, _| {
        w.colliders[c].set_solver_groups(InteractionGroups::none());
    }),
    ("collider off", |w, _, c, _| {
        w.colliders[c].set_enabled(false)
    }),
    ("body off", |w, b, _, _| w.bodies[b].set_enabled(false)),
    ("sensor", |w, _, c, _| w.colliders[c].set_sensor(true)),
    ("fixed", |w, b, _, _| {
        w.bodies[b].set_body_type(RigidBodyType::Fixed, true);
    }),
    ("kinematic", |w, b, _, _| {
        let body = &mut w.bodies[b];
        body.set_body_type(RigidBodyType::KinematicVelocityBased, true);
        body.set_linvel(Vector::NEG_X * 4.0, true);
    }),
    ("kinematic at rest", |w, b, _, _| {
        w.bodies[b].set_body_type(RigidBodyType::KinematicPositionBased, true);
    }),
    ("body removed", |w, b, _, _| _ = w.remove_body(b)),
    ("collider removed", |w, _, c, _| _ = w.remove_collider(c)),
    ("another shape", |w, _, c, medial| {
        let bigger = capsule(medial, Vector::Z * 0.5, 0.15).build();
        w.colliders[c].set_shape(bigger.shared_shape().clone());
    }),
    ("heavier", |w, b, _, _| {
        w.bodies[b].set_additional_mass(50.0, true);
    }),
    ("locked along x", |w, b, _, _| {
        w.bodies[b].set_enabled_translations(false, true, true, true);
    }),
    ("turns locked", |w, b, _, _| {
        w.bodies[b].lock_rotations(true, true)
    }),
    ("skin", |w, _, c, _| w.colliders[c].set_contact_skin(0.05)),
    ("moved on its body", |w, _, c, _| {
        w.colliders[c].set_translation_wrt_parent(Vector::Y * 0.1);
    }),
    ("moved away", |w, b, _, _| {
        w.bodies[b].set_translation(Vector::Y * 3.0, true);
    }),
    ("asleep", |w, b, _, _| {
        w.bodies[b].set_linvel(Vector::ZERO, false);
        w.bodies[b].sleep();
    }),
    ("on another body", |w, _, c, _| {
        let other = RigidBodyBuilder::dynamic().translation(Vector::X * 0.2);
        let other = w.insert_body(other.linvel(Vector::NEG_X * 8.0));
        w.colliders.set_parent(c, Some(other), &mut w.bodies);
    }),
    ("on no body", |w, _, c, _| {
        w.colliders.set_parent(c, None, &mut w.bodies);
    }),
];

/// Two bars cross at 2 × 8 m/s, and one is changed in the step before they meet: velocities and places are those of
/// rapier in 256ths of a step, up to a tenth, as rapier's bars get into each other even then and are pressed out. The
/// other is medial or rapier's.
#[test]
fn a_body_that_is_changed_before_it_meets_another_meets_it_as_it_is() {
    const SPEED: Real = 8.0;
    let run = |change: Change, medial: [bool; 2]| {
        let ours = medial[0];
        let mut scene = Stepped::new(ours);
        let (dt, parts) = (1.0 / 60.0, if ours { 1 } else { 256 });
        scene.world.gravity = Vector::ZERO;
        scene.world.integration_parameters.dt = dt / parts as Real;
        // The surfaces meet at 0.43 of the second step.
        let x = 0.1 + SPEED * 1.43 * dt;
        let bar = |side: Real, at: Vector, end: Vector, medial: bool| {
            let body = RigidBodyBuilder::dynamic()
                .translation(at + Vector::X * (side * x))
                .linvel(Vector::X * (-side * SPEED))
                .ccd_enabled(!ours);
            let collider = capsule(medial, end, 0.1).friction(0.0).density(1000.0);
            (body, collider)
        };
        let (body, collider) = bar(-1.0, Vector::Y * 0.07, Vector::Y * 0.4, medial[0]);
        let (first, _) = scene.world.insert(body, collider);
        let (body, collider) = bar(1.0, Vector::Z * 0.03, Vector::Z * 0.5, medial[1]);
        let (second, collider) = scene.world.insert(body, collider);
        for step in 0..6 * parts {
            if step == parts {
                change(&mut scene.world, second, collider, medial[1]);
            }
            scene.step(&Log::default());
        }
        let of = |b: &RigidBody| [b.linvel() / SPEED, b.translation()];
        let bodies = [first, second].map(|h| scene.world.bodies.get(h).map(of));
        bodies.into_iter().flatten().flatten().collect::<Vec<_>>()
    };
    for (name, change) in CHANGES {
        let own = run(change, [false, false]);
        for partner in [true, false] {
            let ours = run(change, [true, partner]);
            assert_eq!(ours.len(), own.len(), "{name}");
            let off = ours.iter().zip(&own).map(|(a, b)| a.distance(*b));
            let off = off.fold(0.0, Real::max);
            println!("{name}, partner medial {partner}: off by {off:.3}");
            assert!(
                off < 0.1,
                "{name}, {partner}: {ours:.3?}, rapier's own {own:.3?}"
            );
        }
    }
}

/// Changes of a box that lies on the ground, and what takes them back: the same events as of rapier's boxes.
#[test]
fn what_lies_and_is_changed_is_told_as_rapiers() {
    let changes: [(&str, Change, Change); 6] = [
        ("nothing", |_, _, _, _| {}, |_, _, _, _| {}),
        (
            "groups",
            |w, _, c, _| w.colliders[c].set_collision_groups(InteractionGroups::none()),
            |w, _, c, _| w.colliders[c].set_collision_groups(InteractionGroups::all()),
        ),
        (
            "collider off",
            |w, _, c, _| w.colliders[c].set_enabled(false),
            |w, _, c, _| w.colliders[c].set_enabled(true),
        ),
        (
            "sensor",
            |w, _, c, _| w.colliders[c].set_sensor(true),
            |w, _, c, _| w.colliders[c].set_sensor(false),
        ),
        (
            "body off",
            |w, b, _, _| w.bodies[b].set_enabled(false),
            |w, b, _, _| w.bodies[b].set_enabled(true),
        ),
        (
            "body removed",
            |w, b, _, _| _ = w.remove_body(b),
            |_, _, _, _| {},
        ),
    ];
    for (name, change, back) in changes {
        same_events(name, |medial, log| {
            let mut scene = Stepped::new(medial);
            let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::Y * -0.5);
            scene.world.insert_collider(ground, None);
            let start = Vector::Y * 0.201;
            let body = RigidBodyBuilder::dynamic().translation(start);
            let collider = cuboid(medial, Vector::splat(0.2));
            let collider = collider.active_events(ActiveEvents::COLLISION_EVENTS);
            let (body, collider) = scene.world.insert(body, collider);
            for step in 0..60 {
                if step == 30 {
                    change(&mut scene.world, body, collider, medial);
                }
                if step == 45 {
                    back(&mut scene.world, body, collider, medial);
                    if let Some(body) = scene.world.bodies.get_mut(body) {
                        body.set_translation(start, true);
                        body.set_linvel(Vector::ZERO, true);
                    }
                }
                scene.step(log);
            }
        });
    }
}

/// Balls fly through a sensor at 2 and 20 m/s, and something is changed half way.
#[test]
fn sensors_that_are_changed_tell_as_rapiers() {
    let changes: [(&str, Change); 4] = [
        ("nothing", |_, _, _, _| {}),
        ("groups", |w, _, c, _| {
            w.colliders[c].set_collision_groups(InteractionGroups::none());
        }),
        ("collider off", |w, _, c, _| {
            w.colliders[c].set_enabled(false)
        }),
        ("removed", |w, b, _, _| _ = w.remove_body(b)),
    ];
    for speed in [2.0, 20.0] {
        for medial_sensor in [false, true] {
            for (name, change) in changes {
                same_events(&format!("{name}, {speed} m/s"), |medial, log| {
                    let mut scene = Stepped::new(medial);
                    scene.world.gravity = Vector::ZERO;
                    let events = ActiveEvents::COLLISION_EVENTS;
                    let sensor = cuboid(medial && medial_sensor, Vector::splat(0.5));
                    let sensor = sensor.sensor(true).active_events(events);
                    scene.world.insert_collider(sensor, None);
                    let body = RigidBodyBuilder::dynamic()
                        .translation(Vector::NEG_X * 2.0)
                        .linvel(Vector::X * speed);
                    let collider = ball(medial, 0.2).active_events(events);
                    let (body, collider) = scene.world.insert(body, collider);
                    let steps = (240.0 / speed) as usize;
                    for step in 0..steps + 2 {
                        if step == steps / 2 {
                            change(&mut scene.world, body, collider, medial);
                        }
                        scene.step(log);
                    }
                });
            }
        }
    }
}

/// `ActiveCollisionTypes`: a kinematic ball flies at fixed and kinematic boxes, solid ones and sensors.
#[test]
fn kinds_of_pairs_are_told_as_rapiers() {
    use RigidBodyType::{Fixed, KinematicPositionBased, KinematicVelocityBased};
    for types in [
        ActiveCollisionTypes::default(),
        ActiveCollisionTypes::all(),
        ActiveCollisionTypes::empty(),
    ] {
        for sensor in [false, true] {
            for speed in [2.0, 30.0] {
                for other in [Fixed, KinematicVelocityBased, KinematicPositionBased] {
                    let name = format!("{types:?}, sensor {sensor}, {speed} m/s, {other:?}");
                    same_events(&name, |medial, log| {
                        let mut scene = Stepped::new(medial);
                        let events = ActiveEvents::COLLISION_EVENTS;
                        let told = |collider: ColliderBuilder| {
                            collider.active_collision_types(types).active_events(events)
                        };
                        let still = cuboid(medial, Vector::splat(0.5)).sensor(sensor);
                        let body = RigidBodyBuilder::new(other);
                        scene.world.insert(body, told(still));
                        let flying = RigidBodyBuilder::kinematic_velocity_based()
                            .translation(Vector::NEG_X * 2.0)
                            .linvel(Vector::X * speed);
                        scene.world.insert(flying, told(ball(medial, 0.2)));
                        for _ in 0..(240.0 / speed) as usize + 2 {
                            scene.step(log);
                        }
                    });
                }
            }
        }
    }
}
