//! rapier's own tools on medial ground: world queries, the character controller, wheels, multibody links,
//! soft bodies; and how far from the origin a scene may be.

use crate::bodies::*;
use rapier3d::control::{
    DynamicRayCastVehicleController, KinematicCharacterController, WheelTuning,
};
use rapier3d::parry::query::{NonlinearRigidMotion, ShapeCastOptions};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of the ground's spheres: its flat part ends at this height.
const RADIUS: Real = 0.25;

/// Rise of the ground per metre beyond x = 0.
const SLOPE: Real = 0.2;

/// A plate of slabs, flat for x < 0 and rising beyond.
fn plate() -> MedialMesh {
    let height = |x: Real| SLOPE * x.max(0.0);
    let spheres = (0..25)
        .map(|i| {
            let (x, z) = (2.0 * (i % 5) as Real - 4.0, 2.0 * (i / 5) as Real - 4.0);
            MedialSphere::new(Vector::new(x, height(x), z), RADIUS)
        })
        .collect();
    let cells = (0..16u32).map(|c| c % 4 + 5 * (c / 4));
    let faces = cells
        .flat_map(|c| [[c, c + 1, c + 6], [c, c + 6, c + 5]])
        .collect();
    MedialMesh::new(spheres, vec![], faces).expect("a plate")
}

/// Distance of a point to the plate's surface above the given x, by its two planes.
fn above_plate(p: Vector) -> Real {
    if p.x < 0.0 {
        return p.y - RADIUS;
    }
    let flat = (1.0 + SLOPE * SLOPE).sqrt();
    (p.y - SLOPE * p.x) / flat - RADIUS
}

fn world_on_plate() -> (PhysicsWorld, MedialPipeline, ColliderHandle) {
    let mut world = PhysicsWorld::new();
    let pipeline = attached(&mut world);
    let ground = world.insert_collider(ColliderBuilder::medial_mesh(plate()), None);
    world.detect_collisions(&(), &());
    (world, pipeline, ground)
}

#[test]
fn world_queries_meet_the_plate_where_it_is() {
    let (world, _, ground) = world_on_plate();
    let filter = QueryFilter::default();
    let close = |a: Real, b: Real| assert!((a - b).abs() < 1.0e-4, "{a}, not {b}");
    let high = Vector::new(-1.3, 5.0, 0.4);
    let ray = Ray::new(high, -Vector::Y);
    let (hit, t) = world.cast_ray(&ray, 9.0, true, filter).expect("a hit");
    assert_eq!(hit, ground);
    close(t, 5.0 - RADIUS);
    let (_, normal) = world
        .cast_ray_and_get_normal(&ray, 9.0, true, filter)
        .expect("a hit");
    close(normal.normal.y, 1.0);
    let (_, p) = world
        .project_point(Vector::new(-1.3, 1.0, 0.4), 9.0, true, filter)
        .expect("a projection");
    close(p.point.y, RADIUS);
    let ball = Ball::new(0.5);
    let at = Pose::from_translation(high);
    let options = ShapeCastOptions::with_max_time_of_impact(9.0);
    let (_, hit) = world
        .cast_shape(&at, -Vector::Y, &ball, options, filter)
        .expect("a hit");
    close(hit.time_of_impact, 4.5 - RADIUS);
    close(hit.normal1.y.abs(), 1.0);
    let motion =
        NonlinearRigidMotion::new(at, Vector::ZERO, -Vector::Y, Vector::new(0.0, 1.0, 0.0));
    let (_, hit) = world
        .cast_shape_nonlinear(&motion, &ball, 0.0, 9.0, true, filter)
        .expect("a hit");
    close(hit.time_of_impact, 4.5 - RADIUS);
    let touched = |y: Real| {
        let at = Pose::from_translation(Vector::new(-1.3, y, 0.4));
        world.intersect_shape(at, &ball, filter).count()
    };
    assert_eq!([touched(0.74), touched(0.76)], [1, 0]);
}

#[test]
fn a_character_walks_up_the_slope() {
    let (mut world, mut pipeline, _) = world_on_plate();
    let controller = KinematicCharacterController::default();
    let shape = Capsule::new_y(0.4, 0.3);
    let mut at = Pose::from_translation(Vector::new(-3.0, 1.2, 0.3));
    let foot = |at: &Pose| above_plate(at.translation - Vector::Y * 0.4) - 0.3;
    let mut grounded = 0;
    for step in 0..360 {
        let queries = world.query_pipeline();
        let wish = Vector::new(0.015, -0.03, 0.0);
        let moved = controller.move_shape(1.0 / 60.0, &queries, &shape, &at, wish, |_| ());
        at.translation += moved.translation;
        grounded += u32::from(moved.grounded);
        assert!(
            foot(&at) > -1.0e-3,
            "step {step}: {} deep at {at:?}",
            -foot(&at)
        );
        assert!(
            step < 60 || foot(&at) < 0.05,
            "step {step}: {} above",
            foot(&at)
        );
        pipeline.step(&mut world);
    }
    assert!(at.translation.x > 1.0, "it stays at {}", at.translation);
    assert!(grounded > 280, "grounded in {grounded} of 360 steps");
}

