//! Bodies of many primitives lie still on every ground. rapier solves four contacts of one normal, so
//! that a convex compound of as many parts sinks in and trembles; it stands beside, to show that these
//! can fail. Where the body lies is read off its spheres.

use crate::bodies::*;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::{PI, TAU};

/// Fifteen seconds of simulated time.
const LIMIT: usize = 900;

/// Spheres along a trefoil knot, 1 m across.
pub fn knot() -> Vec<MedialSphere> {
    let at = |k: usize| {
        let t = TAU * k as Real / 150.0;
        let (x, z) = (
            t.sin() + 2.0 * (2.0 * t).sin(),
            t.cos() - 2.0 * (2.0 * t).cos(),
        );
        MedialSphere::new(Vector::new(x, -(3.0 * t).sin(), z) * 0.17, 0.07)
    };
    (0..150).map(at).collect()
}

/// Spheres of a wreath: a ring whose tube swells nine times.
fn wreath() -> Vec<MedialSphere> {
    let at = |k: usize| {
        let t = TAU * k as Real / 120.0;
        let center = Vector::new(0.4 * t.cos(), 0.0, 0.4 * t.sin());
        MedialSphere::new(center, 0.07 + 0.02 * (9.0 * t).sin())
    };
    (0..120).map(at).collect()
}

/// Grounds with their top at height 0.
fn grounds() -> [(&'static str, ColliderBuilder); 5] {
    let square = |x: Real, z: Real| Vector::new(9.0 * x, 0.0, 9.0 * z);
    let corners = vec![
        square(-1.0, -1.0),
        square(-1.0, 1.0),
        square(1.0, 1.0),
        square(1.0, -1.0),
    ];
    let flat = rapier3d::parry::utils::Array2::new(13, 13, vec![0.0; 169]);
    let slab = ColliderBuilder::cuboid(9.0, 0.5, 9.0).translation(Vector::new(0.0, -0.5, 0.0));
    let hull: Vec<Vector> = (0..24)
        .map(|i| {
            let t = PI * (i / 2) as Real / 6.0;
            Vector::new(9.0 * t.cos(), -((i % 2) as Real), 9.0 * t.sin())
        })
        .collect();
    [
        ("cuboid", slab),
        (
            "half-space",
            ColliderBuilder::new(SharedShape::new(HalfSpace::new(Vector::Y))),
        ),
        (
            "triangle mesh",
            ColliderBuilder::trimesh(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("a square"),
        ),
        (
            "height field",
            ColliderBuilder::heightfield(flat, Vector::new(18.0, 1.0, 18.0)),
        ),
        ("hull", ColliderBuilder::convex_hull(&hull).expect("a hull")),
    ]
}

/// A body let fall: the step from which it sleeps, and the height of its lowest point in the end.
fn lie(
    spheres: &[MedialSphere],
    collider: ColliderBuilder,
    ground: ColliderBuilder,
    seed: u64,
) -> (Option<usize>, Real) {
    let mut world = PhysicsWorld::new();
    world.insert_collider(ground, None);
    let mut pipeline = attached(&mut world);
    let turn = Vector::new(1.0, seed as Real, 0.3 * seed as Real);
    let body = RigidBodyBuilder::dynamic().pose(Pose::new(Vector::Y * 0.8, turn));
    let (body, _) = world.insert(body.angular_damping(0.5), collider.density(1000.0));
    let slept = steps_until_sleep(&mut world, &mut pipeline, LIMIT);
    let pose = world.bodies[body].position();
    let low = |s: &MedialSphere| (pose * s.center).y - s.radius;
    (slept, spheres.iter().map(low).fold(1.0, Real::min))
}

#[test]
fn knots_and_wreaths_lie_still_on_every_ground() {
    for spheres in [knot(), wreath()] {
        let mesh = MedialMesh::tube(&spheres, true).expect("a closed tube");
        for (name, ground) in grounds() {
            for seed in 0..4 {
                let collider = ColliderBuilder::medial_mesh(mesh.clone());
                let (slept, lowest) = lie(&spheres, collider, ground.clone(), seed);
                assert!(
                    slept.is_some() && lowest.abs() < 1.0e-3,
                    "{name}, {seed}: {slept:?}, {lowest} m"
                );
            }
        }
    }
}

#[test]
fn compounds_of_as_many_parts_sink_and_do_not_sleep() {
    let spheres = knot();
    let next = |k: usize| spheres[(k + 1) % spheres.len()].center;
    let capsule = |(k, s): (usize, &MedialSphere)| {
        let capsule = SharedShape::capsule(s.center, next(k), s.radius);
        (Pose::IDENTITY, capsule)
    };
    let parts: Vec<_> = spheres.iter().enumerate().map(capsule).collect();
    let [(_, ground), ..] = grounds();
    for seed in 0..2 {
        let collider = ColliderBuilder::compound(parts.clone());
        let (slept, lowest) = lie(&spheres, collider, ground.clone(), seed);
        assert!(slept.is_none() && lowest < -5.0e-3, "{slept:?}, {lowest} m");
    }
}
