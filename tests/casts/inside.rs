//! A body that starts wholly inside a closed one touches no surface: only the inside test tells.

use parry3d::math::{IVector, Pose, Vector};
use parry3d::query::details::ShapeCastOptions;
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher};
use parry3d::shape::{Shape, SharedShape};
use rapier3d_medial::{MedialDispatcher, MedialMesh};

#[test]
fn casts_from_inside_hit_at_once_unless_they_may_leave() {
    let mesh = MedialMesh::torus(0.3, 0.1, 8).expect("a torus");
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 3.0 } else { -3.0 };
        Vector::new(side(0), side(1), side(2))
    };
    let corners: Vec<Vector> = (0..8).map(corner).collect();
    let bodies = [
        ("ball", SharedShape::ball(3.0)),
        ("capsule", SharedShape::capsule_y(2.0, 3.0)),
        ("cuboid", SharedShape::cuboid(3.0, 3.0, 3.0)),
        (
            "round cuboid",
            SharedShape::round_cuboid(3.0, 3.0, 3.0, 0.2),
        ),
        ("hull", SharedShape::convex_hull(&corners).expect("a hull")),
        ("cylinder", SharedShape::cylinder(3.0, 3.0)),
        ("round cylinder", SharedShape::round_cylinder(3.0, 3.0, 0.2)),
        ("cone", SharedShape::cone(4.0, 4.0)),
        ("round cone", SharedShape::round_cone(4.0, 4.0, 0.2)),
        ("half-space", SharedShape::halfspace(Vector::Y)),
    ];
    let dispatcher = MedialDispatcher::default();
    for (name, body) in &bodies {
        let motion1 = NonlinearRigidMotion {
            linvel: Vector::new(0.0, 12.0, 0.0),
            angvel: Vector::new(0.5, 0.2, 1.0),
            ..NonlinearRigidMotion::constant_position(Pose::translation(0.1, -1.0, 0.2))
        };
        let still = NonlinearRigidMotion::identity();
        let (g1, g2): (&dyn Shape, _) = (&mesh, body.as_ref());
        let cast = |stop: bool| {
            let hit = dispatcher.cast_shapes_nonlinear(&motion1, g1, &still, g2, 0.0, 1.0, stop);
            let swapped = dispatcher
                .cast_shapes_nonlinear(&still, g2, &motion1, g1, 0.0, 1.0, stop)
                .expect("swept");
            let hit = hit.expect("swept").map(|h| h.time_of_impact);
            assert_eq!(hit, swapped.map(|h| h.time_of_impact), "{name}");
            hit
        };
        assert_eq!(cast(true), Some(0.0), "{name}");
        assert!(cast(false).is_none_or(|t| t > 0.0), "{name}");
    }
}

/// What touches at the start and may go on touching: sliding and leaving are free, sinking in ends
/// before the medial axis reaches the surface.
#[test]
fn shapes_that_touch_at_the_start_may_slide_but_not_sink_in() {
    const TUBE: f32 = 0.1;
    let mesh = MedialMesh::torus(0.3, TUBE, 8).expect("a torus");
    // Each with its flat side or its top at height 1.
    let upright = Pose::IDENTITY;
    let upside_down = Pose::rotation(Vector::new(std::f32::consts::PI, 0.0, 0.0));
    let bodies = [
        ("cuboid", upright, SharedShape::cuboid(3.0, 1.0, 3.0)),
        ("cylinder", upright, SharedShape::cylinder(1.0, 3.0)),
        (
            "round cylinder",
            upright,
            SharedShape::round_cylinder(0.8, 3.0, 0.2),
        ),
        ("cone", upside_down, SharedShape::cone(1.0, 3.0)),
        (
            "round cone",
            upside_down,
            SharedShape::round_cone(0.8, 3.0, 0.2),
        ),
        (
            "compound",
            upright,
            SharedShape::compound(vec![
                (upside_down, SharedShape::cone(1.0, 3.0)),
                (Pose::translation(2.0, 0.0, 0.0), SharedShape::ball(0.5)),
            ]),
        ),
    ];
    let dispatcher = MedialDispatcher::default();
    for (name, pose, body) in &bodies {
        let still = NonlinearRigidMotion::constant_position(*pose);
        let cast = |height: f32, velocity: Vector| {
            let start = Pose::translation(0.0, 1.0 + TUBE + height, 0.0);
            let motion = NonlinearRigidMotion {
                linvel: velocity,
                ..NonlinearRigidMotion::constant_position(start)
            };
            let hit = dispatcher.cast_shapes_nonlinear(
                &motion,
                &mesh,
                &still,
                body.as_ref(),
                0.0,
                1.0,
                false,
            );
            hit.expect("swept").map(|h| h.time_of_impact)
        };
        for height in [5.0e-5, 0.0, -1.0e-3] {
            assert_eq!(cast(height, Vector::X), None, "{name} slides from {height}");
            assert_eq!(cast(height, Vector::Y), None, "{name} leaves from {height}");
            let sunk = cast(height, -Vector::Y).map(|t| t - height);
            assert!(
                sunk.is_some_and(|d| d > 0.01 && d < TUBE),
                "{name} sinks {sunk:?} from {height}"
            );
        }
    }
}

