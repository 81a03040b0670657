//! Impacts within a step: who is told, who may collide, who gives way, and what is off.

use crate::bodies::*;
use crate::random::Random;
use crate::told::Record;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

pub fn ball_bar() -> MedialMesh {
    let ends = [-0.2, 0.2].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z), 0.05));
    MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a bar")
}

/// Two crossed bars, 4 m apart, that fly at each other along X at `speed` each.
pub fn crossed(
    speed: Real,
    body: impl Fn(usize, RigidBodyBuilder) -> RigidBodyBuilder,
    collider: impl Fn(usize, ColliderBuilder) -> ColliderBuilder,
) -> (PhysicsWorld, [RigidBodyHandle; 2], [ColliderHandle; 2]) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let both = [0, 1].map(|k| {
        let side = [1.0, -1.0][k];
        let pose = Pose::new(
            Vector::new(2.0 * side, 0.0, 0.0),
            Vector::new(1.5 * k as Real, 0.0, 0.0),
        );
        let built =
            RigidBodyBuilder::dynamic()
                .pose(pose)
                .linvel(Vector::new(-speed * side, 0.0, 0.0));
        let mesh = ColliderBuilder::medial_mesh(ball_bar());
        world.insert(body(k, built), collider(k, mesh))
    });
    (world, both.map(|b| b.0), both.map(|b| b.1))
}

pub fn passed(world: &PhysicsWorld, handles: [RigidBodyHandle; 2]) -> bool {
    let [a, b] = handles.map(|h| world.bodies[h].translation().x);
    a < b
}

#[test]
fn a_bounce_within_a_step_is_told_once() {
    let told = |c: ColliderBuilder| c.active_events(ActiveEvents::COLLISION_EVENTS);
    for restitution in [0.0, 0.5, 1.0] {
        let (mut world, handles, _) =
            crossed(60.0, |_, b| b, |_, c| told(c).restitution(restitution));
        let mut pipeline = attached(&mut world);
        let record = Record::default();
        let mut events = 0;
        for _ in 0..40 {
            events += pipeline.step_with_events(&mut world, &(), &record).events;
        }
        assert!(!passed(&world, handles) && events > 0);
        let told = record.take().starts();
        let starts = told.iter().filter(|s| **s).count();
        // Starts and stops take turns; a soft impact may leave the bodies in contact.
        assert!(starts >= 1, "restitution {restitution}: {told:?}");
        assert!(
            told.chunks(2).all(|c| c[0] && c.get(1) != Some(&true)),
            "{told:?}"
        );
        if restitution == 1.0 {
            assert_eq!(told, [true, false]);
        }
    }
}

struct Never;
impl PhysicsHooks for Never {
    fn filter_contact_pair(&self, _: &PairFilterContext) -> Option<SolverFlags> {
        None
    }
}

#[test]
fn filtered_pairs_fly_through_each_other() {
    let none = InteractionGroups::none();
    let fly = |collider: &dyn Fn(usize, ColliderBuilder) -> ColliderBuilder,
               hooks: &dyn PhysicsHooks| {
        let (mut world, handles, _) = crossed(60.0, |_, b| b, collider);
        let mut pipeline = attached(&mut world);
        let mut events = 0;
        for _ in 0..10 {
            events += pipeline.step_with_events(&mut world, hooks, &()).events;
        }
        (events, passed(&world, handles))
    };
    let hooked = |_: usize, c: ColliderBuilder| c.active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS);
    assert_eq!(fly(&hooked, &Never), (0, true), "filter of the user");
    assert_eq!(
        fly(&|_, c| c.collision_groups(none), &()),
        (0, true),
        "collision groups"
    );
    assert_eq!(
        fly(&|_, c| c.solver_groups(none), &()),
        (0, true),
        "solver groups"
    );
    assert_eq!(fly(&|k, c| c.sensor(k == 0), &()), (0, true), "sensor");
    let (events, through) = fly(&|_, c| c, &());
    assert!(events > 0 && !through, "none of these");
}

