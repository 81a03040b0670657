//! Bodies that are put into each other: spawned in one place, in the ground, in a wall, teleported. They come apart as
//! rapier's own shapes do, nothing holds them where they are, and what came apart stays apart.

use crate::bodies::*;
use crate::linking::{line, linking};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::TAU;

const PARTS: u32 = 24;

/// A ring: medial, or as a compound of as many capsules.
fn collider(medial: bool) -> ColliderBuilder {
    let mesh = ring(PARTS, 0.5, 0.12);
    if medial {
        return ColliderBuilder::medial_mesh(mesh);
    }
    let end = |k: u32| {
        let (sin, cos) = (TAU * k as Real / PARTS as Real).sin_cos();
        Vector::new(0.5 * cos, 0.0, 0.5 * sin)
    };
    let part = |k| SharedShape::capsule(end(k), end(k + 1), 0.12);
    let parts = (0..PARTS).map(|k| (Pose::IDENTITY, part(k)));
    let mass = mesh.mass_properties(1.0);
    ColliderBuilder::compound(parts.collect()).mass_properties(mass)
}

/// What rings spawned together did.
#[derive(Debug, Default)]
struct Outcome {
    /// Mean height at the end, metres.
    height: Real,
    /// Largest speed of all steps, metres per second.
    speed: Real,
    /// Most continuous queries in a step, and most bodies held in one.
    queries: u64,
    frozen: usize,
}

/// Rings spawned at one place above the ground, or in it, tilted one by one.
fn spawn(medial: bool, rings: usize, height: Real, seed: usize, steps: usize) -> Outcome {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    for k in 0..rings {
        let k = (k + 3 * seed) as Real;
        let tilt = Vector::new(0.7 * k, 0.3, 0.2 * k);
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(Vector::Y * height, tilt));
        world.insert(body, collider(medial));
    }
    let mut outcome = Outcome::default();
    for _ in 0..steps {
        let report = pipeline.step(&mut world);
        outcome.queries = outcome.queries.max(report.continuous_queries);
        outcome.frozen = outcome.frozen.max(report.frozen);
        let speeds = world.bodies.iter().map(|(_, b)| b.linvel().length());
        outcome.speed = speeds.fold(outcome.speed, Real::max);
    }
    let heights = world.bodies.iter().map(|(_, b)| b.translation().y);
    outcome.height = heights.sum::<Real>() / rings as Real;
    outcome
}

/// They fall at once, as the compounds do: two seconds later they lie on the ground, as high in the mean of three
/// heaps.
#[test]
fn rings_spawned_in_one_place_come_apart_and_fall() {
    for rings in [3, 8] {
        for height in [2.0, 0.3] {
            let mut heights = [0.0; 2];
            for seed in 0..3 {
                let [own, ours] = [false, true].map(|m| spawn(m, rings, height, seed, 120));
                let what = format!("{rings} rings, {height} m, seed {seed}: {ours:?}, {own:?}");
                println!("{what}");
                assert!(ours.speed < 1.5 * own.speed + 1.0, "{what}");
                assert!(ours.queries < 200 * rings as u64, "{what}");
                heights[0] += own.height / 3.0;
                heights[1] += ours.height / 3.0;
            }
            let off = (heights[1] - heights[0]).abs();
            assert!(off < 0.25, "{rings} rings, {height} m: {heights:?}");
        }
    }
}

/// What was spawned in each other and came apart is kept apart from then on: rings that are no longer linked are
/// thrown at each other, and stay unlinked.
#[test]
fn spawned_overlaps_that_came_apart_stay_apart() {
    for seed in 0..6 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let mesh = ring(PARTS, 0.5, 0.12);
        let rings = [0.0, 1.0].map(|k| {
            let tilt = Vector::new(1.1 * k + 0.1 * seed as Real, 0.3, 0.4 * k);
            let pose = Pose::new(Vector::X * 0.3 * k, tilt);
            world
                .insert(RigidBodyBuilder::dynamic().pose(pose), collider(true))
                .0
        });
        for _ in 0..240 {
            pipeline.step(&mut world);
        }
        let links = |world: &PhysicsWorld| {
            let [a, b] = rings.map(|h| line(&mesh, world.bodies[h].position()));
            linking(&a, &b)
        };
        let before = links(&world);
        for (k, ring) in rings.into_iter().enumerate() {
            let side = [1.0, -1.0][k];
            world.bodies[ring].set_linvel(Vector::new(20.0 * side, 3.0, 2.0 * side), true);
            world.bodies[ring].set_angvel(Vector::new(5.0, 7.0 * side, 9.0), true);
        }
        for step in 0..60 {
            pipeline.step(&mut world);
            assert_eq!(links(&world), before, "seed {seed}, step {step}");
        }
    }
}

