//! Two fast bodies among everything that rapier lets users do to them. Answers are planted: closed forms
//! of head-on impacts, momentum and energy, rapier's own flight of each body alone.

use crate::bodies::*;
use crate::impacts::{ball_bar, crossed, passed};
use crate::linking::{line, linking};
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Steps in which bodies 4 m apart at 2 × 60 m/s meet and part.
const STEPS: usize = 10;

fn run(world: &mut PhysicsWorld, steps: usize) -> usize {
    let mut pipeline = attached(world);
    (0..steps).map(|_| pipeline.step(world).events).sum()
}

fn speeds(world: &PhysicsWorld, handles: [RigidBodyHandle; 2]) -> [Real; 2] {
    handles.map(|h| world.bodies[h].linvel().x)
}

fn close(got: [Real; 2], planted: [Real; 2], within: Real, what: &str) {
    let off = (got[0] - planted[0]).abs().max((got[1] - planted[1]).abs());
    assert!(off < within, "{what}: {got:?}, planted {planted:?}");
}

pub fn smooth(c: ColliderBuilder) -> ColliderBuilder {
    c.friction(0.0).restitution(1.0)
}

/// Central impact of two masses: `v' = V − e (v − V)`, with the mean velocity `V`.
#[test]
fn unequal_masses_part_as_newton_says() {
    let mut random = Random(6001);
    for case in 0..24 {
        let density = [0, 1].map(|_| random.within(0.1, 10.0));
        let e = random.unit();
        let dense =
            |k: usize, c: ColliderBuilder| c.density(density[k]).restitution(e).friction(0.0);
        let (mut world, handles, _) = crossed(random.within(20.0, 150.0), |_, b| b, dense);
        let v = speeds(&world, handles);
        run(&mut world, 12);
        let mean = (density[0] * v[0] + density[1] * v[1]) / (density[0] + density[1]);
        let planted = v.map(|v| mean - e * (v - mean));
        close(
            speeds(&world, handles),
            planted,
            0.3,
            &format!("case {case}, e {e}"),
        );
        assert!(!passed(&world, handles), "case {case}");
    }
}

/// The mesh lies aside of its body's origin and is turned in it: the centres of mass still meet head-on.
#[test]
fn colliders_aside_of_their_body() {
    let aside = Pose::new(Vector::new(0.3, -1.0, 0.7), Vector::new(0.4, 0.0, 1.1));
    let body = |k: usize, b: RigidBodyBuilder| {
        let side = [1.0, -1.0][k];
        let wanted = Pose::new(
            Vector::new(2.0 * side, 0.0, 0.0),
            Vector::new(1.5 * k as Real, 0.0, 0.0),
        );
        b.pose(wanted * aside.inverse())
    };
    let (mut world, handles, _) = crossed(60.0, body, |_, c| smooth(c).position(aside));
    run(&mut world, STEPS);
    close(speeds(&world, handles), [60.0, -60.0], 0.3, "aside");
}

/// A rack of three bars on one body against another: momentum and energy stay, and nothing passes.
#[test]
fn a_body_of_several_colliders_keeps_momentum_and_energy() {
    for shift in [0.0, 0.13, 0.3] {
        let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
        for y in [-0.4, 0.4] {
            let more = smooth(ColliderBuilder::medial_mesh(ball_bar()));
            world.insert_collider(more.translation(Vector::new(0.0, y, 0.0)), Some(handles[0]));
        }
        world.bodies[handles[1]].set_translation(Vector::new(-2.0, shift, 0.0), true);
        for h in handles {
            world.bodies[h].set_allow_fast_rotation(true);
        }
        let totals = |world: &PhysicsWorld| {
            let bodies = handles.map(|h| &world.bodies[h]);
            let momentum = bodies.iter().map(|b| b.linvel() * b.mass());
            let energy: Real = bodies.iter().map(|b| b.kinetic_energy()).sum();
            (momentum.sum::<Vector>(), energy)
        };
        let mut pipeline = attached(&mut world);
        pipeline.step(&mut world); // rapier sums the masses of the three in its first step
        let (p, e) = totals(&world);
        let events: usize = (1..STEPS).map(|_| pipeline.step(&mut world).events).sum();
        let (q, f) = totals(&world);
        assert!(events > 0 && !passed(&world, handles), "shift {shift}");
        let scale = world.bodies[handles[1]].mass() * 60.0;
        assert!(
            (p - q).length() < 0.01 * scale,
            "shift {shift}: momentum {p}, then {q}"
        );
        assert!(
            (f / e - 1.0).abs() < 0.01,
            "shift {shift}: energy {e}, then {f}"
        );
    }
}