/// A head-on impact of two equal bars without restitution ends with both at their mean velocity, which
/// is that of the one that does not give way.
#[test]
fn bodies_that_do_not_give_way_keep_their_velocity() {
    let fly = |body: &dyn Fn(usize, RigidBodyBuilder) -> RigidBodyBuilder| {
        let (mut world, handles, _) = crossed(60.0, body, |_, c| c.friction(0.0));
        let mut pipeline = attached(&mut world);
        for _ in 0..10 {
            pipeline.step(&mut world);
        }
        assert!(!passed(&world, handles));
        handles.map(|h| world.bodies[h].linvel().x)
    };
    let equal = fly(&|_, b| b);
    assert!(equal.iter().all(|v| v.abs() < 0.1), "equal: {equal:?}");
    let dominant = fly(&|k, b| b.dominance_group(1 - k as i8));
    assert!(
        dominant.iter().all(|v| (v + 60.0).abs() < 0.1),
        "dominance: {dominant:?}"
    );
    let locked = fly(&|k, b| {
        if k == 0 {
            b.enabled_translations(false, true, true)
        } else {
            b
        }
    });
    // As in rapier: a locked body keeps the speed it has, and nothing changes it.
    assert!(
        locked.iter().all(|v| (v + 60.0).abs() < 0.1),
        "locked: {locked:?}"
    );
    for kind in [
        RigidBodyType::KinematicVelocityBased,
        RigidBodyType::KinematicPositionBased,
    ] {
        let (mut world, handles, _) = crossed(60.0, |_, b| b, |_, c| c.friction(0.0));
        world.bodies[handles[0]].set_body_type(kind, true);
        let mut pipeline = attached(&mut world);
        for step in 1..=10 {
            if kind == RigidBodyType::KinematicPositionBased {
                let x = 2.0 - step as Real;
                let body = &mut world.bodies[handles[0]];
                body.set_next_kinematic_translation(Vector::new(x, 0.0, 0.0));
            }
            pipeline.step(&mut world);
            assert!(!passed(&world, handles), "{kind:?}, step {step}");
        }
        assert!(
            (world.bodies[handles[0]].translation().x + 8.0).abs() < 1.0e-3,
            "{kind:?}"
        );
        assert!(
            (world.bodies[handles[1]].linvel().x + 60.0).abs() < 0.5,
            "{kind:?}"
        );
    }
}

/// A body between two that close in has more impacts than it may: it stops, and is not passed.
#[test]
fn a_body_in_a_press_is_not_passed() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let bar = |x: Real, v: Real, turn: Real| {
        let pose = Pose::new(Vector::new(x, 0.0, 0.0), Vector::new(turn, 0.0, 0.0));
        let body = RigidBodyBuilder::kinematic_velocity_based().pose(pose);
        body.linvel(Vector::new(v, 0.0, 0.0))
    };
    let collider = || ColliderBuilder::medial_mesh(ball_bar()).restitution(1.0);
    let wall = world.insert(bar(-1.0, 0.0, 0.0), collider()).0;
    let press = world.insert(bar(1.0, -50.0, 0.0), collider()).0;
    let between = RigidBodyBuilder::dynamic().rotation(Vector::new(1.5, 0.0, 0.0));
    let between = world.insert(between, collider()).0;
    let x = |world: &PhysicsWorld, h: RigidBodyHandle| world.bodies[h].translation().x;
    // The press comes within 0.25 m of the wall; the bar is 0.1 m thick.
    let mut frozen = 0;
    for _ in 0..2 {
        frozen += pipeline.step(&mut world).frozen;
        let order = [wall, between, press].map(|h| x(&world, h));
        assert!(order.is_sorted(), "{order:?}");
    }
    world.bodies[press].set_linvel(Vector::new(-4.0, 0.0, 0.0), true);
    for _ in 0..2 {
        frozen += pipeline.step(&mut world).frozen;
        let order = [wall, between, press].map(|h| x(&world, h));
        assert!(order.is_sorted(), "{order:?}");
    }
    println!("{frozen} frozen");
}

