//! A step's budget: whatever it is, nothing passes through anything. What it does not pay for waits.

use crate::bodies::*;
use crate::heaps::{Findings, loops, throw};
use crate::knots;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// What the steps of a heap took: most of any budget in a step, steps in which bodies waited, and the poses at the end.
#[derive(Debug, PartialEq)]
struct Run {
    most: u64,
    waits: usize,
    poses: Vec<Pose>,
}

fn pipeline(world: &mut PhysicsWorld, budget: u64) -> MedialPipeline {
    let options = MedialOptions::default().budget(budget);
    let mut pipeline = MedialPipeline::new(options);
    pipeline.attach(world);
    pipeline
}

/// Rings and links thrown together at 60 m/s.
fn thrown(seed: u64, steps: usize, budget: u64) -> (Run, Findings) {
    let shapes = loops();
    let medial = |mesh: &MedialMesh| ColliderBuilder::medial_mesh(mesh.clone());
    let (mut world, bodies) = throw(&shapes, [3, 2, 3], 60.0, seed, medial);
    for (_, body) in world.bodies.iter_mut() {
        body.enable_gyroscopic_forces(false);
    }
    let mut pipeline = pipeline(&mut world, budget);
    let (mut most, mut waits) = (0, 0);
    let mut findings = Findings::default();
    for _ in 0..steps {
        let report = pipeline.step(&mut world);
        most = most.max(report.spent);
        waits += usize::from(report.waiting > 0);
        findings.look(&world, &bodies);
    }
    let poses = world.bodies.iter().map(|(_, b)| *b.position()).collect();
    (Run { most, waits, poses }, findings)
}

#[test]
fn with_a_tenth_of_what_they_need_heaps_lose_time_and_stay_unlinked() {
    for seed in [601, 602, 603] {
        let (needed, _) = thrown(seed, 60, u64::MAX);
        assert_eq!(needed.waits, 0);
        for share in [10, 100] {
            let steps = if share == 10 { 60 } else { 30 };
            let budget = needed.most / share;
            let (run, found) = thrown(seed, steps, budget);
            println!(
                "seed {seed}, a budget of {budget} for {}: {} steps wait, {found:?}",
                needed.most, run.waits
            );
            assert!(run.waits > 0, "nothing waited");
            assert_eq!(found.wrong_links, 0, "seed {seed}, budget {budget}");
            assert!(found.energy < 1.001, "seed {seed}: {found:?}");
            assert!(found.depth < 0.6, "seed {seed}: {found:?}");
            // A query with one of rapier's shapes is not broken off.
            assert!(run.most < 2 * budget + 2000, "{} of {budget}", run.most);
        }
    }
}

#[test]
fn the_default_budget_changes_nothing() {
    let options = MedialOptions::default();
    let (free, _) = thrown(604, 40, u64::MAX);
    let (default, _) = thrown(604, 40, options.budget);
    assert_eq!(default, free);
    assert!(10 * free.most < options.budget, "{}", free.most);
}

/// Symptom: bodies hung in the air before their first contact. Cause: `MedialPipeline::default()` had a budget of 0.
/// What must be so: it steps as with the default options.
#[test]
fn a_default_pipeline_has_the_default_budget() {
    let fallen = |mut pipeline: MedialPipeline| {
        let mut world = PhysicsWorld::new();
        let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::NEG_Y * 0.5);
        world.insert_collider(ground, None);
        let body = RigidBodyBuilder::dynamic().translation(Vector::Y);
        let mesh = MedialMesh::torus(0.3, 0.1, 12).expect("a ring");
        let (body, _) = world.insert(body, ColliderBuilder::medial_mesh(mesh));
        let waiting: u32 = (0..60)
            .map(|_| pipeline.step(&mut world).waiting as u32)
            .sum();
        (world.bodies[body].translation().y, waiting)
    };
    let (height, waiting) = fallen(MedialPipeline::default());
    assert!(
        (height - 0.1).abs() < 0.01 && waiting == 0,
        "{height} {waiting}"
    );
    assert_eq!(
        fallen(MedialPipeline::new(MedialOptions::default())).0,
        height
    );
}

