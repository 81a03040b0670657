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
    let (sin, cos) = 2.0_f32.to_radians().sin_cos();
    let velocity = 10.0 * Vector::new(cos, -sin, 0.0);
    let cube = (Vector::splat(0.3), -5.0, 0.02);
    as_rapiers("voxels", voxels(0.25), cube, velocity, (0.3, [0.1, 0.1]));
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

/// A height field with rapier's flag for internal edges, of so many cells 1 m wide along each side.
fn field(cells: usize, height: impl Fn(Real, Real) -> Real) -> ColliderBuilder {
    let mut heights = Array2::zeros(cells + 1, cells + 1);
    let at = |k: usize| k as Real - 0.5 * cells as Real;
    for i in 0..=cells {
        for j in 0..=cells {
            heights[(i, j)] = height(at(j), at(i));
        }
    }
    let size = Vector::new(cells as Real, 1.0, cells as Real);
    let flags = HeightFieldFlags::FIX_INTERNAL_EDGES;
    let shape = SharedShape::heightfield_with_flags(heights, size, flags);
    ColliderBuilder::new(shape).friction(0.0)
}

/// A flat floor of voxels.
fn voxels(size: Real) -> ColliderBuilder {
    let most = (24.0 / size) as i32;
    let side = |x: i32| (-most..most).map(move |z| IVector::new(x, -1, z));
    let cells: Vec<_> = (-most..most).flat_map(side).collect();
    ColliderBuilder::voxels(Vector::splat(size), &cells).friction(0.0)
}

/// Neighbours in a height field have corners that are off by rounding where the width of a cell is no power of two.
#[test]
fn boxes_slide_over_hills_of_any_height_field() {
    let hill = |x: Real, z: Real| 0.12 * (0.84 * x).sin() * (0.84 * z).cos();
    let bodies = both(&[(Vector::ZERO, Vector::splat(0.25))]);
    for cells in [32, 40, 50] {
        let ground = field(cells, hill);
        for k in 0..6 {
            let [x, z] = [0.13 * k as Real - 3.0, 0.11 * k as Real - 0.6];
            let at = Vector::new(x, hill(x, z) + 0.3, z);
            let start = (Pose::new(at, Vector::Y * 0.4 * k as Real), Vector::X * 4.0);
            let [ours, own] = bodies.each_ref().map(|b| speed(&ground, b, start, 1.5));
            assert!((ours - own).abs() < 0.4, "{cells} cells: {ours}, {own}");
        }
    }
}

/// Rows of triangles with other divisions than their neighbours', as where levels are made of parts.
#[test]
fn boxes_slide_up_a_ramp_of_unlike_rows() {
    let slope = 5.0_f32.to_radians().tan();
    let height = |x: Real| slope * (x - 3.0).max(0.0);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..72 {
        let edges = [0, 1].map(|k| 0.5 * (row + k) as Real - 18.0);
        let parts = [72, 54][row % 2];
        let first = vertices.len() as u32;
        for k in 0..=parts {
            let z = 36.0 * k as Real / parts as Real - 18.0;
            vertices.extend(edges.map(|x| Vector::new(x, height(x), z)));
        }
        for k in 0..parts as u32 {
            let a = first + 2 * k;
            triangles.extend([[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
        }
    }
    let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
    let ground = ColliderBuilder::trimesh_with_flags(vertices, triangles, flags);
    let ground = ground.expect("a ground").friction(0.0);
    let brick = (Vector::new(0.4, 0.2, 0.3), 1.6, 0.0005);
    as_rapiers("rows", ground, brick, Vector::X * 8.0, (0.4, [0.2, 0.3]));
}

/// Where a primitive just touches the floor the direction that parry finds is noise.
#[test]
fn cubes_slide_over_voxels_as_large_as_they_are() {
    let cube = (Vector::splat(0.25), -5.0, 0.0005);
    for size in [0.5, 1.0, 2.0] {
        let (name, velocity) = (format!("voxels of {size} m"), Vector::X * 4.0);
        as_rapiers(&name, voxels(size), cube, velocity, (2.0, [0.1, 0.1]));
    }
}

/// A contact that turns with the ball is behind its middle, and its normal pushes the ball on.
#[test]
fn balls_that_roll_slowly_roll_as_rapiers_on_every_ground() {
    let ours = ColliderBuilder::medial_mesh(MedialMesh::ball(0.6).expect("a ball"));
    let own = ColliderBuilder::ball(0.6);
    let rolled = |ball: &ColliderBuilder, ground: &ColliderBuilder| {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ground.clone().friction(0.5), None);
        let pushed = RigidBodyBuilder::dynamic()
            .translation(Vector::new(-1.03, 0.6, 0.21))
            .linvel(Vector::X * 0.1);
        let (body, _) = world.insert(pushed, ball.clone().friction(0.5));
        let mut pipeline = MedialPipeline::default();
        for _ in 0..600 {
            pipeline.step(&mut world);
        }
        world.bodies[body].linvel().x
    };
    let flagged = ground_of(1.0, TriMeshFlags::FIX_INTERNAL_EDGES);
    let [plain, flat] = [ground_of(1.0, TriMeshFlags::empty()), field(32, |_, _| 0.0)];
    // In debug builds rapier 0.36.1 panics with its own ball on voxels.
    let grounds = [
        [&flagged; 2],
        [&plain; 2],
        [&flat; 2],
        [&voxels(1.0), &flat],
    ];
    for (k, [ground, of_own]) in grounds.into_iter().enumerate() {
        let [ours, own] = [rolled(&ours, ground), rolled(&own, of_own)];
        assert!((ours - own).abs() < 0.002, "{k}: {ours}, {own}");
    }
}

/// In the step of a landing one side of a plate sinks in before the other is down, and edges of triangles beside it are
/// then in its way.
#[test]
fn rounded_plates_and_rods_land_flat_on_triangles() {
    let corner = |x: Real, z: Real| MedialSphere::new(Vector::new(x, 0.0, z), 0.1);
    let [a, b] = [-0.37, 0.37];
    let corners = vec![corner(a, a), corner(b, a), corner(b, b), corner(a, b)];
    let plate = MedialMesh::new(corners, vec![], vec![[0, 1, 2], [0, 2, 3]]).expect("a plate");
    let rod = MedialMesh::capsule(Vector::X * a, Vector::X * b, 0.1).expect("a rod");
    for (name, mesh) in [("plate", plate), ("rod", rod)] {
        let body = ColliderBuilder::medial_mesh(mesh);
        for cell in [0.3, 1.0] {
            let ground = rough_ground(cell, |_, _| 0.0);
            let half = Vector::new(0.0, 0.1, 0.0);
            let velocity = Vector::new(5.0, -15.0, 0.0);
            let all = starts(half, -2.0, 0.1).map(|s| speed(&ground, &body, (s, velocity), 0.2));
            let all: Vec<Real> = all.collect();
            let off = all.iter().map(|v| (v - 5.0).abs()).fold(0.0, Real::max);
            assert!(off < 0.02, "{name}, cells of {cell} m: {all:?}");
        }
    }
}
