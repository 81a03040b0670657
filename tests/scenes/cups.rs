//! Cups with flat sides, built of overlapping convex pieces, that are dropped on each other: their thin walls get into
//! each other.

use crate::bodies::world_with_ground;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::{PI, TAU};

/// A cup 0.4 m high and 0.5 m wide, with so many sides, a bottom and walls 3 cm thick.
fn cup(sides: u32) -> ColliderBuilder {
    const WALL: Real = 0.03;
    let ring = |radius: Real, height: Real| {
        (0..sides).map(move |k| {
            let (sin, cos) = (TAU * k as Real / sides as Real).sin_cos();
            Vector::new(radius * cos, height, radius * sin)
        })
    };
    let rings = [
        (0.25, 0.0),
        (0.25, 0.4),
        (0.25 - WALL, 0.4),
        (0.25 - WALL, WALL),
    ];
    let corners: Vec<Vector> = rings.into_iter().flat_map(|(r, h)| ring(r, h)).collect();
    let mut triangles = Vec::new();
    for band in 0..3 {
        for k in 0..sides {
            let [a, b] = [k, (k + 1) % sides].map(|k| band * sides + k);
            triangles.extend([[a, a + sides, b], [b, a + sides, b + sides]]);
        }
    }
    for k in 1..sides - 1 {
        let inner = 3 * sides;
        triangles.extend([[0, k, k + 1], [inner, inner + k + 1, inner + k]]);
    }
    let built = MedialMesh::from_trimesh(&corners, &triangles, &BuildOptions::default());
    let (mesh, report) = built.expect("a cup");
    assert!(report.hausdorff.error() < 1.0e-5, "{report:?}");
    ColliderBuilder::medial_mesh(mesh).density(500.0)
}

/// Impacts in 300 steps of a heap of 20 cups, how often a cup was frozen, and how often in the last 100 steps.
fn heap(cup: &ColliderBuilder, seed: u64) -> [usize; 3] {
    let mut random = Random(seed);
    let mut world = world_with_ground();
    for k in 0..20 {
        let [x, z] = [0, 1].map(|_| random.within(-0.4, 0.4));
        let turn = [0, 1, 2].map(|_| random.within(-2.0, 2.0));
        let at = Vector::new(x, 0.5 + 0.3 * k as Real, z);
        let pose = Pose::new(at, Vector::from_array(turn));
        world.insert(RigidBodyBuilder::dynamic().pose(pose), cup.clone());
    }
    let mut pipeline = MedialPipeline::default();
    let mut counts = [0; 3];
    for step in 0..300 {
        let report = pipeline.step(&mut world);
        counts[0] += report.events;
        counts[1] += report.frozen;
        counts[2] += if step < 200 { 0 } else { report.frozen };
    }
    counts
}

/// Symptom: cups hung in the air for ever, frozen in each step, at 110 to 240 ms a step. Cause: where the axes of two
/// walls were about to cross, the impact acted along the normal of another wall that held the place, on the far side of
/// the two: along it they parted already, so it did nothing.
#[test]
fn cups_do_not_hang_in_each_other() {
    let cup = cup(8);
    for seed in [2, 4, 8] {
        let [impacts, frozen, late] = heap(&cup, seed);
        println!("heap {seed}: {impacts} impacts, {frozen} times frozen, {late} at the end");
        assert!(frozen < 20 && late == 0, "heap {seed}: {frozen}, {late}");
    }
}

/// Symptom: 20 cups of sixteen sides that rolled and lay on the ground had 18 impacts in each step, at 25 ms. Cause:
/// their walls reach into each other with edges of 22.5°, which counted as sheets: as fast at any speed.
#[test]
fn cups_of_many_sides_slide_slowly_without_impacts() {
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(20.0, 0.5, 20.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground.friction(0.0), None);
    let lying = Pose::new(Vector::Y * 0.2452, Vector::Z * (0.5 * PI))
        * Pose::rotation(Vector::Y * (PI / 16.0));
    let body = RigidBodyBuilder::dynamic().pose(lying);
    let (body, _) = world.insert(body.linvel(Vector::Z * 0.15), cup(16).friction(0.0));
    let mut pipeline = MedialPipeline::default();
    let impacts: usize = (0..60).map(|_| pipeline.step(&mut world).events).sum();
    let way = world.bodies[body].translation().z;
    println!("{impacts} impacts, {way} m");
    assert!(way > 0.1, "{way} m");
    assert_eq!(impacts, 0);
}

/// A block with a blade of 20° that stands out of it, flat below.
fn blade() -> ColliderBuilder {
    let half = Vector::new(0.1, 0.05, 0.1);
    let (mut corners, mut triangles) = Cuboid::new(half).to_trimesh();
    let (back, tip) = (0.08, 0.1 + 0.08 / Real::tan(PI / 9.0));
    let first = corners.len() as u32;
    for z in [-0.1, 0.1] {
        let outline = [[0.0, -0.05], [tip, -0.05], [0.0, back - 0.05]];
        corners.extend(outline.map(|[x, y]| Vector::new(x, y, 0.8 * z)));
    }
    let wedge = [
        [0, 2, 1],
        [3, 4, 5],
        [0, 1, 4],
        [0, 4, 3],
        [1, 2, 5],
        [1, 5, 4],
        [2, 0, 3],
        [2, 3, 5],
    ];
    triangles.extend(wedge.map(|t| t.map(|k| first + k)));
    let built = MedialMesh::from_trimesh(&corners, &triangles, &BuildOptions::default());
    let (mesh, report) = built.expect("a blade");
    assert!(report.hausdorff.error() < 1.0e-5, "{report:?}");
    ColliderBuilder::medial_mesh(mesh)
}

/// A tip counts as thick only where another piece holds all of it: what slides on a blade is watched at any speed.
#[test]
fn blades_that_stand_out_of_a_block_are_thin() {
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(20.0, 0.5, 20.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground.friction(0.0), None);
    let body = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.051);
    world.insert(body.linvel(Vector::Z * 0.15), blade().friction(0.0));
    let mut pipeline = MedialPipeline::default();
    let queries: usize = (0..60)
        .map(|_| pipeline.step(&mut world).continuous_queries as usize)
        .sum();
    println!("{queries} searches");
    assert!(queries > 30, "{queries} searches");
}