/// Bodies that appear, take another's slot, or are put elsewhere right before the step in which they meet.
#[test]
fn new_and_moved_bodies_meet_in_their_first_step() {
    let half_a_metre = |k: usize, b: RigidBodyBuilder| {
        let x = [0.4, -0.4][k];
        b.pose(Pose::new(
            Vector::new(x, 0.0, 0.0),
            Vector::new(1.5 * k as Real, 0.0, 0.0),
        ))
    };
    let (mut world, handles, _) = crossed(60.0, half_a_metre, |_, c| smooth(c));
    assert!(run(&mut world, 1) > 0, "inserted");
    close(speeds(&world, handles), [60.0, -60.0], 0.3, "inserted");

    let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
    let mut pipeline = attached(&mut world);
    pipeline.step(&mut world);
    world.remove_body(handles[0]);
    let body = RigidBodyBuilder::dynamic().linvel(Vector::new(-60.0, 0.0, 0.0));
    let body = body.translation(Vector::new(-0.6, 0.0, 0.0));
    let new = world
        .insert(body, smooth(ColliderBuilder::medial_mesh(ball_bar())))
        .0;
    assert_eq!(new.into_raw_parts().0, handles[0].into_raw_parts().0);
    assert!(pipeline.step(&mut world).events > 0, "slot used again");
    close(
        speeds(&world, [new, handles[1]]),
        [60.0, -60.0],
        0.3,
        "slot used again",
    );

    let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
    let mut pipeline = attached(&mut world);
    pipeline.step(&mut world);
    world.bodies[handles[0]].set_translation(Vector::new(-0.6, 0.0, 0.0), true);
    assert!(pipeline.step(&mut world).events > 0, "teleported");
    close(speeds(&world, handles), [60.0, -60.0], 0.3, "teleported");

    let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
    let mut pipeline = attached(&mut world);
    pipeline.step(&mut world);
    world.remove_body(handles[0]);
    let events: usize = (0..STEPS).map(|_| pipeline.step(&mut world).events).sum();
    assert_eq!(
        (events, world.bodies[handles[1]].linvel().x),
        (0, 60.0),
        "removed"
    );
    // Teleported over the other: it has not flown through what lies between.
    let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
    let mut pipeline = attached(&mut world);
    pipeline.step(&mut world);
    world.bodies[handles[0]].set_translation(Vector::new(-3.0, 0.0, 0.0), true);
    let events: usize = (0..STEPS).map(|_| pipeline.step(&mut world).events).sum();
    assert_eq!(
        (events, speeds(&world, handles)),
        (0, [-60.0, 60.0]),
        "over"
    );
}

/// A pair tied by a joint meets a third body: nothing passes, and momentum stays. Where the joint
/// turns contacts off, the tied two fly through each other.
#[test]
fn jointed_bodies_meet_others_as_free_ones_do() {
    let rope = |contacts: bool| RopeJointBuilder::new(100.0).contacts_enabled(contacts);
    for contacts in [true, false] {
        let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
        world.insert_impulse_joint(handles[0], handles[1], rope(contacts));
        run(&mut world, STEPS);
        assert_eq!(passed(&world, handles), !contacts, "contacts: {contacts}");
    }
    for multibody in [false, true] {
        let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| smooth(c));
        let beside = RigidBodyBuilder::dynamic()
            .translation(Vector::new(2.0, 0.6, 0.0))
            .linvel(Vector::new(-60.0, 0.0, 0.0));
        let collider = smooth(ColliderBuilder::medial_mesh(ball_bar()));
        let beside = world.insert(beside, collider).0;
        let joint = SphericalJointBuilder::new().local_anchor1(Vector::new(0.0, 0.6, 0.0));
        if multibody {
            assert!(
                world
                    .insert_multibody_joint(handles[0], beside, joint)
                    .is_some()
            );
        } else {
            world.insert_impulse_joint(handles[0], beside, joint);
        }
        let momentum = |world: &PhysicsWorld| -> Real {
            let all = [handles[0], handles[1], beside];
            all.iter()
                .map(|h| world.bodies[*h].linvel().x * world.bodies[*h].mass())
                .sum()
        };
        let mut pipeline = attached(&mut world);
        let (mut events, mut struck) = (0, 0.0);
        for step in 0..STEPS {
            let impacts = pipeline.step(&mut world).events;
            if events == 0 && impacts > 0 {
                struck = momentum(&world);
            }
            events += impacts;
            assert!(
                !passed(&world, handles),
                "multibody {multibody}, step {step}"
            );
        }
        assert!(events > 0, "multibody {multibody}");
        let hit = world.bodies[handles[1]].linvel().x;
        // rapier takes no velocity from the bodies of a new multibody: it stands still, and gets the other's.
        let bounced = if multibody { 5.0 } else { -55.0 };
        assert!(hit < bounced, "multibody {multibody}: bounces at {hit}");
        if multibody {
            let before = 60.0 * world.bodies[handles[1]].mass();
            assert!((struck - before).abs() < 0.01 * before, "{before} {struck}");
        } else {
            let after = momentum(&world);
            let m = world.bodies[beside].mass();
            assert!(
                (after + m * 60.0).abs() < 0.02 * m * 60.0,
                "momentum {after}"
            );
        }
    }
}