/// A ring spawned or teleported across a wall is not held there: it moves about as far as the compound does.
#[test]
fn a_ring_put_across_a_wall_is_not_held() {
    let (points, triangles) = Cuboid::new(Vector::new(1.0, 1.0, 0.2)).to_trimesh();
    let walls: [(&str, ColliderBuilder); 3] = [
        ("cuboid", ColliderBuilder::cuboid(1.0, 1.0, 0.2)),
        (
            "hull",
            ColliderBuilder::convex_hull(&points).expect("a hull"),
        ),
        (
            "solid triangle mesh",
            ColliderBuilder::trimesh_with_flags(points, triangles, TriMeshFlags::ORIENTED)
                .expect("a box"),
        ),
    ];
    for (name, wall) in walls {
        for teleported in [false, true] {
            let left = |medial: bool| {
                let mut world = PhysicsWorld::new();
                world.gravity = Vector::ZERO;
                let mut pipeline = attached(&mut world);
                world.insert_collider(wall.clone(), None);
                let at = Vector::new(0.1, 0.2, 0.28);
                let start = if teleported { at + Vector::Z * 5.0 } else { at };
                let body = RigidBodyBuilder::dynamic()
                    .translation(start)
                    .can_sleep(false);
                let (ring, _) = world.insert(body, collider(medial));
                if teleported {
                    for _ in 0..5 {
                        pipeline.step(&mut world);
                    }
                    world.bodies[ring].set_translation(at, true);
                }
                let mut held = 0;
                for _ in 0..180 {
                    held += pipeline.step(&mut world).frozen;
                }
                let pose = *world.bodies[ring].position();
                (pose.translation, held)
            };
            let (own, ours) = (left(false), left(true));
            println!("{name}, teleported {teleported}: {ours:?}, compound {own:?}");
            let what = format!("{name}, teleported {teleported}: {ours:?}, compound {own:?}");
            assert_eq!(ours.1, 0, "{what}");
            assert!(ours.0.distance(own.0) < 0.35, "{what}");
        }
    }
}

/// Two linked rings, the upper one fixed, the lower one pulled down by 1,000 times its weight: deep in each other, and
/// linked. What `touch` does between two steps moves them against each other by nothing, or by far less than they are
/// deep.
fn stays_linked(name: &str, mut touch: impl FnMut(usize, &mut PhysicsWorld, &mut MedialPipeline)) {
    let mesh = ring(PARTS, 0.5, 0.06);
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let quarter = std::f32::consts::FRAC_PI_2;
    let upper = RigidBodyBuilder::fixed().rotation(Vector::X * quarter);
    let (upper, _) = world.insert(upper, ColliderBuilder::medial_mesh(mesh.clone()));
    let at = Pose::new(Vector::NEG_Y * (1.0 - 2.2 * 0.06), Vector::Z * quarter);
    let lower = RigidBodyBuilder::dynamic().pose(at).can_sleep(false);
    let lower_collider = ColliderBuilder::medial_mesh(mesh.clone()).density(1000.0);
    let (lower, _) = world.insert(lower, lower_collider);
    let weight = 9.81 * world.bodies[lower].mass();
    for step in 0..240 {
        let share = (step as Real / 120.0).min(1.0);
        let body = &mut world.bodies[lower];
        body.reset_forces(true);
        body.add_force(Vector::NEG_Y * 1000.0 * weight * share, true);
        if step >= 180 {
            touch(step, &mut world, &mut pipeline);
        }
        pipeline.step(&mut world);
        let [a, b] = [upper, lower].map(|h| line(&mesh, world.bodies[h].position()));
        assert_eq!(linking(&a, &b).abs(), 1, "{name}: unlinked at step {step}");
    }
}

#[test]
fn overlaps_by_pressing_do_not_count_as_spawned() {
    stays_linked("left alone", |_, _, _| ());
    stays_linked("a new pipeline", |step, world, pipeline| {
        if step == 180 {
            *pipeline = attached(world);
        }
    });
    stays_linked("all moved together", |_, world, _| {
        let handles: Vec<_> = world.bodies.iter().map(|(h, _)| h).collect();
        for h in handles {
            let body = &mut world.bodies[h];
            let at = body.translation() + Vector::X * 0.01;
            body.set_translation(at, true);
        }
    });
    stays_linked(
        "one gets a shape of nearly the same size",
        |step, world, _| {
            let radius = if step % 2 == 0 { 0.06 } else { 0.0601 };
            for (_, collider) in world.colliders.iter_mut() {
                collider.set_shape(SharedShape::medial_mesh(ring(PARTS, 0.5, radius)));
            }
        },
    );
    stays_linked("one moved by a hair", |step, world, _| {
        let by = if step % 2 == 0 { 1.0e-4 } else { -1.0e-4 };
        for (_, body) in world.bodies.iter_mut().filter(|(_, b)| b.is_fixed()) {
            let at = body.translation() + Vector::Y * by;
            body.set_translation(at, true);
        }
    });
}