/// Nothing stops a kinematic bar: what it pushes is searched and carried along, without any budget. Beside it rings lie
/// against each other.
#[test]
fn kinematic_body_carries_what_it_pushes_when_the_budget_is_spent() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let at = |x: Real, z: Real| Pose::new(Vector::new(x, 0.0, z), Vector::X * 1.5);
    let spheres = [-3.0, 3.0].map(|z| MedialSphere::new(Vector::Z * z, 0.05));
    let bar = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a bar");
    let driven = RigidBodyBuilder::kinematic_velocity_based()
        .translation(Vector::X * -1.0)
        .linvel(Vector::X * 20.0);
    let bar = world.insert(driven, ColliderBuilder::medial_mesh(bar)).0;
    let balls: Vec<RigidBodyHandle> = (0..5)
        .map(|k| {
            let body = RigidBodyBuilder::dynamic().pose(at(0.3 * k as Real, k as Real - 2.0));
            let ball = MedialMesh::ball(0.1).expect("a ball");
            let collider = ColliderBuilder::medial_mesh(ball).density(500.0);
            world.insert(body, collider).0
        })
        .collect();
    let mut pipeline = pipeline(&mut world, 0);
    for step in 0..30 {
        pipeline.step(&mut world);
        let front = world.bodies[bar].translation().x;
        for ball in &balls {
            let x = world.bodies[*ball].translation().x;
            assert!(
                x > front,
                "step {step}: a ball at {x} m, the bar at {front} m"
            );
        }
    }
}

/// Bodies that joints tie together wait together: the joint stays as closed as it is without a budget.
#[test]
fn chains_wait_as_a_whole() {
    let opened = [u64::MAX, 0].map(|budget| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.insert_collider(ring_collider(As::Medial), None);
        let bar = |k: usize| {
            let spheres = [-0.2, 0.2].map(|x| MedialSphere::new(Vector::X * x, 0.03));
            let mesh = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a bar");
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::new(0.5 * k as Real, 0.9, 0.0))
                .linvel(Vector::NEG_Y * 40.0);
            (body, ColliderBuilder::medial_mesh(mesh).density(1000.0))
        };
        let bars: Vec<RigidBodyHandle> = (0..4)
            .map(|k| {
                let (body, collider) = bar(k);
                world.insert(body, collider).0
            })
            .collect();
        for two in bars.windows(2) {
            let joint = SphericalJointBuilder::new()
                .local_anchor1(Vector::X * 0.25)
                .local_anchor2(Vector::X * -0.25)
                .contacts_enabled(false);
            world.insert_impulse_joint(two[0], two[1], joint);
        }
        let mut pipeline = pipeline(&mut world, budget);
        let mut widest: Real = 0.0;
        let mut waited = 0;
        for _ in 0..40 {
            waited += pipeline.step(&mut world).waiting;
            for two in bars.windows(2) {
                let [a, b] = [0, 1].map(|k| *world.bodies[two[k]].position());
                let [p, q] = [a * (Vector::X * 0.25), b * (Vector::X * -0.25)];
                widest = widest.max(p.distance(q));
            }
        }
        assert_eq!(waited > 0, budget == 0, "{waited} waited");
        widest
    });
    println!("joints open by {opened:?} m");
    assert!(opened[1] < opened[0] + 2.0e-3, "{opened:?}");
}

/// Time is lost, but the world goes on: with a tenth of what they need, rings thrown together fall and lie on the
/// ground.
#[test]
fn a_heap_that_waits_comes_down() {
    let (needed, _) = thrown(605, 60, u64::MAX);
    let (run, found) = thrown(605, 600, needed.most / 10);
    let heights = run.poses.iter().map(|pose| pose.translation.y);
    let highest = heights.fold(0.0, Real::max);
    println!(
        "{} of 600 steps wait, the highest at {highest} m, {found:?}",
        run.waits
    );
    assert_eq!(found.wrong_links, 0);
    assert!(run.waits < 300, "{} of 600 steps wait", run.waits);
    assert!(highest < 3.0, "one hangs at {highest} m");
}

/// Most of any budget that a step takes of a card that lands on a tilted cone or cylinder, with which it slides to the
/// ground.
fn card_on(shape: SharedShape, tilt: Real) -> u64 {
    let mut world = world_with_ground();
    let leaning = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * 0.6)
        .rotation(Vector::new(tilt, 0.0, 0.5 * tilt))
        .angvel(Vector::new(1.0, 2.0, 0.5));
    world.insert(leaning, ColliderBuilder::new(shape).density(1000.0));
    let corners = [(-0.4, -0.3), (0.4, -0.3), (0.4, 0.3), (-0.4, 0.3)];
    let spheres = corners.map(|(x, z)| MedialSphere::new(Vector::new(x, 0.0, z), 0.002));
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let card = MedialMesh::new(spheres.to_vec(), vec![], faces).expect("a card");
    let falling = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.1, 1.3, 0.05))
        .rotation(Vector::new(0.1, 0.0, 0.2))
        .linvel(Vector::NEG_Y * 2.0)
        .angvel(Vector::new(1.0, 2.0, -1.0));
    world.insert(falling, ColliderBuilder::medial_mesh(card).density(1000.0));
    let mut pipeline = pipeline(&mut world, u64::MAX);
    let spent = (0..120).map(|_| pipeline.step(&mut world).spent);
    spent.fold(0, u64::max)
}