/// An eccentric impact of bodies that may not turn is a central one.
#[test]
fn bodies_with_locked_rotations_do_not_turn_in_eccentric_impacts() {
    let body = |k: usize, b: RigidBodyBuilder| {
        let at = Vector::new([2.0, -2.0][k], 0.15 * k as Real, 0.15 * k as Real);
        b.pose(Pose::new(at, Vector::new(1.5 * k as Real, 0.0, 0.0)))
            .lock_rotations()
    };
    let (mut world, handles, _) = crossed(60.0, body, |_, c| smooth(c));
    run(&mut world, STEPS);
    close(speeds(&world, handles), [60.0, -60.0], 0.3, "locked");
    for h in handles {
        assert_eq!(world.bodies[h].angvel(), Vector::ZERO);
    }
    let (mut world, handles, _) = crossed(
        60.0,
        |k, b| b.translation(Vector::new([2.0, -2.0][k], 0.08 * k as Real, 0.0)),
        |_, c| smooth(c),
    );
    world.bodies[handles[1]].set_rotation(Rotation::from_rotation_x(1.5), true);
    for h in handles {
        world.bodies[h].set_enabled_translations(true, false, false, true);
    }
    run(&mut world, STEPS);
    for h in handles {
        assert!(
            world.bodies[h].linvel().y.abs() < 1.0e-6,
            "{}",
            world.bodies[h].linvel()
        );
    }
}

/// Forces, gravity scale and damping make bodies fast, or slow, within the step: what counts is the
/// motion that they make. Equal bodies swap what each has in its flight alone.
#[test]
fn bodies_meet_at_the_speeds_that_forces_and_damping_make() {
    type Change = fn(&mut RigidBody, Real);
    let changes: [(&str, Real, Change); 4] = [
        ("force", 0.0, |b, side| {
            let push = Vector::new(-side * 3000.0 * b.mass(), 0.0, 0.0);
            b.reset_forces(true);
            b.add_force(push, true);
        }),
        ("gravity scale", 0.0, |b, side| {
            b.set_gravity_scale(-side * 300.0, true)
        }),
        ("damping", 90.0, |b, _| b.set_linear_damping(4.0)),
        ("angular damping", 60.0, |b, _| b.set_angular_damping(4.0)),
    ];
    for (what, speed, change) in changes {
        let fly = |alone: Option<usize>| {
            let (mut world, handles, _) = crossed(speed, |_, b| b, |_, c| smooth(c));
            world.gravity = Vector::new(10.0, 0.0, 0.0);
            if let Some(k) = alone {
                world.remove_body(handles[1 - k]);
            }
            if what != "gravity scale" {
                for h in handles
                    .iter()
                    .filter(|h| alone.is_none_or(|k| **h == handles[k]))
                {
                    world.bodies[*h].set_gravity_scale(0.0, true);
                }
            }
            let mut pipeline = attached(&mut world);
            let mut events = 0;
            for _ in 0..12 {
                for k in (0..2).filter(|k| alone.is_none_or(|a| a == *k)) {
                    change(&mut world.bodies[handles[k]], [1.0, -1.0][k]);
                }
                events += pipeline.step(&mut world).events;
            }
            let of = |k: usize| {
                let there = alone.is_none_or(|a| a == k);
                if there {
                    world.bodies[handles[k]].linvel().x
                } else {
                    0.0
                }
            };
            let through = alone.is_none() && passed(&world, handles);
            (events, through, [of(0), of(1)])
        };
        let (events, through, met) = fly(None);
        let alone = [fly(Some(0)).2[0], fly(Some(1)).2[1]];
        assert!(events > 0 && !through, "{what}: {events} events, {met:?}");
        if speed > 0.0 {
            close(met, [alone[1], alone[0]], 0.5, what);
        } else {
            assert!((met[0] + met[1]).abs() < 1.0, "{what}: {met:?}");
        }
    }
}

