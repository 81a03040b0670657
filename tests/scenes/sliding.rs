//! Bodies on the planes of triangles: what may pass over a triangle's edge, and what may not.

use crate::bodies::plateau;
use crate::feet::table;
use crate::triangles::{Part, Watched, both, flagged_ground, ground, slides_as_rapiers};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Cards sink by more than their thickness in a step of free fall.
#[test]
fn cards_slide_over_internal_edges_as_rapiers_do() {
    let ground = flagged_ground(TriMeshFlags::FIX_INTERNAL_EDGES);
    for half in [0.02, 0.0025, 0.001] {
        let card = [(Vector::ZERO, Vector::new(0.4, half, 0.3))];
        slides_as_rapiers(&format!("{half} m"), &card, half, &ground, 0.02);
    }
}

/// A thick bar with a rod of 5 mm below it, on which it stands, and a press that goes down on it by 2 cm.
#[test]
fn thin_feet_of_thick_bodies_are_not_pressed_through_triangles() {
    let sphere = |x: Real, y: Real, r: Real| MedialSphere::new(Vector::new(x, y, 0.0), r);
    let thin = 0.005;
    let spheres = [
        sphere(-0.5, 0.3, 0.15),
        sphere(0.5, 0.3, 0.15),
        sphere(-0.5, thin, thin),
        sphere(0.5, thin, thin),
    ];
    let edges = vec![[0, 1], [2, 3], [0, 2], [1, 3]];
    let sled = MedialMesh::new(spheres.to_vec(), edges, vec![]).expect("a sled");
    for yaw in [0.2, 0.9, 1.7, 2.5] {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ground(), None);
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.31, 0.0005, 0.17))
            .rotation(Vector::Y * yaw);
        let collider = ColliderBuilder::medial_mesh(sled.clone()).density(1000.0);
        let (body, _) = world.insert(body, collider);
        let press = RigidBodyBuilder::kinematic_velocity_based()
            .translation(Vector::Y * 0.753)
            .linvel(Vector::NEG_Y);
        let (press, _) = world.insert(press, ColliderBuilder::cuboid(1.0, 0.3, 1.0));
        let mut pipeline = MedialPipeline::default();
        for step in 0..90 {
            if step == 2 {
                world.bodies[press].set_linvel(Vector::Y, true);
            }
            pipeline.step(&mut world);
            let pose = world.bodies[body].position();
            let ends = [-0.5, 0.5].map(|x| (pose * Vector::new(x, thin, 0.0)).y);
            assert!(
                ends.iter().all(|y| *y > 0.0),
                "yaw {yaw}, step {step}: the rod's axis is at {ends:?} m"
            );
        }
    }
}

/// A table put 20 cm deep into a ground that pushes to its front only, where the way out to the side of
/// a leg is shorter.
#[test]
fn bodies_deep_in_one_sided_triangles_come_out() {
    let collider = both(&table())[0].clone().density(1000.0);
    let heights = Array2::repeat(31, 31, 0.0);
    let flags = HeightFieldFlags::FIX_INTERNAL_EDGES;
    let field = SharedShape::heightfield_with_flags(heights, Vector::new(30.0, 1.0, 30.0), flags);
    let grounds = [
        flagged_ground(TriMeshFlags::FIX_INTERNAL_EDGES),
        ColliderBuilder::new(field),
    ];
    for ground in grounds {
        for yaw in [0.3, 1.4, 2.2] {
            let mut world = PhysicsWorld::new();
            world.insert_collider(ground.clone(), None);
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::new(0.3, 0.05, 0.2))
                .rotation(Vector::Y * yaw);
            let (body, _) = world.insert(body, collider.clone());
            let mut pipeline = MedialPipeline::default();
            for _ in 0..240 {
                pipeline.step(&mut world);
            }
            let height = world.bodies[body].translation().y;
            assert!(height > 0.24, "yaw {yaw}: it is at {height} m");
        }
    }
}