/// Symptom: single steps of seconds. Cause: where a card's edge moves along a rim or a flank, no direction that turns
/// with either body keeps them apart for long.
#[test]
fn cards_on_cones_and_cylinders_take_few_looks() {
    for (name, shape) in [
        ("cone", SharedShape::cone(0.5, 0.4)),
        ("cylinder", SharedShape::cylinder(0.5, 0.4)),
    ] {
        let spent = [0.0, 0.3, 0.7].map(|tilt| card_on(shape.clone(), tilt));
        println!("{name}: {spent:?}");
        assert!(
            spent.iter().all(|spent| (500..12_000).contains(spent)),
            "{name}: {spent:?}"
        );
    }
}

/// Symptom: steps of many seconds. Cause: bodies of 3 cm are within rapier's prediction distance of 2 cm with all their
/// primitives, and the list of a pair's contacts had no bound.
#[test]
fn bodies_of_three_centimetres_have_a_bounded_number_of_contacts() {
    let scale = Vector::splat(0.02);
    let knot = MedialMesh::tube(&knots::knot(), true).expect("a closed tube");
    let knot = knot.scaled(scale).expect("a small knot");
    let mut world = world_with_ground();
    let bodies: Vec<RigidBodyHandle> = (0..5)
        .map(|k| {
            let up = 0.02 + 0.015 * k as Real;
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::Y * up)
                .rotation(Vector::new(k as Real, 1.0, 0.5));
            let collider = ColliderBuilder::medial_mesh(knot.clone()).density(1000.0);
            world.insert(body, collider).0
        })
        .collect();
    let mut pipeline = pipeline(&mut world, u64::MAX);
    let mut most = [0; 2];
    for step in 0..400 {
        let report = pipeline.step(&mut world);
        assert!(
            report.contacts <= 2048 * report.jobs,
            "step {step}: {} contacts of {} pairs",
            report.contacts,
            report.jobs
        );
        most = [most[0].max(report.contacts), most[1].max(report.jobs)];
    }
    println!("{most:?}");
    assert!(most[0] > 1024, "nothing was near");
    for body in bodies {
        let body = &world.bodies[body];
        assert!(body.is_sleeping(), "{:?}", body.linvel());
        assert!(
            (0.0..0.05).contains(&body.translation().y),
            "{:?}",
            body.translation()
        );
    }
}

/// A plate of 28 by 28 spheres, with two slabs between each four.
fn dense_plate() -> MedialMesh {
    const SIDE: u32 = 28;
    let sphere = |k: u32| {
        let [x, z] = [k % SIDE, k / SIDE].map(|i| i as Real / (SIDE - 1) as Real - 0.5);
        MedialSphere::new(Vector::new(x, 0.0, z), 0.03)
    };
    let corners = (0..SIDE * SIDE).filter(|k| k % SIDE < SIDE - 1 && k / SIDE < SIDE - 1);
    let slabs = corners.flat_map(|k| [[k, k + 1, k + SIDE], [k + 1, k + SIDE + 1, k + SIDE]]);
    let spheres = (0..SIDE * SIDE).map(sphere).collect();
    MedialMesh::new(spheres, vec![], slabs.collect()).expect("a plate")
}

/// Which contacts of very many are left out must not be those of one side: plates of 1,458 slabs on each other have
/// some 5,900 that touch.
#[test]
fn dense_plates_lie_still_on_each_other() {
    let plate = dense_plate();
    for seed in 0..4 {
        let mut random = Random(seed);
        let mut world = PhysicsWorld::new();
        world.insert_collider(ColliderBuilder::medial_mesh(plate.clone()), None);
        let [x, z] = [0, 1].map(|_| random.within(-0.02, 0.02));
        let turn = Vector::Y * random.within(-0.3, 0.3);
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(Vector::new(x, 0.061, z), turn));
        let collider = ColliderBuilder::medial_mesh(plate.clone()).density(1000.0);
        let (body, _) = world.insert(body, collider);
        let mut pipeline = pipeline(&mut world, u64::MAX);
        let mut most = 0;
        let asleep = (0..60).find(|_| {
            most = most.max(pipeline.step(&mut world).contacts);
            world.bodies[body].is_sleeping()
        });
        let height = world.bodies[body].translation().y;
        println!("seed {seed}: asleep after {asleep:?} steps at {height} m, {most} contacts");
        assert!(most > 2048, "seed {seed}: {most} contacts");
        assert!(
            asleep.is_some() && height > 0.0595,
            "seed {seed}: {height} m"
        );
    }
}
