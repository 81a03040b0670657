//! What is known to be wrong of queries, and of bodies far smaller than rapier's length unit.

use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::prelude::*;
use rapier3d_medial::MedialDispatcher;
use rapier3d_medial::prelude::*;

/// Whether the axis of a rod, of a radius of a twentieth of `unit` (in metres), gets through a wall of a closed box in
/// five seconds, in a world whose length unit is `length_unit` (in metres).
fn crosses(unit: Real, length_unit: Real, seed: u8) -> bool {
    let mut world = PhysicsWorld::new();
    world.gravity *= unit;
    world.integration_parameters.length_unit = length_unit;
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    for axis in [Vector::X, Vector::Y, Vector::Z] {
        for side in [1.0, -1.0] {
            let half = (Vector::splat(2.5) - axis * 2.0) * unit;
            let wall = ColliderBuilder::cuboid(half.x, half.y, half.z);
            world.insert_collider(wall.translation(axis * (2.0 * side * unit)), None);
        }
    }
    let end = Vector::X * (0.4 * unit);
    let rod = MedialMesh::capsule(-end, end, 0.05 * unit).expect("a rod");
    let d = Real::from(seed);
    let body = RigidBodyBuilder::dynamic()
        .rotation(Vector::new(d.sin(), d.cos(), 0.3))
        .linvel(Vector::new(d.cos(), (1.7 * d).sin(), (2.3 * d).cos()) * (8.0 * unit))
        .angvel(Vector::new(1.0, 2.0, -1.0));
    let collider = ColliderBuilder::medial_mesh(rod).density(500.0);
    let (body, _) = world.insert(body, collider);
    (0..300).any(|_| {
        pipeline.step(&mut world);
        let pose = world.bodies[body].position();
        let off = |p: Vector| (pose * p).abs().max_element();
        off(end).max(off(-end)) > 1.5 * unit
    })
}

/// rapier's solver lets bodies overlap by a thousandth of its length unit: rods of 0.05 mm get through walls in a world
/// whose length unit is a metre. Ten times as large ones do not, nor do small ones where the length unit is as small.
#[test]
fn rods_far_smaller_than_the_length_unit_cross_walls() {
    let crossed = |unit: Real, length_unit: Real| {
        let seeds = (0..20).filter(|seed| crosses(unit, length_unit, *seed));
        seeds.count()
    };
    assert_eq!(crossed(0.01, 1.0), 0);
    assert_eq!(crossed(0.001, 0.001), 0);
    let small = crossed(0.001, 1.0);
    assert!(small > 0, "{small} of 20: mended?");
}

/// parry merges the faces of a hull that are about as one into one of a single normal, without the corners between
/// them: of a box with a roof 8 mm high it keeps one tilted face. Its surface is what medial bodies are held against,
/// so that they are off by some of these 8 mm there; rapier's own shapes are held against the corners.
#[test]
fn blunt_roofs_of_hulls_are_not_where_they_are() {
    let corner = |k: u8| {
        let side = |bit: u8| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Vector::new(0.5 * side(0), 0.2 * side(1), 0.5 * side(2))
    };
    let mut corners: Vec<Vector> = (0..8).map(corner).collect();
    corners.push(Vector::Y * 0.208);
    let hull = SharedShape::convex_hull(&corners).expect("a box with a roof");
    let ball = MedialMesh::ball(0.001).expect("a ball");
    let dispatcher = MedialDispatcher::default();
    let mut off = 0;
    for k in 0..400 {
        let [x, z] = [k % 20, k / 20].map(|i| 0.04 * (i as Real - 9.5));
        let roof = 0.208 - 0.016 * x.abs().max(z.abs());
        let pose = Pose::translation(x, roof + 0.011, z);
        let told = dispatcher.distance(&pose, &*hull, &ball).expect("known");
        off += usize::from((told.distance - 0.01).abs() > 1.0e-3);
    }
    assert!(off > 100, "{off} of 400 are off");
}

/// Bits of the heights, in units, of twelve rings that fall on each other, after each of 150 steps.
fn heights_of_rings(unit: Real, aside: Real) -> Vec<u32> {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.length_unit = unit;
    world.gravity *= unit;
    let ground = ColliderBuilder::cuboid(9.0 * unit, 0.125 * unit, 9.0 * unit);
    world.insert_collider(ground, None);
    let ring = MedialMesh::torus(0.5 * unit, 0.125 * unit, 24).expect("a ring");
    let fall = |k: u8| {
        let [x, z] = [aside * Real::from(k % 3), 0.03 * Real::from(k % 4)];
        let at = Vector::new(x, 0.5 + 0.4 * Real::from(k), z);
        let body = RigidBodyBuilder::dynamic()
            .translation(at * unit)
            .rotation(Vector::new(0.3 * Real::from(k), 0.1, 0.2));
        let collider = ColliderBuilder::medial_mesh(ring.clone()).mass(1.0);
        world.insert(body, collider).0
    };
    let rings: Vec<RigidBodyHandle> = (0..12).map(fall).collect();
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    let mut heights = Vec::new();
    for _ in 0..150 {
        pipeline.step(&mut world);
        let of = |ring: &RigidBodyHandle| world.bodies[*ring].translation().y / unit;
        heights.extend(rings.iter().map(|ring| of(ring).to_bits()));
    }
    heights
}

/// Worlds of another length unit are the same to the bit (scenes `length_units`), but some heaps of rings are not in
/// small units. parry finds the contacts of a ring with the cuboid below it by its GJK algorithm, whose tolerances are
/// lengths: at the same pose in units the normal of one was tilted by .002 in the small unit, and upright in the large.
#[test]
fn a_heap_of_rings_goes_otherwise_in_a_small_length_unit() {
    let differs = |aside: Real| heights_of_rings(1.0, aside) != heights_of_rings(1.0 / 64.0, aside);
    assert!(!differs(0.051));
    assert!(differs(0.05), "mended?");
}
