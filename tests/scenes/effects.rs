//! Each effect: what goes wrong without it, planted, and that nothing is counted where nothing calls
//! for it. `docs/measurements/effects.md` has the table of all on random scenes.

use crate::bodies::*;
use crate::impacts::{ball_bar, crossed, passed};
use crate::told::Record;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

const DT: Real = 1.0 / 60.0;

/// The default effects but for what `change` does.
pub fn but(change: impl FnOnce(&mut Effects)) -> Effects {
    let mut effects = Effects::default();
    change(&mut effects);
    effects
}

pub fn attached_with(world: &mut PhysicsWorld, effects: Effects) -> MedialPipeline {
    let mut options = MedialOptions::default();
    options.effects = effects;
    let mut pipeline = MedialPipeline::new(options);
    pipeline.attach(world);
    pipeline
}

/// A single sphere.
fn ball(radius: Real) -> ColliderBuilder {
    let mesh = MedialMesh::ball(radius).expect("a ball");
    ColliderBuilder::medial_mesh(mesh)
}

fn smooth(collider: ColliderBuilder) -> ColliderBuilder {
    collider.friction(0.0).restitution(1.0)
}

fn add(
    world: &mut PhysicsWorld,
    at: Vector,
    v: Vector,
    collider: ColliderBuilder,
) -> RigidBodyHandle {
    let body = RigidBodyBuilder::dynamic().translation(at).linvel(v);
    world.insert(body, collider).0
}

#[test]
fn without_continuous_bodies_pass() {
    for (effects, through) in [
        (Effects::default(), false),
        (but(|e| e.continuous = Effect::Off), true),
    ] {
        let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| c);
        let mut pipeline = attached_with(&mut world, effects);
        for _ in 0..10 {
            pipeline.step(&mut world);
        }
        assert_eq!(passed(&world, handles), through, "{effects:?}");
    }
}

/// A kinematic bar presses a free one against a wall, so slowly that no step is fast. As long as there is room (after
/// 31 steps 25 mm are left between its axis and the wall) rapier's contacts alone keep the bars apart, and so they are
/// with the impacts that the guard, and no other effect, gives them.
#[test]
fn a_slow_press_crosses_nothing_while_there_is_room() {
    for (effects, is_guarded) in [
        (Effects::default(), true),
        (but(|e| e.continuous = Effect::Off), true),
        (but(|e| e.guard = Effect::Off), false),
        (Effects::OFF, false),
    ] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached_with(&mut world, effects);
        let wall = ColliderBuilder::cuboid(0.5, 2.0, 2.0).translation(Vector::new(-0.56, 0.0, 0.0));
        world.insert_collider(wall, None);
        let bar = |x: Real, turn: Real| Pose::new(Vector::new(x, 0.0, 0.0), Vector::X * turn);
        let free = RigidBodyBuilder::dynamic().pose(bar(0.0, 0.0));
        let free = world
            .insert(free, ColliderBuilder::medial_mesh(ball_bar()))
            .0;
        let driven = RigidBodyBuilder::kinematic_velocity_based()
            .pose(bar(0.12, 1.5))
            .linvel(Vector::new(-0.3, 0.0, 0.0));
        let driven = world
            .insert(driven, ColliderBuilder::medial_mesh(ball_bar()))
            .0;
        let (mut events, mut nearest) = (0, Real::MAX);
        for _ in 0..31 {
            events += pipeline.step(&mut world).events;
            let [free, driven] = [free, driven].map(|h| *world.bodies[h].position());
            let ends = [-0.2, 0.2].map(|z| (free * (Vector::Z * z)).x);
            let to_wall = ends[0].min(ends[1]) + 0.06;
            nearest = nearest
                .min(to_wall)
                .min(driven.translation.x - free.translation.x);
        }
        // The bars are across each other, so that their axes cross where their centres pass.
        assert!(nearest > 0.0, "{effects:?}: {nearest}");
        assert_eq!(events > 0, is_guarded, "{effects:?}: {events} impacts");
    }
}

