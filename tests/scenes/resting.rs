//! Rings come to rest where rings would: on the ground, on each other, over a pillar, in each other.
//! The same scenes with rapier's convex hulls end elsewhere, which shows that these can fail.

use crate::bodies::*;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// Ten seconds of simulated time: every scene here rests within a third of it.
const LIMIT: usize = 600;

/// rapier's contacts at rest overlap by less than this (its allowed linear error is 5 mm).
const OVERLAP: Real = 0.006;

#[test]
fn a_flat_ring_sleeps() {
    let mut world = world_with_ground();
    let ring = add_ring(&mut world, As::Medial, Pose::translation(0.0, 0.3, 0.0));
    let mut pipeline = attached(&mut world);
    assert!(steps_until_sleep(&mut world, &mut pipeline, LIMIT).is_some());
    let height = world.bodies[ring].translation().y;
    assert!((height - MINOR).abs() < OVERLAP, "rests at {height}");
}

/// Five rings, one on top of the other; heights of their centres once all sleep.
fn stack(kind: As) -> (Option<usize>, Vec<Real>) {
    let mut world = world_with_ground();
    let rings: Vec<_> = (0..5)
        .map(|i| {
            add_ring(
                &mut world,
                kind,
                Pose::translation(0.0, 0.1 + 0.25 * i as Real, 0.0),
            )
        })
        .collect();
    let mut pipeline = attached(&mut world);
    let steps = steps_until_sleep(&mut world, &mut pipeline, LIMIT);
    let heights = rings.iter().map(|r| world.bodies[*r].translation().y);
    (steps, heights.collect())
}

#[test]
fn a_stack_of_five_sleeps() {
    let (steps, heights) = stack(As::Medial);
    assert!(steps.is_some(), "never slept: {heights:?}");
    for (i, height) in heights.iter().enumerate() {
        let expected = MINOR + 2.0 * MINOR * i as Real;
        assert!(
            (height - expected).abs() < OVERLAP * (i + 1) as Real,
            "ring {i} rests at {height}, expected {expected}"
        );
    }
}

#[test]
fn a_stack_of_hulls_does_not() {
    let (steps, heights) = stack(As::Hull);
    let stands = heights
        .iter()
        .enumerate()
        .all(|(i, h)| (h - MINOR * (1 + 2 * i) as Real).abs() < OVERLAP * (i + 1) as Real);
    assert!(steps.is_none() || !stands, "{steps:?} {heights:?}");
}

/// A ring dropped, tilted, over a post thinner than its hole; where it ends.
fn drop_over_a_post(kind: As) -> (Option<usize>, Vector) {
    let mut world = world_with_ground();
    world.insert_collider(
        ColliderBuilder::cuboid(0.15, 1.5, 0.15).translation(Vector::new(0.0, 1.5, 0.0)),
        None,
    );
    let pose = Pose::new(Vector::new(0.1, 4.0, 0.0), Vector::new(0.2, 0.0, 0.1));
    let ring = add_ring(&mut world, kind, pose);
    let mut pipeline = attached(&mut world);
    let steps = steps_until_sleep(&mut world, &mut pipeline, LIMIT);
    (steps, world.bodies[ring].translation())
}

/// The post's axis is inside the ring's hole as seen from above.
fn around_the_post(center: Vector) -> bool {
    Vector::new(center.x, 0.0, center.z).length() < MAJOR - MINOR
}

#[test]
fn a_ring_falls_over_a_post_and_sleeps_around_it() {
    let (steps, center) = drop_over_a_post(As::Medial);
    assert!(steps.is_some(), "still moving at {center}");
    assert!(around_the_post(center), "ended at {center}");
    assert!((center.y - MINOR).abs() < OVERLAP, "ended at {center}");
    let (_, center) = drop_over_a_post(As::Hull);
    assert!(!around_the_post(center), "a hull has no hole: {center}");
}

