//! Apps without a window, stepped by hand: what works with bevy_rapier's own plugin works with this one, and medial
//! colliders hang, collide, load and are built.

#[cfg(feature = "assets")]
mod assets;

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::time::{TimePlugin, TimeUpdateStrategy};
use bevy_rapier3d::prelude::*;
use bevy_rapier3d_medial::prelude::*;
use std::f32::consts::FRAC_PI_2;
use std::time::Duration;

/// An app whose frames take a sixtieth of a second.
fn app(plugin: impl Plugin) -> App {
    let mut app = App::new();
    let frame = Duration::from_secs_f32(1.0 / 60.0);
    app.add_plugins((
        TaskPoolPlugin::default(),
        TimePlugin,
        TransformPlugin,
        plugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    app
}

fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

fn ground() -> (Collider, Transform) {
    (
        Collider::cuboid(20.0, 0.5, 20.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    )
}

/// All that an app shows its user, frame by frame.
#[derive(Resource, Default)]
struct Seen {
    poses: Vec<[f32; 7]>,
    collisions: Vec<CollisionEvent>,
    forces: Vec<ContactForceEvent>,
}

fn watch(
    mut seen: ResMut<Seen>,
    bodies: Query<&Transform, With<RigidBody>>,
    mut collisions: MessageReader<CollisionEvent>,
    mut forces: MessageReader<ContactForceEvent>,
) {
    for at in &bodies {
        let (p, q) = (at.translation, at.rotation);
        seen.poses.push([p.x, p.y, p.z, q.x, q.y, q.z, q.w]);
    }
    seen.collisions.extend(collisions.read().cloned());
    seen.forces.extend(forces.read().cloned());
}

/// What is a ghost touches nothing.
#[derive(SystemParam)]
struct Sieve<'w, 's> {
    ghosts: Query<'w, 's, &'static Ghost>,
}

#[derive(Component)]
struct Ghost;

impl BevyPhysicsHooks for Sieve<'_, '_> {
    fn filter_contact_pair(&self, pair: PairFilterContextView) -> Option<SolverFlags> {
        let ghost = [pair.collider1(), pair.collider2()]
            .iter()
            .any(|e| self.ghosts.contains(*e));
        (!ghost).then_some(SolverFlags::all())
    }
}

/// Poses of all bodies after each frame, the text of each collision message and the numbers of each force message,
/// with entities by the order in which they were spawned.
type Story = (
    Vec<[f32; 7]>,
    Vec<String>,
    Vec<([usize; 2], [f32; 8], bool)>,
);

/// Boxes and balls that fall on each other; one is despawned while it touches, one is filtered out by a hook.
fn own_shapes(plugin: impl Plugin, mode: TimestepMode) -> Story {
    let mut app = app(plugin);
    app.init_resource::<Seen>()
        .insert_resource(mode)
        .add_systems(Last, watch);
    let mut fallen = vec![app.world_mut().spawn(ground()).id()];
    for k in 0..9 {
        let shape = if k % 2 == 0 {
            Collider::cuboid(0.3, 0.2, 0.25)
        } else {
            Collider::ball(0.3)
        };
        let at = Transform::from_xyz(0.2 * (k % 3) as f32, 0.5 + 0.7 * k as f32, 0.1 * k as f32);
        let told = ActiveEvents::COLLISION_EVENTS | ActiveEvents::CONTACT_FORCE_EVENTS;
        let ends = TransformInterpolation::default();
        let body = (
            RigidBody::Dynamic,
            shape,
            at,
            told,
            ends,
            ActiveHooks::FILTER_CONTACT_PAIRS,
        );
        let mut body = app.world_mut().spawn(body);
        if k == 8 {
            body.insert(Ghost);
        }
        fallen.push(body.id());
    }
    run(&mut app, 70);
    app.world_mut().despawn(fallen[1]);
    run(&mut app, 130);
    let number = |entity| {
        fallen
            .iter()
            .position(|e| *e == entity)
            .expect("one of ours")
    };
    let seen = app.world().resource::<Seen>();
    let collisions = seen.collisions.iter().map(|event| match event {
        CollisionEvent::Started(a, b, flags) => {
            format!("{} starts on {}, {flags:?}", number(*a), number(*b))
        }
        CollisionEvent::Stopped(a, b, flags) => {
            format!("{} stops on {}, {flags:?}", number(*a), number(*b))
        }
    });
    let forces = seen.forces.iter().map(|e| {
        let (f, d) = (e.total_force, e.max_force_direction);
        let numbers = [
            f.x,
            f.y,
            f.z,
            d.x,
            d.y,
            d.z,
            e.total_force_magnitude,
            e.max_force_magnitude,
        ];
        (
            [number(e.collider1), number(e.collider2)],
            numbers,
            e.started,
        )
    });
    (seen.poses.clone(), collisions.collect(), forces.collect())
}

#[test]
fn rapiers_own_shapes_move_and_tell_as_with_its_own_plugin() {
    let dt = 1.0 / 90.0;
    for mode in [
        TimestepMode::Fixed {
            dt: 1.0 / 60.0,
            substeps: 2,
        },
        TimestepMode::Variable {
            max_dt: 1.0 / 60.0,
            time_scale: 0.7,
            substeps: 1,
        },
        TimestepMode::Interpolated {
            dt,
            time_scale: 1.0,
            substeps: 1,
        },
        TimestepMode::Interpolated {
            dt: 1.0 / 25.0,
            time_scale: 0.5,
            substeps: 3,
        },
    ] {
        let own = own_shapes(RapierPhysicsPlugin::<Sieve>::default(), mode);
        let ours = own_shapes(RapierMedialPlugin::<Sieve>::default(), mode);
        let (poses, collisions, forces) = &own;
        let removed = |e: &String| e.contains("stops") && e.contains("REMOVED");
        assert!(
            collisions.iter().any(removed) && !forces.is_empty(),
            "nothing is told: {mode:?}"
        );
        assert!(
            poses.iter().any(|p| p[1] < -1.0),
            "the hook lets nothing through: {mode:?}"
        );
        assert_eq!(ours.1, own.1, "{mode:?}");
        assert_eq!(ours.0, own.0, "{mode:?}");
        assert_eq!(ours.2, own.2, "{mode:?}");
    }
}

/// A bar along x at height 2 and an upright ring about it.
fn bar_and_ring(app: &mut App, speed: f32) -> [Entity; 2] {
    let bar = MedialMesh::capsule(Vec3::NEG_X * 2.0, Vec3::X * 2.0, 0.08).expect("a bar");
    let bar = (
        MedialCollider::from(bar),
        Transform::from_xyz(0.0, 2.0, 0.0),
    );
    let bar = app.world_mut().spawn(bar).id();
    let ring = MedialMesh::torus(0.5, 0.1, 24).expect("a ring");
    let upright = Quat::from_rotation_z(FRAC_PI_2);
    let at = Transform::from_xyz(0.0, 1.75, 0.0).with_rotation(upright);
    let flying = Velocity {
        linear: Vec3::NEG_Y * speed,
        angular: Vec3::ZERO,
    };
    let told = ActiveEvents::COLLISION_EVENTS | ActiveEvents::CONTACT_FORCE_EVENTS;
    let ring = (
        RigidBody::Dynamic,
        MedialCollider::from(ring),
        at,
        flying,
        told,
        CollidingEntities::default(),
    );
    [bar, app.world_mut().spawn(ring).id()]
}

#[test]
fn a_ring_thrown_at_the_bar_through_it_hangs_and_tells() {
    for speed in [0.0, 30.0, 120.0] {
        let mut app = app(RapierMedialPlugin::<NoUserData>::default());
        app.init_resource::<Seen>().add_systems(Last, watch);
        let [bar, ring] = bar_and_ring(&mut app, speed);
        run(&mut app, 300);
        let world = app.world();
        let height = world
            .get::<Transform>(ring)
            .expect("the ring")
            .translation
            .y;
        assert!(
            (1.2..2.8).contains(&height),
            "thrown at {speed} m/s it is at {height} m"
        );
        assert!(
            world
                .get::<CollidingEntities>(ring)
                .is_some_and(|with| with.contains(bar)),
            "{speed} m/s"
        );
        let seen = world.resource::<Seen>();
        let pair = |a, b| (a, b) == (bar, ring) || (a, b) == (ring, bar);
        let started =
            |e: &CollisionEvent| matches!(e, CollisionEvent::Started(a, b, _) if pair(*a, *b));
        assert!(seen.collisions.iter().any(started), "{speed} m/s");
        assert!(
            seen.forces.iter().any(|e| pair(e.collider1, e.collider2)),
            "{speed} m/s"
        );
    }
}

#[test]
fn a_collider_takes_the_scale_of_its_entity_and_goes_with_its_component() {
    let mut app = app(RapierMedialPlugin::<NoUserData>::default());
    app.world_mut().spawn(ground());
    let ball = MedialMesh::ball(0.25).expect("a ball");
    let at = Transform::from_xyz(0.0, 3.0, 0.0).with_scale(Vec3::splat(2.0));
    let ball = app
        .world_mut()
        .spawn((RigidBody::Dynamic, MedialCollider::from(ball), at))
        .id();
    run(&mut app, 240);
    let height = |app: &App| {
        app.world()
            .get::<Transform>(ball)
            .expect("the ball")
            .translation
            .y
    };
    assert!(
        (height(&app) - 0.5).abs() < 0.01,
        "a ball of radius 0.25, twice as large, rests at {}",
        height(&app)
    );
    app.world_mut().entity_mut(ball).remove::<MedialCollider>();
    run(&mut app, 60);
    app.world_mut()
        .entity_mut(ball)
        .insert(Velocity::linear(Vec3::NEG_Y));
    run(&mut app, 60);
    assert!(
        height(&app) < 0.0,
        "without its collider it is at {}",
        height(&app)
    );
}

#[test]
fn every_physics_world_has_medial_colliders() {
    let mut app = app(RapierMedialPlugin::<NoUserData>::default());
    run(&mut app, 1);
    let second = app
        .world_mut()
        .spawn(RapierContextSimulation::default())
        .id();
    let link = RapierContextEntityLink(second);
    run(&mut app, 1);
    let [bar, ring] = bar_and_ring(&mut app, 60.0);
    app.world_mut().entity_mut(bar).insert(link);
    app.world_mut().entity_mut(ring).insert(link);
    run(&mut app, 300);
    let height = app
        .world()
        .get::<Transform>(ring)
        .expect("the ring")
        .translation
        .y;
    assert!(
        (1.2..2.8).contains(&height),
        "in a second world the ring is at {height} m"
    );
    let report = app
        .world()
        .get::<MedialWorld>(second)
        .expect("its pipeline")
        .report();
    assert!(report.contacts > 0, "{report:?}");
}
