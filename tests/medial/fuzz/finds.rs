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

/// A sphere whose centre and radius are finite, but not its end: its box was not finite.
#[test]
fn spheres_that_end_beyond_all_numbers_are_refused() {
    let sphere = |x, r| MedialSphere::new(Vector::new(x, -0.2, 0.2), r);
    for sphere in [sphere(f32::MAX, 1.0e38), sphere(-3.0e38, 1.0e38)] {
        let refused = MedialMesh::new(vec![sphere], vec![], vec![]);
        assert!(matches!(
            refused,
            Err(MeshError::NotFinite { index: 0, .. })
        ));
    }
    assert!(MedialMesh::new(vec![sphere(1.0e38, 1.0e38)], vec![], vec![]).is_ok());
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
