//! Bodies that slide over the folds of grounds of triangles, and land on them at a small angle, as rapier's own do; and
//! single spheres and cones on small triangles.

use crate::random::Random;
use crate::triangles::{Part, both, flagged_ground, ground_of};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A ground of heights over a square of 36 m, in cells, with rapier's flag for internal edges.
fn rough_ground(cell: Real, height: impl Fn(Real, Real) -> Real) -> ColliderBuilder {
    let cells = (36.0 / cell) as u32;
    let at = |k: u32| cell * k as Real - 18.0;
    let line = |k| (0..=cells).map(move |j| [at(k), at(j)]);
    let places = (0..=cells).flat_map(line);
    let vertices = places
        .map(|[x, z]| Vector::new(x, height(x, z), z))
        .collect();
    let pair = |i: u32, j: u32| {
        let [a, b] = [i * (cells + 1) + j, (i + 1) * (cells + 1) + j];
        [[a, a + 1, b + 1], [a, b + 1, b]]
    };
    let row = |i| (0..cells).flat_map(move |j| pair(i, j));
    let triangles = (0..cells).flat_map(row).collect();
    let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
    let ground = ColliderBuilder::trimesh_with_flags(vertices, triangles, flags);
    ground.expect("a ground").friction(0.0)
}

/// The speed along x of a box on a ground without friction after so many seconds.
fn speed(
    ground: &ColliderBuilder,
    body: &ColliderBuilder,
    (start, velocity): (Pose, Vector),
    seconds: Real,
) -> Real {
    let is_medial = body.shape.as_shape::<MedialMesh>().is_some();
    let mut world = PhysicsWorld::new();
    // rapier's own tunnel through folds in long steps.
    let parts = if is_medial { 1 } else { 8 };
    world.integration_parameters.dt /= parts as Real;
    world.insert_collider(ground.clone(), None);
    let thrown = RigidBodyBuilder::dynamic().pose(start).linvel(velocity);
    let collider = body.clone().friction(0.0).density(1000.0);
    let (body, _) = world.insert(thrown, collider);
    let mut pipeline = MedialPipeline::default();
    for _ in 0..(seconds * 60.0) as usize * parts {
        match is_medial {
            true => drop(pipeline.step(&mut world)),
            false => world.step(),
        }
    }
    world.bodies[body].linvel().x
}

/// Boxes, on the ground at x, with a yaw and this far into a cell.
fn starts(half: Vector, x: Real, gap: Real) -> impl Iterator<Item = Pose> {
    (0..6).map(move |k| {
        let at = Vector::new(x + 0.07 * k as Real, half.y + gap, 0.11 * k as Real);
        Pose::new(at, Vector::Y * 0.4 * k as Real)
    })
}

/// Compares the median speed of a box with that of rapier's, and the least and the greatest with it as well.
fn as_rapiers(
    name: &str,
    ground: ColliderBuilder,
    (half, x, gap): (Vector, Real, Real),
    velocity: Vector,
    (seconds, most): (Real, [Real; 2]),
) {
    let parts: [Part; 1] = [(Vector::ZERO, half)];
    let [mut ours, mut own] = both(&parts).map(|body| {
        let all = starts(half, x, gap);
        let all = all.map(|start| speed(&ground, &body, (start, velocity), seconds));
        all.collect::<Vec<_>>()
    });
    println!("{name}: {ours:.2?} m/s, rapier's {own:.2?}");
    ours.sort_by(Real::total_cmp);
    own.sort_by(Real::total_cmp);
    let off = |k: usize| (ours[k] - own[3]).abs();
    assert!(off(3) < most[0], "{name}: {ours:?}, rapier's {own:?}");
    assert!(
        off(0).max(off(5)) < most[1],
        "{name}: {ours:?}, rapier's {own:?}"
    );
}

/// A first impact left the cube just above the height up to which it counted as lying, and the next edge threw it up.
#[test]
fn cubes_that_land_at_a_small_angle_slide_on() {
    let cube = (Vector::splat(0.3), -5.0, 0.02);
    let flat = || rough_ground(0.3, |_, _| 0.0);
    for degrees in [0.5, 2.0, 5.0] {
        let (sin, cos) = (degrees as f32).to_radians().sin_cos();
        let velocity = 30.0 * Vector::new(cos, -sin, 0.0);
        let name = format!("{degrees}°");
        as_rapiers(&name, flat(), cube, velocity, (0.3, [0.1, 0.1]));
    }
}

#[test]
fn cubes_land_on_voxels_likewise() {
    let side = |x: i32| (-40..40).map(move |z| IVector::new(x, -1, z));
    let cells: Vec<_> = (-40..40).flat_map(side).collect();
    let ground = ColliderBuilder::voxels(Vector::splat(0.25), &cells).friction(0.0);
    let (sin, cos) = 2.0_f32.to_radians().sin_cos();
    let velocity = 10.0 * Vector::new(cos, -sin, 0.0);
    let cube = (Vector::splat(0.3), -5.0, 0.02);
    as_rapiers("voxels", ground, cube, velocity, (0.3, [0.1, 0.1]));
}