/// A bar lies on the ground, and one 10,000 times as heavy is laid across it: the guard holds them half a thickness
/// deep, a quarter of the sum of their radii. Without it the heavy one sinks in until its ends are on the ground, too.
#[test]
fn without_the_guard_a_heavy_load_sinks_in() {
    let depth = |effects: Effects| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached_with(&mut world, effects);
        world.insert_collider(ColliderBuilder::cuboid(2.0, 0.5, 2.0), None);
        let bar = |y: Real, turn: Real| {
            RigidBodyBuilder::dynamic().pose(Pose::new(Vector::Y * y, Vector::Y * turn))
        };
        let collider = || ColliderBuilder::medial_mesh(ball_bar());
        let light = world.insert(bar(0.55, 0.0), collider()).0;
        let heavy = world.insert(bar(0.655, 1.2), collider().density(1.0e4)).0;
        let mut deepest: Real = 0.0;
        for _ in 0..90 {
            pipeline.step(&mut world);
            let heights = [light, heavy].map(|h| world.bodies[h].translation().y);
            deepest = deepest.max(0.1 - (heights[1] - heights[0]));
        }
        deepest / 0.1
    };
    let kept = depth(Effects::default());
    assert!(kept < 0.3, "{kept}");
    let sunk = depth(but(|e| e.guard = Effect::Off));
    assert!(sunk > 0.6, "{sunk}");
}

/// The end of a turning bar goes round a ball that the straight path of that end leaves aside: 1.4 rad in
/// a step, where the chord's middle is at 0.76 of the radius.
#[test]
fn without_exact_rotation_a_turn_is_cut_short() {
    let swing = |effects: Effects| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached_with(&mut world, effects);
        let ends = [-1.0, 1.0].map(|x| MedialSphere::new(Vector::X * x, 0.03));
        let rod = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a rod");
        let turn = 1.4;
        let body = RigidBodyBuilder::dynamic().angvel(Vector::Y * turn / DT);
        let rod = world.insert(body, ColliderBuilder::medial_mesh(rod)).0;
        world.bodies[rod].set_allow_fast_rotation(true);
        let (sin, cos) = (0.5f32 * turn).sin_cos();
        let met = add(
            &mut world,
            Vector::new(0.92 * cos, 0.0, -0.92 * sin),
            Vector::ZERO,
            ball(0.05),
        );
        let report = pipeline.step(&mut world);
        (
            report.events > 0,
            world.bodies[met].linvel().length() > 1.0,
            report.rotating_queries > 0,
        )
    };
    for effects in [Effects::default(), but(|e| e.exact_rotation = Effect::On)] {
        assert_eq!(swing(effects), (true, true, true));
    }
    assert_eq!(
        swing(but(|e| e.exact_rotation = Effect::Off)),
        (false, false, false)
    );
}

/// A ring that lies flat.
#[test]
fn without_full_manifolds_nothing_rests() {
    let lie = |effects: Effects, own: Option<Effects>| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached_with(&mut world, effects);
        let ground = [-3.0, 3.0].map(|x| [-3.0, 3.0].map(|z| Vector::new(x, -0.2, z)));
        let spheres = ground
            .concat()
            .into_iter()
            .map(|c| MedialSphere::new(c, 0.2));
        let plate = MedialMesh::new(spheres.collect(), vec![], vec![[0, 1, 2], [1, 2, 3]]);
        world.insert_collider(ColliderBuilder::medial_mesh(plate.expect("a plate")), None);
        let pose = Pose::new(Vector::new(0.0, MINOR + 0.2, 0.0), Vector::X * 0.2);
        let ring = add_ring(&mut world, As::Medial, pose);
        if let Some(own) = own {
            pipeline.set_effects(world.bodies[ring].colliders()[0], own);
        }
        steps_until_sleep(&mut world, &mut pipeline, 300)
    };
    let one = but(|e| e.full_manifolds = Effect::Off);
    let full = but(|e| e.full_manifolds = Effect::On);
    for (scene, own) in [(Effects::default(), None), (one, Some(full))] {
        assert!(lie(scene, own).is_some(), "{scene:?} {own:?}");
    }
    for (scene, own) in [(one, None), (Effects::default(), Some(one))] {
        assert!(lie(scene, own).is_none(), "{scene:?} {own:?}");
    }
}