/// A cube of 60 cm that overlaps the plane of a ground by 8 mm flies at the ground's open edge.
#[test]
fn edges_of_sheets_stop_what_overlaps_their_plane() {
    let cube = both(&[(Vector::ZERO, Vector::splat(0.3))])[0].clone();
    let corners = [[0.0, -5.0], [0.0, 5.0], [5.0, 5.0], [5.0, -5.0]];
    let corners = corners.map(|[x, z]| Vector::new(x, 0.0, z));
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let sheet = ColliderBuilder::trimesh(corners.to_vec(), triangles).expect("a sheet");
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    world.insert_collider(sheet, None);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-1.5, 0.292, 0.1))
        .linvel(Vector::X * 60.0);
    let (body, _) = world.insert(body, cube.density(1000.0));
    let mut pipeline = MedialPipeline::default();
    for _ in 0..20 {
        pipeline.step(&mut world);
    }
    let speed = world.bodies[body].linvel().length();
    assert!(speed < 45.0, "{speed} m/s");
}

/// On a turning ground of triangles a table is carried along as rapier's.
#[test]
fn turntables_of_triangles_carry_bodies_as_rapiers() {
    let [ours, own] = both(&table()).map(|body| {
        let mut watched = Watched::default();
        let is_medial = body.shape.as_shape::<MedialMesh>().is_some();
        let mut world = PhysicsWorld::new();
        let turning = RigidBodyBuilder::kinematic_velocity_based().angvel(Vector::Y * 3.0);
        world.insert(turning, flagged_ground(TriMeshFlags::FIX_INTERNAL_EDGES));
        let carried = RigidBodyBuilder::dynamic().translation(Vector::new(3.0, 0.2505, 1.0));
        let (carried, _) = world.insert(carried, body.density(1000.0));
        let mut pipeline = MedialPipeline::default();
        for _ in 0..90 {
            match is_medial {
                true => drop(pipeline.step(&mut world)),
                false => world.step(),
            }
            watched.look(&world, carried);
        }
        (world.bodies[carried].linvel().length(), watched.gain)
    });
    assert!(
        (ours.0 - own.0).abs() < 0.1 * own.0,
        "{ours:?}, rapier's {own:?}"
    );
    assert!(ours.1 < 1.1 * own.1, "{ours:?}, rapier's {own:?}");
}

/// The side of a plateau stops nothing that lies on its top.
#[test]
fn bodies_slide_off_a_plateau_as_rapiers_do() {
    let plateau = plateau().friction(0.0);
    let card: Vec<Part> = vec![(Vector::ZERO, Vector::new(0.4, 0.02, 0.3))];
    for speed in [8.0, 20.0] {
        for phase in 0..8 {
            let [ours, own] = both(&card).map(|body| {
                let is_medial = body.shape.as_shape::<MedialMesh>().is_some();
                let mut world = PhysicsWorld::new();
                world.insert_collider(plateau.clone(), None);
                let slides = RigidBodyBuilder::dynamic()
                    .translation(Vector::new(-3.0 - 0.04 * phase as Real, 0.02, 0.3))
                    .rotation(Vector::Y * 0.4 * phase as Real)
                    .linvel(Vector::X * speed);
                let body = body.friction(0.0).density(1000.0);
                let (body, _) = world.insert(slides, body);
                let mut pipeline = MedialPipeline::default();
                for _ in 0..(4.5 / speed * 60.0) as usize {
                    match is_medial {
                        true => drop(pipeline.step(&mut world)),
                        false => world.step(),
                    }
                }
                world.bodies[body].linvel().x
            });
            assert!(
                (ours - own).abs() < 0.02 * speed,
                "{speed} m/s, phase {phase}: {ours} m/s, rapier's {own}"
            );
        }
    }
}

/// Voxels have no faces between them.
#[test]
fn bodies_slide_over_voxels_as_rapiers_do() {
    let side = |x: i32| (-24..24).map(move |z| IVector::new(x, -1, z));
    let cells: Vec<_> = (-24..24).flat_map(side).collect();
    let ground = ColliderBuilder::voxels(Vector::splat(0.5), &cells);
    let card = [(Vector::ZERO, Vector::new(0.4, 0.02, 0.3))];
    slides_as_rapiers("table", &table(), 0.25, &ground, 0.05);
    slides_as_rapiers("card", &card, 0.02, &ground, 0.05);
}