/// The nearest point of what slides up from a fold is the fold itself, straight ahead.
#[test]
fn boxes_slide_up_ramps_and_through_valleys() {
    let ramp = |degrees: Real| {
        let slope = degrees.to_radians().tan();
        rough_ground(0.3, move |x, _| slope * (x - 3.0).max(0.0))
    };
    let brick = (Vector::new(0.4, 0.2, 0.3), 1.6, 0.0005);
    let velocity = Vector::X * 8.0;
    as_rapiers("ramp", ramp(5.0), brick, velocity, (0.4, [0.2, 0.3]));
    let valley = rough_ground(0.3, |x, _| 0.1 * (x - 3.0).abs());
    let above = (Vector::new(0.4, 0.2, 0.3), 1.6, 0.2);
    as_rapiers("valley", valley, above, velocity, (0.4, [0.3, 0.5]));
    let plate = (Vector::new(0.4, 0.01, 0.3), 2.0, 0.0005);
    as_rapiers(
        "plate",
        ramp(3.0),
        plate,
        Vector::X * 3.0,
        (0.4, [0.1, 0.2]),
    );
}

/// Boxes whose bottom faces span several of a ground's triangles, and are below the planes of some.
#[test]
fn boxes_slide_over_hills() {
    let hills = rough_ground(0.25, |x, z| 0.15 * (x.sin() * z.cos()));
    for half in [Vector::new(0.4, 0.2, 0.3), Vector::splat(0.3)] {
        let brick = (half, -2.5, 0.2);
        as_rapiers(
            "hills",
            hills.clone(),
            brick,
            Vector::X * 4.0,
            (1.5, [0.3, 0.5]),
        );
    }
}

/// Far from the ground's own origin, too, a fin that stands on it is no part of it.
#[test]
fn fins_far_from_the_origin_stop_bodies() {
    let fin = |off: Real| {
        let (y, z) = (0.012, 5.0);
        let corner = |x: Real, y: Real, z: Real| Vector::new(off + x, y, z);
        let floor = [[-9.0, -z], [-9.0, z], [9.0, z], [9.0, -z]];
        let mut vertices = floor.map(|[x, z]| corner(x, 0.0, z)).to_vec();
        vertices.extend([corner(0.0, 0.0, -z), corner(0.0, 0.0, z)]);
        vertices.extend([corner(0.0, y, z), corner(0.0, y, -z)]);
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        ColliderBuilder::trimesh(vertices, triangles)
            .expect("a ground")
            .friction(0.0)
    };
    let ball = ColliderBuilder::medial_mesh(MedialMesh::ball(0.2).expect("a ball"));
    let [near, far] = [0.0, 1000.0].map(|off| {
        let start = Pose::from_translation(Vector::new(off - 2.0, 0.2, 0.1));
        speed(&fin(off), &ball, (start, Vector::X * 20.0), 0.2)
    });
    println!("{near} m/s, and {far} a kilometre off");
    assert!(near < 18.5 && (near - far).abs() < 1.0, "{near} m/s, {far}");
}

/// parry finds contacts without a normal there, and deep ones where there are none: half of the balls fell through.
#[test]
fn small_balls_and_rods_lie_on_small_triangles() {
    let radius = 0.005;
    let rod = MedialMesh::capsule(Vector::X * -0.01, Vector::X * 0.01, radius);
    let bodies = [MedialMesh::ball(radius), rod].map(|mesh| mesh.expect("a body"));
    for flags in [TriMeshFlags::empty(), TriMeshFlags::FIX_INTERNAL_EDGES] {
        for mesh in &bodies {
            for seed in 0..40 {
                let mut random = Random(seed);
                let mut world = PhysicsWorld::new();
                world.insert_collider(ground_of(0.025, flags), None);
                let mut place = || random.within(-0.03, 0.03);
                let at = Vector::new(place(), radius + 0.0005, place());
                let body = RigidBodyBuilder::dynamic().translation(at);
                let collider = ColliderBuilder::medial_mesh(mesh.clone()).density(1000.0);
                let (body, _) = world.insert(body, collider);
                let mut pipeline = MedialPipeline::default();
                for _ in 0..90 {
                    pipeline.step(&mut world);
                }
                let height = world.bodies[body].translation().y;
                assert!(
                    height > 0.9 * radius,
                    "seed {seed}, {flags:?}: at {height} m"
                );
            }
        }
    }
}

/// What is flush with a flat ground of large triangles is not thrown up from its edges either.
#[test]
fn cubes_that_land_on_large_triangles_slide_on() {
    let ground = flagged_ground(TriMeshFlags::FIX_INTERNAL_EDGES).friction(0.0);
    let cube = (Vector::splat(0.3), -5.0, 0.02);
    let velocity = Vector::new(30.0, -1.0, 0.0);
    as_rapiers(
        "cells of a metre",
        ground,
        cube,
        velocity,
        (0.3, [0.1, 0.1]),
    );
}