/// rapier's speculative contacts keep fast bodies from passing each other, and stop some that would
/// have passed by: a bar on its way through the hole of a ring.
#[test]
fn speculative_contacts_stop_what_passes_by() {
    let only = but(|e| {
        e.continuous = Effect::Off;
        e.speculative = Effect::On;
    });
    let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| c);
    let mut pipeline = attached_with(&mut world, only);
    let mut bodies = 0;
    for _ in 0..10 {
        let report = pipeline.step(&mut world);
        bodies += report.speculative;
        assert_eq!((report.muted, report.events), (0, 0));
    }
    assert!(!passed(&world, handles) && bodies == 20, "{bodies}");
    assert!(
        handles
            .iter()
            .all(|h| world.bodies[*h].soft_ccd_prediction() == 0.0)
    );

    let through_the_hole = |effects: Effects| {
        (0..16)
            .filter(|phase| {
                let mut world = PhysicsWorld::new();
                world.gravity = Vector::ZERO;
                let mut pipeline = attached_with(&mut world, effects);
                let ring = ColliderBuilder::medial_mesh(ring(27, 0.5, 0.1));
                add(&mut world, Vector::ZERO, Vector::ZERO, ring);
                let at = Vector::new(0.25, 3.0 + *phase as Real / 16.0, 0.0);
                let v = Vector::new(0.0, -60.0, 0.0);
                let dart = add(&mut world, at, v, ball(0.05));
                for _ in 0..12 {
                    pipeline.step(&mut world);
                }
                world.bodies[dart].linvel() != v
            })
            .count()
    };
    assert_eq!(through_the_hole(Effects::default()), 0);
    let ghosts = through_the_hole(only);
    assert!(ghosts > 0, "no ghosts any more");
}

/// Two elastic balls exchange their velocities; beside them a body falls and a door is driven, and both
/// must not feel that the world stops.
#[test]
fn the_world_stops_at_a_first_contact() {
    let run = |stop: Effect| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached_with(&mut world, but(|e| e.stop = stop));
        let pair = [-1.0, 1.0].map(|x| {
            let at = Vector::new(2.37 * x, 0.0, 0.0);
            let body = RigidBodyBuilder::dynamic()
                .translation(at)
                .gravity_scale(0.0)
                .linvel(Vector::new(-50.0 * x, 0.0, 0.0));
            world.insert(body, smooth(ball(0.1))).0
        });
        let falls = add(&mut world, Vector::new(9.0, 0.0, 0.0), Vector::X, ball(0.1));
        let door = RigidBodyBuilder::kinematic_position_based().translation(Vector::Y * 20.0);
        let door = world.insert(door, ColliderBuilder::cuboid(0.1, 1.0, 1.0)).0;
        let (mut stops, mut events) = (0, 0);
        for step in 0..6 {
            let target = Vector::new(0.1 * (step + 1) as Real, 20.0, 0.0);
            world.bodies[door].set_next_kinematic_translation(target);
            let report = pipeline.step(&mut world);
            stops += report.stops;
            events += report.events;
            assert!(world.bodies[door].translation().distance(target) < 1.0e-5);
        }
        let speeds = pair.map(|h| world.bodies[h].linvel().x);
        let fallen = &world.bodies[falls];
        (
            (stops, events),
            speeds,
            fallen.translation(),
            fallen.linvel(),
        )
    };
    let (counts, speeds, at, v) = run(Effect::On);
    let (counts_without, _, at_without, v_without) = run(Effect::Off);
    assert_eq!((counts, counts_without), ((1, 0), (0, 1)));
    assert!(
        (speeds[0] + 50.0).abs() < 0.5 && (speeds[1] - 50.0).abs() < 0.5,
        "{speeds:?}"
    );
    assert!(at.distance(at_without) < 1.0e-3, "{at}, {at_without}");
    assert!(v.distance(v_without) < 1.0e-4, "{v}, {v_without}");
}

