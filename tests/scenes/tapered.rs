//! Cones and slabs whose spheres differ much in radius, on triangles with rapier's flag for internal edges.

use crate::random::Random;
use crate::triangles::ground_of;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Bodies of each kind.
const SEEDS: u64 = 12;

/// Radius of the largest sphere and distance of the others from it, in metres.
const THICK: Real = 0.2;
const LONG: Real = 0.3;

/// A cone, or a slab, whose radius falls by `slope` of the way from its largest sphere.
fn tapered(slope: Real, is_slab: bool) -> MedialMesh {
    let thin = THICK - slope * LONG;
    let spheres = [
        MedialSphere::new(Vector::ZERO, THICK),
        MedialSphere::new(Vector::X * LONG, thin),
        MedialSphere::new(Vector::Y * LONG, thin),
    ];
    let body = match is_slab {
        true => MedialMesh::new(spheres.to_vec(), vec![], vec![[0, 1, 2]]),
        false => MedialMesh::new(spheres[..2].to_vec(), vec![[0, 1]], vec![]),
    };
    body.expect("a cone or a slab")
}

/// How deep a body is in the plane Y = 0 after it was dropped on this ground, and whether it sleeps.
fn dropped(ground: &ColliderBuilder, body: &MedialMesh, seed: u64) -> (Real, bool) {
    let mut random = Random(seed);
    let mut world = PhysicsWorld::new();
    world.insert_collider(ground.clone(), None);
    let mut any = |most: Real| Vector::from([0; 3].map(|_| random.within(-most, most)));
    let at = any(2.0).with_y(0.6);
    let falling = RigidBodyBuilder::dynamic()
        .translation(at)
        .rotation(any(3.0));
    let collider = ColliderBuilder::medial_mesh(body.clone()).density(1000.0);
    let (falling, _) = world.insert(falling, collider);
    let mut pipeline = MedialPipeline::default();
    for _ in 0..300 {
        pipeline.step(&mut world);
    }
    let now = &world.bodies[falling];
    let depth = |s: &MedialSphere| s.radius - (now.position() * s.center).y;
    let deepest = body.spheres().iter().map(depth).fold(Real::MIN, Real::max);
    (deepest, now.is_sleeping())
}

/// Symptom: cones fell through a flat ground, or came to rest up to 16 cm deep in it. Cause: a cone's tangent segment,
/// which parry takes for what touches the ground, is far from its lowest point, and of flagged triangles parry leaves
/// out the contact of the nearest points. A convex hull of the spheres comes to rest at most 6.4 mm deep.
#[test]
fn tapered_bodies_rest_on_flagged_triangles() {
    let flat = Array2::repeat(4, 4, 0.0);
    let scale = Vector::new(18.0, 1.0, 18.0);
    let field =
        SharedShape::heightfield_with_flags(flat, scale, HeightFieldFlags::FIX_INTERNAL_EDGES);
    let grounds = [
        (
            "cells of 1 m",
            ground_of(1.0, TriMeshFlags::FIX_INTERNAL_EDGES),
        ),
        (
            "cells of .25 m",
            ground_of(0.25, TriMeshFlags::FIX_INTERNAL_EDGES),
        ),
        (
            "two sides",
            ground_of(1.0, TriMeshFlags::FIX_INTERNAL_EDGES_TWO_SIDED),
        ),
        ("a height field", ColliderBuilder::new(field)),
    ];
    for (name, ground) in &grounds {
        for (slope, is_slab) in [
            (0.2, false),
            (0.4, false),
            (0.6, false),
            (0.4, true),
            (0.6, true),
        ] {
            let body = tapered(slope, is_slab);
            let ends: Vec<_> = (1..=SEEDS)
                .map(|seed| dropped(ground, &body, seed))
                .collect();
            let deepest = ends.iter().map(|end| end.0).fold(Real::MIN, Real::max);
            let awake = ends.iter().filter(|end| !end.1).count();
            println!("{name}, slope {slope}, slab {is_slab}: {deepest} m deep, {awake} awake");
            assert!(
                deepest < 5.0e-3,
                "{name}, slope {slope}, slab {is_slab}: {ends:?}"
            );
        }
    }
}