/// Contacts press a body in by more than what counts as lying in a small length unit alone.
#[test]
fn small_cubes_slide_over_small_triangles() {
    let ground = ground_of(0.009, TriMeshFlags::FIX_INTERNAL_EDGES).friction(0.0);
    let cube = &both(&[(Vector::ZERO, Vector::splat(0.009))])[0];
    for unit in [1.0, 0.03, 0.01] {
        for k in 0..6 {
            let mut world = PhysicsWorld::new();
            world.integration_parameters.length_unit = unit;
            world.insert_collider(ground.clone(), None);
            let slides = RigidBodyBuilder::dynamic()
                .translation(Vector::new(-0.11, 0.009, 0.002 * k as Real))
                .rotation(Vector::Y * 0.4 * k as Real)
                .linvel(Vector::X * 0.3);
            let collider = cube.clone().friction(0.0).density(1000.0);
            let (body, _) = world.insert(slides, collider);
            let mut pipeline = MedialPipeline::default();
            for _ in 0..40 {
                pipeline.step(&mut world);
            }
            let speed = world.bodies[body].linvel().x;
            assert!(speed > 0.29, "unit {unit}, start {k}: {speed} m/s");
        }
    }
}

/// Of a normal that the flag does not allow parry turns the contact's points, too, or leaves the contact out.
#[test]
fn balls_roll_over_triangles_with_the_flag() {
    let ball = MedialMesh::ball(0.2).expect("a ball");
    let mut world = PhysicsWorld::new();
    let ground = ground_of(0.2, TriMeshFlags::FIX_INTERNAL_EDGES);
    world.insert_collider(ground.friction(0.5), None);
    let rolls = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-2.0, 0.2, 0.13))
        .linvel(Vector::new(1.6, 0.0, 0.2))
        .angvel(Vector::new(1.0, 0.0, -8.0));
    let collider = ColliderBuilder::medial_mesh(ball).density(1000.0);
    let (body, _) = world.insert(rolls, collider.friction(0.5));
    let mut pipeline = MedialPipeline::default();
    for _ in 0..120 {
        pipeline.step(&mut world);
    }
    let speed = world.bodies[body].linvel().x;
    assert!(speed > 1.59, "{speed} m/s");
}

/// A fence across a ground of two narrow triangles, whose plane is known the less the farther off its narrow side.
#[test]
fn fences_on_narrow_triangles_stop_bodies() {
    for (off, wide, long) in [(100.0, 0.1, 400.0), (1000.0, 0.3, 400.0)] {
        let at = |x: Real, y: Real, z: Real| Vector::new(off + x, y, off + z);
        let floor = [[-long, -wide], [-long, wide], [long, wide], [long, -wide]];
        let mut vertices = floor.map(|[x, z]| at(x, 0.0, 0.5 * z)).to_vec();
        vertices.extend([at(1.0, 0.0, -2.0), at(1.0, 0.0, 2.0)]);
        vertices.extend([at(1.0, 0.3, 2.0), at(1.0, 0.3, -2.0)]);
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let flags = TriMeshFlags::FIX_INTERNAL_EDGES_TWO_SIDED;
        let ground = ColliderBuilder::trimesh_with_flags(vertices, triangles, flags);
        for speed in [20.0, 60.0] {
            let ball = MedialMesh::ball(0.2).expect("a ball");
            let mut world = PhysicsWorld::new();
            world.insert_collider(ground.clone().expect("a ground"), None);
            let rolls = RigidBodyBuilder::dynamic()
                .translation(at(-0.7, 0.2, 0.0))
                .linvel(Vector::X * speed);
            let collider = ColliderBuilder::medial_mesh(ball).density(1000.0);
            let (body, _) = world.insert(rolls, collider.friction(0.3));
            let mut pipeline = MedialPipeline::default();
            for _ in 0..20 {
                pipeline.step(&mut world);
            }
            let x = world.bodies[body].translation().x - off;
            assert!(x < 1.0, "{off} m off, {speed} m/s: at {x} m");
        }
    }
}

/// A plate that falls flat on the top of a pyramid.
#[test]
fn tops_of_hills_throw_nothing_sideways() {
    let ring = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let mut vertices = ring.map(|[x, z]| Vector::new(x, 0.0, z)).to_vec();
    vertices.push(Vector::Y * 0.36);
    let triangles = (0..4).map(|k| [(k + 1) % 4, k, 4]).collect();
    let pyramid = ColliderBuilder::trimesh(vertices, triangles).expect("a pyramid");
    let plate = both(&[(Vector::ZERO, Vector::new(0.4, 0.1, 0.4))])[0].clone();
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    world.insert_collider(pyramid.friction(0.0), None);
    let falls = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * 0.6)
        .linvel(Vector::NEG_Y * 10.0);
    let (body, _) = world.insert(falls, plate.friction(0.0).density(1000.0));
    let mut pipeline = MedialPipeline::default();
    for _ in 0..10 {
        pipeline.step(&mut world);
    }
    let v = world.bodies[body].linvel();
    assert!(v.x.hypot(v.z) < 0.1, "{v:?}");
}