#[test]
fn wheels_roll_on_medial_ground() {
    let (mut world, mut pipeline, _) = world_on_plate();
    let chassis = RigidBodyBuilder::dynamic().translation(Vector::new(-3.0, 0.8, 0.0));
    let collider = ColliderBuilder::cuboid(0.6, 0.15, 0.3).density(100.0);
    let (chassis, _) = world.insert(chassis, collider);
    let tuning = WheelTuning {
        suspension_stiffness: 100.0,
        suspension_damping: 10.0,
        ..WheelTuning::default()
    };
    let mut vehicle = DynamicRayCastVehicleController::new(chassis);
    for (x, z) in [(0.45, 0.3), (0.45, -0.3), (-0.45, 0.3), (-0.45, -0.3)] {
        let at = Vector::new(x, -0.15, z);
        vehicle.add_wheel(at, -Vector::Y, Vector::Z, 0.15, 0.1, &tuning);
    }
    for step in 0..240 {
        let force = if step < 60 { 0.0 } else { 10.0 };
        for wheel in vehicle.wheels_mut() {
            wheel.engine_force = force;
        }
        let queries = world.broad_phase.as_query_pipeline_mut(
            world.narrow_phase.query_dispatcher(),
            &mut world.bodies,
            &mut world.colliders,
            QueryFilter::exclude_dynamic().exclude_rigid_body(chassis),
        );
        vehicle.update_vehicle(1.0 / 60.0, queries);
        pipeline.step(&mut world);
        let height = above_plate(world.bodies[chassis].translation());
        assert!(height > 0.1, "step {step}: {height} above the ground");
        if step == 59 {
            let touching = vehicle
                .wheels()
                .iter()
                .filter(|w| w.raycast_info().is_in_contact);
            assert_eq!(touching.count(), 4);
        }
    }
    let moved = (world.bodies[chassis].translation().x + 3.0).abs();
    assert!(moved > 0.5, "it moves {moved}");
}

#[test]
fn medial_links_of_a_multibody_rest_on_the_ground() {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    let link = |world: &mut PhysicsWorld, x: Real| {
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, 1.0, 0.0));
        let mesh = ring(12, 0.3, 0.08);
        world
            .insert(body, ColliderBuilder::medial_mesh(mesh).density(500.0))
            .0
    };
    let links: Vec<_> = (0..4).map(|i| link(&mut world, i as Real)).collect();
    for pair in links.windows(2) {
        let joint = SphericalJointBuilder::new()
            .local_anchor1(Vector::new(0.5, 0.0, 0.0))
            .local_anchor2(Vector::new(-0.5, 0.0, 0.0));
        let inserted = world.insert_multibody_joint(pair[0], pair[1], joint);
        assert!(inserted.is_some());
    }
    for _ in 0..240 {
        pipeline.step(&mut world);
    }
    for h in &links {
        let body = &world.bodies[*h];
        let y = body.translation().y;
        assert!((0.05..0.12).contains(&y), "a link at height {y}");
        assert!(body.linvel().length() < 0.05, "{}", body.linvel());
    }
    for pair in links.windows(2) {
        let ends = [(pair[0], 0.5), (pair[1], -0.5)];
        let [a, b] = ends.map(|(h, x)| world.bodies[h].position() * Vector::new(x, 0.0, 0.0));
        assert!(
            (a - b).length() < 1.0e-3,
            "a joint opens by {}",
            (a - b).length()
        );
    }
}

#[test]
fn soft_bodies_lie_on_medial_ground_and_carry_medial_bodies() {
    let lowest = |ground: bool| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        if ground {
            world.insert_collider(ColliderBuilder::medial_mesh(plate()), None);
        }
        let at = Vector::new(-2.0, 0.9, 0.0);
        let soft = SoftBodyBuilder::cuboid(at, Vector::splat(0.4), 4, 4, 4);
        let soft = world.insert_soft_body(soft);
        for _ in 0..120 {
            pipeline.step(&mut world);
        }
        let particles = world.soft_bodies[soft].particles();
        particles
            .iter()
            .map(|p| p.position().y)
            .fold(Real::MAX, Real::min)
    };
    let (with, without) = (lowest(true), lowest(false));
    assert!((0.15..0.4).contains(&with), "it lies at {with}");
    assert!(without < -5.0, "{without}");

    // On a soft body a medial ring lies as high as a ball of its tube's radius.
    let height = |collider: ColliderBuilder| {
        let mut world = world_with_ground();
        let mut pipeline = attached(&mut world);
        let at = Vector::new(0.0, 0.5, 0.0);
        world.insert_soft_body(SoftBodyBuilder::cuboid(at, Vector::splat(0.5), 4, 4, 4));
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 1.3, 0.0));
        let body = world.insert(body, collider.density(50.0)).0;
        for _ in 0..240 {
            pipeline.step(&mut world);
        }
        world.bodies[body].translation().y
    };
    let ring = height(ColliderBuilder::medial_mesh(ring(12, 0.3, 0.08)));
    let ball = height(ColliderBuilder::ball(0.08));
    assert!(
        ball > 1.0 && (ring - ball).abs() < 0.01,
        "{ring}, the ball {ball}"
    );
}