/// A ring over a pillar that widens downwards; where it ends.
fn drop_over_a_cone(kind: As) -> (Option<usize>, Vector) {
    let mut world = world_with_ground();
    let spheres = vec![
        MedialSphere::new(Vector::new(0.0, 0.0, 0.0), 0.8),
        MedialSphere::new(Vector::new(0.0, 3.0, 0.0), 0.1),
    ];
    let pillar = MedialMesh::new(spheres, vec![[0, 1]], vec![]).unwrap();
    world.insert_collider(ColliderBuilder::medial_mesh(pillar), None);
    let ring = add_ring(&mut world, kind, Pose::translation(0.05, 3.5, 0.0));
    let mut pipeline = attached(&mut world);
    let steps = steps_until_sleep(&mut world, &mut pipeline, 2 * LIMIT);
    (steps, world.bodies[ring].translation())
}

#[test]
fn a_ring_hangs_on_a_pillar_and_sleeps() {
    let (steps, center) = drop_over_a_cone(As::Medial);
    assert!(steps.is_some(), "still moving at {center}");
    // The ring's inner radius is reached where the pillar is 0.4 wide: well above the ground.
    assert!(
        center.y > 1.0 && around_the_post(center),
        "ended at {center}"
    );
    let (_, center) = drop_over_a_cone(As::Hull);
    assert!(!around_the_post(center), "a hull has no hole: {center}");
}

/// A ring hung in a fixed one; where the lower one ends.
fn linked(kind: As) -> (Option<usize>, Vector) {
    let mut world = world_with_ground();
    let upright = Pose::new(Vector::new(0.0, 3.0, 0.0), Vector::new(FRAC_PI_2, 0.0, 0.0));
    world.insert(RigidBodyBuilder::fixed().pose(upright), ring_collider(kind));
    let across = Pose::new(
        Vector::new(0.0, 2.35, 0.0),
        Vector::new(0.0, 0.0, FRAC_PI_2),
    );
    let ring = add_ring(&mut world, kind, across);
    let mut pipeline = attached(&mut world);
    let steps = steps_until_sleep(&mut world, &mut pipeline, LIMIT);
    (steps, world.bodies[ring].translation())
}

#[test]
fn linked_rings_stay_linked_and_sleep() {
    let (steps, center) = linked(As::Medial);
    assert!(steps.is_some(), "still moving at {center}");
    // Inside of the lower ring on the inside of the upper: 3 − (major − minor) − (major − minor).
    let hangs = 3.0 - 2.0 * (MAJOR - MINOR);
    assert!(
        (center.y - hangs).abs() < 0.02,
        "hangs at {center}, expected {hangs}"
    );
    let (_, center) = linked(As::Hull);
    assert!(center.y < 1.0, "hulls cannot be linked: {center}");
}

#[test]
fn a_world_without_attach_has_contacts() {
    let mut world = world_with_ground();
    let lower = add_ring(&mut world, As::Medial, Pose::translation(0.0, 0.2, 0.0));
    let upper = add_ring(&mut world, As::Medial, Pose::translation(0.1, 0.6, 0.0));
    for _ in 0..300 {
        world.step();
    }
    let [low, high] = [lower, upper].map(|h| world.bodies[h].translation().y);
    assert!((low - MINOR).abs() < OVERLAP, "{low}");
    assert!((high - 3.0 * MINOR).abs() < 2.0 * OVERLAP, "{high}");
}

#[test]
fn the_report_counts_what_the_batch_did() {
    let mut world = world_with_ground();
    add_ring(&mut world, As::Medial, Pose::translation(0.0, 0.1, 0.0));
    add_ring(&mut world, As::Medial, Pose::translation(0.0, 0.2995, 0.0));
    let mut pipeline = attached(&mut world);
    let mut hits = 0;
    for _ in 0..20 {
        let report = pipeline.step(&mut world);
        assert_eq!(report.medial_colliders, 2);
        assert!(report.pairs <= 1, "{report:?}");
        hits += report.cache_hits;
        assert_eq!(
            report.cache_misses, 0,
            "the key was not the narrow phase's: {report:?}"
        );
    }
    assert!(hits > 0, "the narrow phase never asked");
    assert!(steps_until_sleep(&mut world, &mut pipeline, LIMIT).is_some());
    let asleep = pipeline.step(&mut world);
    assert_eq!((asleep.elementary_tests, asleep.continuous_queries), (0, 0));
}