/// Bodies without restitution stop where their skins meet.
#[test]
fn skins_meet_first() {
    for skin in [0.0, 0.03, 0.1] {
        let skinned = |_: usize, c: ColliderBuilder| c.friction(0.0).contact_skin(skin);
        let (mut world, handles, _) = crossed(60.0, |_, b| b, skinned);
        run(&mut world, STEPS);
        let [a, b] = handles.map(|h| world.bodies[h].translation().x);
        let gap = a - b - 0.1 - 2.0 * skin;
        assert!((-0.006..0.003).contains(&gap), "skin {skin}: {gap} apart");
        close(speeds(&world, handles), [0.0, 0.0], 0.1, "skin");
    }
}

#[test]
fn bodies_meet_in_steps_of_changing_length() {
    for phase in 0..16 {
        let shifted = |k: usize, b: RigidBodyBuilder| {
            let x = [2.0 + 0.05 * phase as Real, -2.0][k];
            b.pose(Pose::new(
                Vector::new(x, 0.0, 0.0),
                Vector::new(1.5 * k as Real, 0.0, 0.0),
            ))
        };
        let (mut world, handles, _) = crossed(60.0, shifted, |_, c| smooth(c));
        let mut pipeline = attached(&mut world);
        let mut seconds = 0.0;
        for dt in [30.0, 240.0, 60.0, 1000.0, 20.0].into_iter().cycle() {
            world.integration_parameters.dt = 1.0 / dt;
            pipeline.step(&mut world);
            seconds += 1.0 / dt;
            if seconds > 0.12 {
                break;
            }
        }
        close(
            speeds(&world, handles),
            [60.0, -60.0],
            0.3,
            &format!("phase {phase}"),
        );
    }
}

type State = [(Pose, Vector, Vector); 2];

fn start(speed: Real) -> (PhysicsWorld, MedialPipeline, [RigidBodyHandle; 2]) {
    let (mut world, handles, _) = crossed(speed, |_, b| b.angvel(Vector::Y), |_, c| c);
    let pipeline = attached(&mut world);
    (world, pipeline, handles)
}

fn state(world: &PhysicsWorld, handles: [RigidBodyHandle; 2]) -> State {
    handles.map(|h| {
        let b = &world.bodies[h];
        (*b.position(), b.linvel(), b.angvel())
    })
}

fn alone(speed: Real) -> State {
    let (mut world, mut pipeline, handles) = start(speed);
    for _ in 0..STEPS {
        pipeline.step(&mut world);
    }
    state(&world, handles)
}

/// Two worlds stepped in turn, and on two threads, do what each does alone, bit by bit.
#[test]
fn worlds_do_not_disturb_each_other() {
    let planted = [alone(60.0), alone(75.0)];
    let (mut a, mut b) = (start(60.0), start(75.0));
    for _ in 0..STEPS {
        a.1.step(&mut a.0);
        b.1.step(&mut b.0);
    }
    assert_eq!([state(&a.0, a.2), state(&b.0, b.2)], planted);
    let threads = [60.0, 75.0].map(|speed| std::thread::spawn(move || alone(speed)));
    assert_eq!(threads.map(|t| t.join().expect("no panic")), planted);
}

/// Linked rings that spin fast stay linked.
#[test]
fn spinning_links_stay_linked() {
    let mesh = ring(16, MAJOR, MINOR);
    for seed in 0..6 {
        let mut random = Random(6100 + seed);
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let handles = [-0.35, 0.35].map(|x| {
            let turn = Vector::new(if x > 0.0 { 1.5 } else { 0.0 }, 0.0, 0.0);
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(Vector::new(x, 0.0, 0.0), turn))
                .linvel(random.direction() * 30.0)
                .angvel(random.direction() * 70.0);
            let handle = world
                .insert(body, ColliderBuilder::medial_mesh(mesh.clone()))
                .0;
            world.bodies[handle].set_allow_fast_rotation(true);
            handle
        });
        let mut pipeline = attached(&mut world);
        for step in 0..60 {
            let [a, b] = handles.map(|h| line(&mesh, world.bodies[h].position()));
            assert_eq!(linking(&a, &b).abs(), 1, "seed {seed}, step {step}");
            pipeline.step(&mut world);
        }
    }
}