/// The bounce of a world that stops is told once; with links of a multibody in the world, which cannot be
/// put back, it is an impulse as without the effect.
#[test]
fn stops_are_told_once_and_leave_multibodies_alone() {
    for links in [false, true] {
        let (mut world, handles, _) = crossed(
            60.0,
            |_, b| b,
            |_, c| smooth(c).active_events(ActiveEvents::COLLISION_EVENTS),
        );
        if links {
            let link = |x: Real| RigidBodyBuilder::dynamic().translation(Vector::new(x, 50.0, 0.0));
            let pair = [0.0, 1.0].map(|x| world.insert(link(x), ball(0.1)).0);
            let joint = SphericalJointBuilder::new().local_anchor2(-Vector::X);
            let joined = world.insert_multibody_joint(pair[0], pair[1], joint);
            assert!(joined.is_some());
        }
        let mut pipeline = attached_with(&mut world, but(|e| e.stop = Effect::On));
        let record = Record::default();
        let (mut stops, mut events) = (0, 0);
        for _ in 0..10 {
            let report = pipeline.step_with_events(&mut world, &(), &record);
            stops += report.stops;
            events += report.events;
        }
        assert!(!passed(&world, handles));
        let counts = if links { (0, 1) } else { (1, 0) };
        assert_eq!((stops, events), counts, "links: {links}");
        let told = record.take();
        assert_eq!(told.starts(), [true, false], "links: {links}");
    }
}

/// Two equal bars side by side land on each other with both ends at once, without a bounce. Impulses one
/// after the other turn them into each other first; the solver at the first contact does both ends.
#[test]
fn without_stops_impacts_at_once_sink_in() {
    let land = |stop: Effect| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached_with(&mut world, but(|e| e.stop = stop));
        let bar = || {
            let ends = [-0.5, 0.5].map(|z| MedialSphere::new(Vector::Z * z, 0.1));
            let mesh = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a bar");
            ColliderBuilder::medial_mesh(mesh).restitution(0.0)
        };
        let pair = [-1.0, 1.0].map(|x| {
            let v = Vector::new(-20.0 * x, 0.0, 0.0);
            add(&mut world, Vector::new(1.27 * x, 0.0, 0.0), v, bar())
        });
        let mut stops = 0;
        let gap_of_ends = |world: &PhysicsWorld, z: Real| {
            let [a, b] = pair.map(|h| world.bodies[h].position() * (Vector::Z * z));
            b.x - a.x - 0.2
        };
        let mut least: Real = 0.0;
        for _ in 0..8 {
            stops += pipeline.step(&mut world).stops;
            let ends = [-0.5, 0.5].map(|z| gap_of_ends(&world, z));
            least = ends.into_iter().fold(least, Real::min);
        }
        (stops, least)
    };
    let (stops, depth) = land(Effect::On);
    assert!(stops == 1 && depth > -1.0e-3, "{stops}, {depth}");
    let (stops, depth) = land(Effect::Off);
    assert!(stops == 0 && depth < -0.02, "{stops}, {depth}");
}

/// Sensors are asked whether they intersect, and have no contacts.
#[test]
fn a_scene_of_sensors_has_no_manifolds() {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached_with(&mut world, Effects::default());
    for k in 0..4 {
        let pose = Pose::new(
            Vector::new(0.3 * k as Real, 0.0, 0.0),
            Vector::X * k as Real,
        );
        let body = RigidBodyBuilder::dynamic()
            .pose(pose)
            .linvel(Vector::X * (30.0 - 20.0 * k as Real));
        world.insert(body, ring_collider(As::Medial).sensor(true));
    }
    let mut intersections = 0;
    for _ in 0..10 {
        let report = pipeline.step(&mut world);
        intersections += report.intersections;
        assert_eq!(
            (report.medial_colliders, report.pairs, report.jobs),
            (4, 0, 0)
        );
        assert_eq!(
            (
                report.contacts as u64,
                report.manifolds,
                report.cache_misses
            ),
            (0, 0, 0)
        );
        assert_eq!((report.muted, report.events, report.stops), (0, 0, 0));
    }
    assert!(intersections > 0);
}