/// A ball rolls on as rapier's own does, slow or fast. By parry's contacts of parts, which stay with the
/// material for a while, it went twice as fast after 2 s.
#[test]
fn a_ball_rolls_on() {
    let mesh = MedialMesh::ball(0.1).expect("a ball");
    let rolled = |collider: ColliderBuilder, speed: Real| {
        let mut world = world_with_ground();
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::Y * 0.1)
            .linvel(Vector::X * speed)
            .angvel(Vector::NEG_Z * speed / 0.1)
            .can_sleep(false);
        let body = world.insert(body, collider).0;
        let mut pipeline = attached(&mut world);
        (0..240).for_each(|_| {
            pipeline.step(&mut world);
        });
        world.bodies[body].linvel().x / speed
    };
    for speed in [0.05, 0.2, 1.0] {
        let ours = rolled(ColliderBuilder::medial_mesh(mesh.clone()), speed);
        let rapiers = rolled(ColliderBuilder::ball(0.1), speed);
        assert!((ours - rapiers).abs() < 5.0e-4, "{speed}: {ours} {rapiers}");
    }
}

/// Depth of a ring's lowest sphere in the ground at height 0 or of its farthest in the wall at 0, once it leans on
/// both; the mean of a dozen rings.
fn depth_of_leaning(collider: &ColliderBuilder, mesh: &MedialMesh) -> Real {
    let depths = (0..12).map(|k| {
        let mut world = PhysicsWorld::new();
        let turned = Pose::from_rotation(Rotation::from_axis_angle(Vector::Y, 0.5 * k as Real));
        let solids = [
            (Vector::Y * -0.01, 0.2, 0.01),
            (Vector::new(0.01, 0.1, 0.0), 0.01, 0.1),
        ];
        for (at, x, y) in solids {
            let solid = ColliderBuilder::cuboid(x, y, 0.2).friction(0.9);
            world.insert_collider(solid.position(turned * Pose::from_translation(at)), None);
        }
        let lean = FRAC_PI_2 - 0.3 - 0.08 * k as Real;
        let rotation = Rotation::from_axis_angle(Vector::Z, lean)
            * Rotation::from_axis_angle(Vector::Y, 0.7 * k as Real);
        let farthest = |axis: Vector| {
            let spheres = mesh.spheres().iter();
            let along = spheres.map(|s| axis.dot(rotation * s.center) + s.radius);
            along.fold(Real::MIN, Real::max)
        };
        let at = Vector::new(-farthest(Vector::X), farthest(Vector::NEG_Y), 0.0);
        let pose = turned * Pose::from_parts(at, rotation);
        let body = RigidBodyBuilder::dynamic().pose(pose);
        let (body, _) = world.insert(body, collider.clone().friction(0.9));
        let mut pipeline = attached(&mut world);
        assert!(steps_until_sleep(&mut world, &mut pipeline, LIMIT).is_some());
        let pose = turned.inverse() * world.bodies[body].position();
        let depths = mesh.spheres().iter().map(|s| {
            let center = pose * s.center;
            s.radius + center.x.max(-center.y)
        });
        depths.fold(0.0, Real::max)
    });
    depths.sum::<Real>() / 12.0
}

/// Symptom: rings that leaned on a wall came to rest four times as deep in the ground or the wall as rapier's own.
/// Cause: the contacts that bear did not include the deepest.
#[test]
fn leaning_rings_rest_about_as_deep_as_rapiers_own() {
    let mesh = MedialMesh::torus(0.05, 0.005, 24).expect("a ring");
    let center = |k: u32| mesh.spheres()[k as usize].center;
    let capsules = mesh.edges().iter().map(|&[a, b]| {
        let capsule = SharedShape::capsule(center(a), center(b), 0.005);
        (Pose::IDENTITY, capsule)
    });
    let own = ColliderBuilder::compound(capsules.collect());
    let medial = ColliderBuilder::medial_mesh(mesh.clone());
    let [ours, own] = [medial, own].map(|collider| depth_of_leaning(&collider, &mesh));
    assert!(ours < 1.2 * own, "{ours} m, rapier's own {own} m");
}
