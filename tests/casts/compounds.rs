//! Distances and casts to compounds of many children: no child is missed. The oracle is every child by itself.

use crate::rng::Rng;
use rapier3d::parry::query::{NonlinearRigidMotion, QueryDispatcher};
use rapier3d::parry::shape::{Compound, Shape, SharedShape};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::{MedialDispatcher, MedialMesh};

/// Difference of distances that rounding may make, a length.
const ROUNDING: Real = 1.0e-4;

/// Difference of times of impact that the casts' tolerance and rounding may make, in seconds.
const TIME: Real = 2.0e-3;

fn vector(rng: &mut Rng, by: f64) -> Vector {
    let mut number = || rng.range(-by, by) as Real;
    Vector::new(number(), number(), number())
}

/// Solids here and there in a block 10 m wide.
fn heap(rng: &mut Rng) -> Compound {
    let solids = (0..200).map(|i| {
        let half = vector(rng, 0.25) + 0.3;
        let solid = match i % 6 {
            0 => SharedShape::cuboid(half.x, half.y, half.z),
            1 => SharedShape::round_cuboid(half.x, half.y, half.z, 0.1),
            2 => SharedShape::ball(half.x),
            3 => SharedShape::capsule_y(half.y, half.x),
            4 => SharedShape::cylinder(half.y, half.x),
            _ => SharedShape::cone(half.y, half.x),
        };
        (Pose::new(vector(rng, 5.0), vector(rng, 3.0)), solid)
    });
    Compound::new(solids.collect())
}

#[test]
fn distances_and_casts_to_a_heap_are_those_to_its_nearest_child() {
    let mesh = MedialMesh::cuboid(Vector::new(0.3, 0.05, 0.2)).expect("a box");
    let dispatcher = MedialDispatcher::default();
    let mut rng = Rng::new(5);
    let (mut apart, mut hits, mut misses) = (0, 0, 0);
    for _ in 0..10 {
        let heap = heap(&mut rng);
        for _ in 0..20 {
            let pose = Pose::new(vector(&mut rng, 6.0), vector(&mut rng, 3.0));
            let to = |child: &Pose, shape: &dyn Shape| {
                let pos12 = pose.inverse() * *child;
                dispatcher
                    .distance(&pos12, &mesh, shape)
                    .expect("a distance")
                    .distance
            };
            let whole = to(&Pose::IDENTITY, &heap);
            let least = heap.shapes().iter().map(|(child, s)| to(child, &**s));
            let least = least.fold(Real::MAX, Real::min);
            assert!((whole - least).abs() <= ROUNDING, "{whole} m, {least} m");
            if whole <= 0.0 {
                continue;
            }
            apart += 1;

            let motion = NonlinearRigidMotion {
                linvel: vector(&mut rng, 4.0),
                angvel: vector(&mut rng, 2.0),
                ..NonlinearRigidMotion::constant_position(pose)
            };
            let cast = |child: &Pose, shape: &dyn Shape| {
                let still = NonlinearRigidMotion::constant_position(*child);
                let hit = dispatcher
                    .cast_shapes_nonlinear(&motion, &mesh, &still, shape, 0.0, 0.5, true)
                    .expect("a cast");
                hit.map_or(Real::MAX, |hit| hit.time_of_impact)
            };
            let whole = cast(&Pose::IDENTITY, &heap);
            let first = heap.shapes().iter().map(|(child, s)| cast(child, &**s));
            let first = first.fold(Real::MAX, Real::min);
            assert!((whole - first).abs() <= TIME, "{whole} s, {first} s");
            *(if whole < 1.0 { &mut hits } else { &mut misses }) += 1;
        }
    }
    assert!(apart >= 60, "{apart} of 200 are apart");
    assert!(hits >= 20 && misses >= 20, "{hits} hits, {misses} misses");
}
