//! What the fuzzing found, kept.

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query::{DefaultQueryDispatcher, PointQuery, QueryDispatcher};
use parry3d::shape::SharedShape;
use rapier3d_medial::parry::MedialDispatcher;
use rapier3d_medial::{AssetError, MedialMesh, MedialSphere, MeshError};

/// The inverse of a pose so far away is not finite: a panic here, and a debug assertion of parry.
#[test]
fn poses_at_the_end_of_the_numbers_are_survived() {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let sphere = |x, y, z, r| MedialSphere::new(Vector::new(x, y, z), r);
    let spheres = vec![
        sphere(-0.774, 0.086, 0.331, 0.072),
        sphere(-0.887, 0.045, -0.631, 0.231),
        sphere(-0.195, -0.869, -0.455, 0.003),
    ];
    let mesh = MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).expect("a slab");
    let far = Vector::new(-2.6e38, -2.12e38, 5.6e37);
    let rotation = Rotation::from_xyzw(0.886, 0.418, -0.1885, 0.0686).normalize();
    let pose = Pose::from_parts(far, rotation);
    assert!(pose.is_finite() && !pose.inverse().is_finite());
    for other in [
        SharedShape::capsule_y(0.0, 0.28),
        SharedShape::cone(0.81, 1.43),
        SharedShape::round_cone(0.81, 1.43, 0.1),
        SharedShape::cuboid(0.3, 0.2, 0.1),
    ] {
        let _ = dispatcher.distance(&pose, &mesh, &*other);
        let _ = dispatcher.contact(&pose, &mesh, &*other, 1.0);
        let _ = dispatcher.intersection_test(&pose, &mesh, &*other);
    }
}

/// A pose that is no number leaves nothing near: a debug assertion of parry, with a capsule of no length.
#[test]
fn poses_that_are_no_numbers_leave_nothing_near() {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let ball = MedialSphere::new(Vector::ZERO, 0.3);
    let mesh = MedialMesh::new(vec![ball], vec![], vec![]).expect("a sphere");
    let capsule = SharedShape::capsule_y(0.0, 0.28);
    for x in [f32::NAN, f32::INFINITY] {
        let pose = Pose::translation(x, 0.0, 0.0);
        let distance = dispatcher.distance(&pose, &mesh, &*capsule);
        assert_eq!(distance.map(|d| d.distance).ok(), Some(f32::MAX));
        let contact = dispatcher.contact(&pose, &mesh, &*capsule, 1.0);
        assert!(contact.is_ok_and(|c| c.is_none()));
        let meets = dispatcher.intersection_test(&pose, &mesh, &*capsule);
        assert!(meets.is_ok_and(|m| !m.intersecting));
    }
}

/// Spheres whose centre and radius are finite, but not their boxes, bounding spheres or lengths: meshes of
/// them could be saved and not loaded. By one rule all are refused, however they come, or served.
#[test]
fn accepted_files_are_saved_and_loaded() {
    let sphere = |x, r| MedialSphere::new(Vector::new(x, -0.2, 0.2), r);
    let far = [
        (f32::MAX, 1.0e38),
        (-3.0e38, 1.0e38),
        (1.0e20, 1.0),
        (1.0, 2.0e18),
    ];
    for (x, r) in far {
        let pair = vec![sphere(-1.0, 1.0), sphere(x, r)];
        let refused = MedialMesh::new(pair, vec![[0, 1]], vec![]).expect_err("too far");
        let named = MeshError::TooFar {
            index: 1,
            center: [x, -0.2, 0.2],
            radius: r,
            most: 1.0e18,
        };
        assert_eq!(refused.to_string(), named.to_string());
        let text = format!("2 1 0\nv -1 -0.2 0.2 1\nv {x} -0.2 0.2 {r}\ne 0 1\n");
        let refused = MedialMesh::read_ma(text.as_bytes(), "far".as_ref()).expect_err("too far");
        assert_eq!(refused.to_string(), named.to_string());
        let near = MedialMesh::new(
            vec![sphere(-1.0, 1.0), sphere(2.0, 1.0)],
            vec![[0, 1]],
            vec![],
        );
        let mut bytes = near.expect("a cone").to_bytes();
        // The second sphere follows a header of 128 bytes and one sphere of 16.
        bytes[144..148].copy_from_slice(&x.to_le_bytes());
        bytes[156..160].copy_from_slice(&r.to_le_bytes());
        crate::asset::seal(&mut bytes);
        let refused = MedialMesh::from_bytes(&bytes).expect_err("too far");
        let AssetError::Mesh(refused) = refused else {
            panic!("{refused}");
        };
        assert_eq!(refused.to_string(), named.to_string());
    }
    for size in [
        1.0e-45f32, 1.0e-38, 1.0e-20, 1.0e-6, 1.0e6, 1.0e9, 1.0e13, 4.9e17,
    ] {
        let corner = |x: f32, y: f32, z: f32, r: f32| {
            MedialSphere::new(Vector::new(x, y, z) * size, r * size)
        };
        let spheres = vec![
            corner(-1.0, -1.0, -1.0, 1.0),
            corner(1.0, 1.0, 1.0, 1.0),
            corner(-1.0, 1.0, 0.5, 0.1),
            corner(1.0, -1.0, 1.0, 0.0),
        ];
        let mesh = MedialMesh::new(spheres, vec![[2, 3]], vec![[0, 1, 2]]).expect("served");
        let baked = mesh.to_bytes();
        let again = MedialMesh::from_bytes(&baked).expect("loaded");
        assert_eq!(again.to_bytes(), baked, "{size}");
        let mut text = Vec::new();
        mesh.write_ma(&mut text).expect("written");
        let again = MedialMesh::read_ma(&text[..], "again".as_ref()).expect("read");
        assert_eq!(again.spheres(), mesh.spheres(), "{size}");
    }
}

/// parry's capsule panics at such points where the square of its length is zero; a cone of equal radii
/// was given to it as one.
#[test]
fn points_that_are_no_numbers_are_projected_on_short_cones() {
    let ball = |x| MedialSphere::new(Vector::new(x, 0.0, 0.0), 0.3);
    let mesh = MedialMesh::new(vec![ball(0.0), ball(1.0e-30)], vec![[0, 1]], vec![]);
    let mesh = mesh.expect("a cone");
    for x in [f32::NAN, f32::INFINITY, f32::MAX] {
        for solid in [false, true] {
            mesh.project_local_point(Vector::splat(x), solid);
        }
    }
    let near = mesh.project_local_point(Vector::X, true);
    assert!((near.point.x - 0.3).abs() < 1.0e-6, "{near:?}");
}

/// Two bytes set to zero, three apart, cancelled in the checksum of a baked mesh: of a change in the
/// highest byte of a word so few bits were brought down that one byte of the next word undid them.
#[test]
fn two_damaged_bytes_never_cancel() {
    let baked = MedialMesh::ball(0.7).expect("a ball").to_bytes();
    let mut unseen = 0;
    for at in [39, 79] {
        for first in 1..=255 {
            for second in 1..=255 {
                let mut bytes = baked.clone();
                bytes[at] ^= first;
                bytes[at + 3] ^= second;
                let refused = MedialMesh::from_bytes(&bytes);
                unseen += u32::from(!matches!(refused, Err(AssetError::Damaged { .. })));
            }
        }
    }
    assert_eq!(unseen, 0, "of 130,050");
}