#[test]
fn effects_that_are_off_cost_nothing() {
    let run = |scene: Effects, own: Option<Effects>| {
        let (mut world, handles, colliders) = crossed(60.0, |_, b| b, |_, c| c);
        let mut options = MedialOptions::default();
        options.effects = scene;
        let mut pipeline = MedialPipeline::new(options);
        pipeline.attach(&mut world);
        if let Some(own) = own {
            pipeline.set_effects(colliders[0], own);
        }
        let mut total = [0; 3];
        for _ in 0..10 {
            let report = pipeline.step(&mut world);
            total[0] += report.continuous_queries as usize;
            total[1] += report.muted;
            total[2] += report.events;
        }
        (total, passed(&world, handles))
    };
    let on = {
        let mut on = Effects::default();
        on.continuous = Effect::On;
        on
    };
    assert_eq!(run(Effects::OFF, None), ([0; 3], true));
    assert_eq!(run(Effects::default(), Some(Effects::OFF)), ([0; 3], true));
    for (scene, own) in [(Effects::default(), None), (Effects::OFF, Some(on))] {
        let ([queries, muted, events], through) = run(scene, own);
        assert!(
            queries > 0 && events > 0 && !through,
            "{queries} {muted} {events}"
        );
    }
}

/// A heap that falls asleep, and a slow one, ask for nothing.
#[test]
fn slow_and_sleeping_scenes_run_no_continuous_query() {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    for k in 0..3 {
        let pose = Pose::translation(0.0, MINOR + 0.2 * k as Real, 0.0);
        add_ring(&mut world, As::Medial, pose);
    }
    for step in 0..200 {
        let report = pipeline.step(&mut world);
        let asked = (
            report.continuous_queries,
            report.muted,
            report.events,
            report.frozen,
        );
        assert_eq!(asked, (0, 0, 0, 0), "step {step}");
        let not_called_for = (report.continuous_jobs, report.stops, report.speculative);
        assert_eq!(not_called_for, (0, 0, 0), "step {step}");
    }
    assert!(world.bodies.iter().all(|(_, b)| b.is_sleeping()));
}

/// The same meeting in worlds a hundred times smaller, with rapier told so.
#[test]
fn bodies_meet_in_worlds_of_another_length_unit() {
    for scale in [0.01, 100.0] {
        let ends =
            [-0.2, 0.2].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z * scale), 0.05 * scale));
        let bar = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a bar");
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.length_unit = scale;
        let mut pipeline = attached(&mut world);
        let handles = [0, 1].map(|k| {
            let side = [scale, -scale][k];
            let pose = Pose::new(
                Vector::new(2.0 * side, 0.0, 0.0),
                Vector::new(1.5 * k as Real, 0.0, 0.0),
            );
            let body = RigidBodyBuilder::dynamic().pose(pose);
            let body = body.linvel(Vector::new(-60.0 * side, 0.0, 0.0));
            world
                .insert(body, ColliderBuilder::medial_mesh(bar.clone()))
                .0
        });
        for _ in 0..10 {
            pipeline.step(&mut world);
        }
        assert!(!passed(&world, handles), "scale {scale}");
    }
}

