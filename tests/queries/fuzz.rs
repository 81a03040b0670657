//! Any numbers: every query ends, and does not panic; what it promises is a time of the step.
//!
//! More cases: `PROPTEST_CASES=1000000 cargo test --release --test queries fuzz`. Finds are kept in
//! `regressions.rs`. Endless turns are for `casts`, `turns` and the fuzzing of `medial`.

use parry3d::query::{
    DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher, ShapeCastOptions,
};
use parry3d::shape::SharedShape;
use proptest::prelude::*;
use rapier3d_medial::elementary::{self, MovingSphere, Toi, ToiOptions};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::parry::MedialDispatcher;
use rapier3d_medial::{MedialMesh, MedialSphere, pair};

/// Mostly of a common size, sometimes any bits at all.
fn number() -> impl Strategy<Value = Real> {
    prop_oneof![
        12 => -2.0f32..2.0,
        2 => prop::sample::select(vec![0.0, 1.0e-30, 1.0e-6, 1.0e4, 1.0e18, -1.0e18]),
        1 => prop::num::f32::ANY,
    ]
}

fn vector() -> impl Strategy<Value = Vector> {
    [number(), number(), number()].prop_map(Vector::from_array)
}

fn motion() -> impl Strategy<Value = NonlinearRigidMotion> {
    let turn = prop_oneof![3 => vector(), 1 => vector().prop_map(|v| v * 40.0)];
    (vector(), vector(), vector(), vector(), turn).prop_map(|(at, rotation, center, v, w)| {
        // Longer ones end too, but cost a million node pairs each.
        let w = if w.is_finite() {
            w.clamp_length_max(40.0)
        } else {
            w
        };
        NonlinearRigidMotion::new(Pose::new(at, rotation), center, v * 3.0, w)
    })
}

fn spheres() -> impl Strategy<Value = Vec<MovingSphere>> {
    let sphere =
        (vector(), number(), vector()).prop_map(|(center, radius, displacement)| MovingSphere {
            center,
            radius: radius.abs(),
            displacement,
        });
    prop::collection::vec(sphere, 1..4)
}

fn options() -> impl Strategy<Value = ToiOptions> {
    (number(), number(), number()).prop_map(|(tolerance, time, target)| ToiOptions {
        tolerance: tolerance.abs() * 0.01,
        time_tolerance: time.abs() * 0.01,
        target_distance: target * 0.1,
        ..ToiOptions::default()
    })
}

/// A mesh of cones and slabs over a few spheres, if these numbers make one.
fn mesh() -> impl Strategy<Value = Option<MedialMesh>> {
    let sphere = (vector(), number());
    let index = 0..6u32;
    (
        prop::collection::vec(sphere, 6),
        prop::collection::vec([index.clone(), index.clone()], 1..5),
        prop::collection::vec([index.clone(), index.clone(), index], 0..3),
    )
        .prop_map(|(spheres, edges, faces)| {
            let spheres = spheres
                .into_iter()
                .map(|(c, r)| MedialSphere::new(c, (r * 0.3).abs()))
                .collect();
            MedialMesh::new(spheres, edges, faces).ok()
        })
}

fn others() -> Vec<SharedShape> {
    let (vertices, indices) = parry3d::shape::Ball::new(0.4).to_trimesh(5, 5);
    vec![
        SharedShape::ball(0.3),
        SharedShape::cuboid(0.2, 0.4, 0.1),
        SharedShape::capsule_y(0.4, 0.0),
        SharedShape::cylinder(0.3, 0.2),
        SharedShape::cone(0.3, 0.2),
        SharedShape::halfspace(Vector::Y),
        SharedShape::trimesh(vertices, indices).expect("a surface"),
        SharedShape::segment(Vector::X, Vector::X),
    ]
}

fn in_step(toi: &Toi, end: Real) -> bool {
    toi.lower >= 0.0 && (toi.lower <= end)
}

proptest! {
    #[test]
    fn elementary_queries_end(
        a in spheres(), b in spheres(), m in motion(), n in motion(), options in options(),
        seconds in -0.1f32..0.1,
    ) {
        prop_assert!(in_step(&elementary::first_contact(&a, &b, &options), 1.0));
        elementary::alternating(&a, &b, &options);
        let still = |all: &[MovingSphere]| -> Vec<_> {
            all.iter().map(|s| MedialSphere::new(s.center, s.radius)).collect()
        };
        let toi = elementary::first_contact_rigid(&still(&a), &m, &still(&b), &n, seconds, &options);
        prop_assert!(in_step(&toi, 1.0), "{toi:?}");
    }

    #[test]
    fn queries_of_meshes_end(
        a in mesh(), b in mesh(), m in motion(), n in motion(), options in options(),
        seconds in -0.1f32..0.1,
    ) {
        if let (Some(a), Some(b)) = (a, b) {
            let toi = pair::first_contact(&a, &m, &b, &n, seconds, &options);
            prop_assert!(in_step(&toi, 1.0), "{toi:?}");
        }
    }

    #[test]
    fn queries_of_shapes_end(
        a in mesh(), b in mesh(), m in motion(), n in motion(), seconds in -0.1f32..0.1,
        distance in number(), stop in any::<bool>(),
    ) {
        let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
        let mut shapes = others();
        shapes.extend(b.map(SharedShape::new));
        let Some(a) = a else { return Ok(()) };
        let cast = ShapeCastOptions {
            max_time_of_impact: seconds.abs(),
            target_distance: distance,
            stop_at_penetration: stop,
            compute_impact_geometry_on_penetration: true,
        };
        let pos12 = m.start.inv_mul(&n.start);
        for shape in &shapes {
            let other = &**shape;
            let _ = dispatcher.distance(&pos12, &a, other);
            let _ = dispatcher.intersection_test(&pos12, &a, other);
            let _ = dispatcher.closest_points(&pos12, &a, other, distance.abs());
            let _ = dispatcher.contact(&pos12, &a, other, distance.abs());
            let _ = dispatcher.cast_shapes(&pos12, n.linvel, &a, other, cast);
            let hit = dispatcher.cast_shapes_nonlinear(&m, &a, &n, other, 0.0, seconds.abs(), stop);
            if let Ok(Some(hit)) = hit {
                prop_assert!(!hit.time_of_impact.is_nan() && hit.time_of_impact >= 0.0);
            }
        }
    }
}