/// A rigid collider hung on a soft body's cluster proxy holds it up: as a medial ring, as rapier's compound
/// of the same capsules.
#[test]
fn medial_colliders_hang_on_cluster_proxies() {
    let mesh = ring(12, 0.3, 0.08);
    let capsules = mesh.edges().iter().map(|e| {
        let [a, b] = e.map(|i| mesh.spheres()[i as usize].center);
        (Pose::IDENTITY, SharedShape::capsule(a, b, 0.08))
    });
    let capsules = SharedShape::compound(capsules.collect());
    // Height of the soft body's middle, and of the proxy's collider.
    let height = |foot: Option<ColliderBuilder>| {
        let mut world = world_with_ground();
        let mut pipeline = attached(&mut world);
        let at = Vector::new(0.0, 1.2, 0.0);
        let soft = SoftBodyBuilder::cuboid(at, Vector::splat(0.4), 4, 4, 4);
        let soft = world.insert_soft_body(soft);
        let proxy = world.soft_bodies[soft].root_body();
        let foot = foot.map(|f| {
            let below = Vector::new(0.0, -0.7, 0.0);
            world.insert_collider(f.translation(below).density(0.0), Some(proxy))
        });
        for _ in 0..180 {
            pipeline.step(&mut world);
        }
        let particles = world.soft_bodies[soft].particles();
        let sum: Real = particles.iter().map(|p| p.position().y).sum();
        let foot = foot.map(|f| world.colliders[f].translation().y);
        (sum / particles.len() as Real, foot.unwrap_or(0.0))
    };
    let (bare, _) = height(None);
    let (medial, medial_foot) = height(Some(ColliderBuilder::medial_mesh(mesh.clone())));
    let (compound, compound_foot) = height(Some(ColliderBuilder::new(capsules)));
    println!("{bare} {medial} {medial_foot} {compound} {compound_foot}");
    assert!(medial > bare + 0.2, "{medial}, without {bare}");
    assert!((medial - compound).abs() < 0.01, "{medial}, not {compound}");
    assert!((medial_foot - compound_foot).abs() < 0.01);
    assert!((0.07..0.09).contains(&medial_foot), "{medial_foot}");
}

/// Where a ring is, seen from `offset`, after it has slid down the slope there for a second.
fn slides(offset: Real) -> Vector {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let at = Vector::new(offset, 0.0, offset);
    let ground = ColliderBuilder::medial_mesh(plate()).translation(at);
    world.insert_collider(ground.friction(0.05), None);
    let up = Vector::new(-SLOPE, 1.0, 0.0).normalize();
    let start = Vector::new(3.0, SLOPE * 3.0, 0.0) + up * (RADIUS + MINOR);
    let tilt = Vector::new(0.0, 0.0, SLOPE.atan());
    let ring = add_ring(&mut world, As::Medial, Pose::new(at + start, tilt));
    for _ in 0..60 {
        pipeline.step(&mut world);
    }
    world.bodies[ring].translation() - at
}

/// The table of docs/measurements/with-rapier.md: a moving body loses what `f32` cannot resolve of its steps.
#[test]
fn sliding_bodies_err_by_what_f32_resolves() {
    let near = slides(0.0);
    assert!(near.x < 2.95, "it slides: {near}");
    for offset in [100.0, 1000.0, 10_000.0, 100_000.0] {
        let error = (slides(offset) - near).length();
        println!("{offset} m: {error} m of {}", 3.0 - near.x);
        // A step is rounded by half an ulp of the coordinates, in either direction: at the worst all alike.
        let ulps = offset * Real::EPSILON;
        assert!(error < 60.0 * ulps + 1.0e-3, "{error} m at {offset} m");
    }
}

/// Largest speed over the last second of a ring that was laid on medial ground, and its height then.
fn at_rest(offset: Real) -> (Real, Real) {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let at = Vector::new(offset, 0.0, offset);
    let ground = ColliderBuilder::medial_mesh(plate()).translation(at);
    world.insert_collider(ground, None);
    let start = at + Vector::new(-2.0, RADIUS + MINOR + 0.05, 0.3);
    let ring = add_ring(&mut world, As::Medial, Pose::from_translation(start));
    let mut fastest: Real = 0.0;
    for step in 0..240 {
        pipeline.step(&mut world);
        if step >= 180 {
            fastest = fastest.max(world.bodies[ring].linvel().length());
        }
    }
    (fastest, world.bodies[ring].translation().y - RADIUS - MINOR)
}

/// The table of docs/measurements/with-rapier.md.
#[test]
fn scenes_rest_as_far_out_as_f32_lets_them() {
    for offset in [0.0, 100.0, 1000.0, 10_000.0, 100_000.0] {
        let (speed, height) = at_rest(offset);
        println!("{offset} m: {speed} m/s, {height} m");
        if offset <= 1000.0 {
            assert!(speed < 1.0e-3, "{speed} m/s at {offset} m");
            assert!(height.abs() < 2.0e-3, "{height} m at {offset} m");
        }
    }
}