/// A dart flies through the hole of a ring that comes towards it, without touching it.
#[test]
fn darts_fly_through_the_hole_of_a_ring() {
    let mut random = Random(4242);
    for case in 0..160 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let start = 2.0 + random.unit();
        let ring = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, -start, 0.0))
            .linvel(Vector::new(0.0, random.within(20.0, 100.0), 0.0));
        let ring = world
            .insert(ring, ColliderBuilder::medial_mesh(ring_mesh()))
            .0;
        // The hole is 0.4 m wide; the dart, at most 0.05 + 0.2 m from the axis.
        let aside = random.within(0.0, 0.2);
        let angle = random.within(0.0, 6.0);
        let dart = RigidBodyBuilder::dynamic()
            .pose(Pose::new(
                Vector::new(aside * angle.cos(), start, aside * angle.sin()),
                Vector::new(std::f32::consts::FRAC_PI_2, 0.0, 0.0),
            ))
            .linvel(Vector::new(0.0, -random.within(20.0, 100.0), 0.0));
        let dart = world
            .insert(dart, ColliderBuilder::medial_mesh(ball_bar()))
            .0;
        let mut events = 0;
        let speeds = |world: &PhysicsWorld| [ring, dart].map(|h| world.bodies[h].linvel());
        let before = speeds(&world);
        for _ in 0..20 {
            events += pipeline.step(&mut world).events;
        }
        let y = |h: RigidBodyHandle| world.bodies[h].translation().y;
        assert!(y(ring) > y(dart), "case {case}: they have not met");
        assert_eq!((events, speeds(&world)), (0, before), "case {case}");
    }
}

fn ring_mesh() -> MedialMesh {
    ring(27, MAJOR, MINOR)
}

/// Pillars 5 mm thick that fly at each other, crossed, all meet.
#[test]
fn thin_pillars_meet() {
    let pillar = || {
        let ends = [-0.5, 0.5].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z), 0.0025));
        MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a pillar")
    };
    let mut random = Random(5252);
    for case in 0..40 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let handles = [0, 1].map(|k| {
            let side = [1.0, -1.0][k];
            let pose = Pose::new(
                Vector::new(
                    side * random.within(1.0, 3.0),
                    random.within(-0.15, 0.15),
                    0.0,
                ),
                Vector::new(random.within(1.2, 1.8) * k as Real, 0.0, 0.0),
            );
            let body = RigidBodyBuilder::dynamic().pose(pose);
            let body = body.linvel(Vector::new(-side * random.within(30.0, 120.0), 0.0, 0.0));
            world.insert(body, ColliderBuilder::medial_mesh(pillar())).0
        });
        let before = handles.map(|h| world.bodies[h].linvel());
        for _ in 0..12 {
            pipeline.step(&mut world);
        }
        for (h, v) in handles.iter().zip(before) {
            assert!(world.bodies[*h].linvel().distance(v) > 1.0, "case {case}");
        }
    }
}

/// A cuboid rests against a bar, then both are torn apart and thrown together: a muted pair that had
/// contacts before. parry's workspace kept indices of the manifolds that muting had emptied, and the
/// next request of the pair panicked.
#[test]
fn a_pair_that_had_contacts_is_muted_and_unmuted() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let bar = world
        .insert(
            RigidBodyBuilder::dynamic(),
            ColliderBuilder::medial_mesh(ball_bar()),
        )
        .0;
    let cuboid = RigidBodyBuilder::dynamic().translation(Vector::new(0.149, 0.0, 0.0));
    let cuboid = world
        .insert(cuboid, ColliderBuilder::cuboid(0.1, 0.1, 0.1))
        .0;
    let mut muted = 0;
    // Touching; near, and fast towards each other; touching again.
    // Each time moved too far for rapier to recycle its contacts.
    for (x, z, speed) in [(0.149, 0.0, 0.0), (0.152, 0.05, -20.0), (0.149, 0.0, 0.0)] {
        for (handle, at, v) in [(bar, [0.0; 2], 0.0), (cuboid, [x, z], speed)] {
            let body = &mut world.bodies[handle];
            body.set_position(Pose::translation(at[0], 0.0, at[1]), true);
            body.set_linvel(Vector::new(v, 0.0, 0.0), true);
            body.set_angvel(Vector::ZERO, true);
        }
        muted += pipeline.step(&mut world).muted;
    }
    assert!(muted > 0, "the pair was never muted");
}