/// Bad numbers and shapes without a size are answered, whatever the answer.
#[test]
fn bad_motions_and_flat_shapes_do_not_panic() {
    let mesh = MedialMesh::torus(0.3, 0.1, 8).expect("a torus");
    let shapes = [
        SharedShape::cylinder(0.0, 0.0),
        SharedShape::cylinder(0.0, 1.0),
        SharedShape::cone(0.0, 0.0),
        SharedShape::cone(0.0, 1.0),
        SharedShape::cone(1.0, 0.0),
        SharedShape::cylinder(1.0e20, 1.0e-20),
        SharedShape::cone(f32::NAN, f32::INFINITY),
        SharedShape::round_cone(0.0, 0.0, 0.1),
        SharedShape::halfspace(Vector::Y),
    ];
    let bad = [0.0, 1.0e-30, 1.0e18, f32::MAX, f32::INFINITY, f32::NAN];
    let dispatcher = MedialDispatcher::default();
    for shape in &shapes {
        for value in bad {
            for place in 0..3 {
                let mut values = [2.0, -4.0, 1.0];
                values[place] = value;
                let [at, speed, turn] = values;
                let motion = NonlinearRigidMotion {
                    linvel: Vector::Y * speed,
                    angvel: Vector::X * turn,
                    ..NonlinearRigidMotion::constant_position(Pose::translation(0.0, at, 0.0))
                };
                let still = NonlinearRigidMotion::identity();
                for stop in [true, false] {
                    let _ = dispatcher.cast_shapes_nonlinear(
                        &motion,
                        &mesh,
                        &still,
                        shape.as_ref(),
                        0.0,
                        1.0,
                        stop,
                    );
                }
                let options = ShapeCastOptions::with_max_time_of_impact(value);
                let _ = dispatcher.cast_shapes(
                    &motion.start,
                    motion.linvel,
                    &mesh,
                    shape.as_ref(),
                    options,
                );
            }
        }
    }
}

/// A cylinder or cone without a size is a point, without a height a disk: both are solid enough to hit.
#[test]
fn a_point_and_a_disk_are_hit_where_they_are() {
    let ball = MedialMesh::ball(0.5).expect("a ball");
    let down = NonlinearRigidMotion {
        linvel: -Vector::Y * 4.0,
        ..NonlinearRigidMotion::constant_position(Pose::translation(0.0, 2.5, 0.0))
    };
    let still = NonlinearRigidMotion::identity();
    for shape in [
        SharedShape::cylinder(0.0, 0.0),
        SharedShape::cylinder(0.0, 1.0),
        SharedShape::cone(0.0, 0.0),
        SharedShape::cone(0.0, 1.0),
    ] {
        let hit = MedialDispatcher::default()
            .cast_shapes_nonlinear(&down, &ball, &still, shape.as_ref(), 0.0, 1.0, true)
            .expect("swept");
        assert!(
            hit.is_some_and(|h| (h.time_of_impact - 0.5).abs() < 1.0e-4),
            "{hit:?}"
        );
    }
}

/// A ball whose centre is exactly on the top of a row of voxels gets out upwards.
#[test]
fn a_centre_on_the_face_of_a_voxel_has_a_way_out() {
    let cells: Vec<_> = (-3..3).map(|x| IVector::new(x, 0, 0)).collect();
    let voxels = SharedShape::voxels(Vector::ONE, &cells);
    let mesh = MedialMesh::ball(0.25).expect("a ball");
    let options = ShapeCastOptions {
        compute_impact_geometry_on_penetration: true,
        ..ShapeCastOptions::with_max_time_of_impact(1.0)
    };
    for x in [-0.5, 0.25, 0.5] {
        let pose = Pose::translation(x, 1.0, 0.5);
        let hit = MedialDispatcher::default()
            .cast_shapes(&pose, Vector::NEG_Y, voxels.as_ref(), &mesh, options)
            .expect("swept")
            .expect("overlapping");
        assert!(hit.normal1.dot(Vector::Y) > 0.99, "{x}: {hit:?}");
    }
}
