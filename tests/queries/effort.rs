//! How much two meshes of 1,236 primitives ask of the elementary tests: of 4.2 million, the few that can
//! come first. Counts, not times.

use crate::creature::{SCENES, SECONDS, combs, creature, motions};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d::parry::shape::Cuboid;
use rapier3d_medial::elementary::{ToiOptions, ToiStatus};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::pair::PrimitiveList;
use rapier3d_medial::pair::first_contact::first_contact_counted;
use rapier3d_medial::{MedialMesh, MedialSphere};

/// Most elementary tests of a query, in every scene.
const MOST: u64 = 200;

#[test]
fn whole_meshes_take_few_elementary_tests() {
    let mesh = creature();
    assert_eq!(mesh.primitive_count(), 1236);
    for scene in SCENES {
        let (mut hits, mut ran) = (0, 0);
        for (k, [m1, m2]) in motions(&scene, 200).iter().enumerate() {
            let options = ToiOptions::default();
            let (toi, counts) = first_contact_counted(&mesh, m1, &mesh, m2, SECONDS, &options);
            let name = scene.name;
            assert_ne!(toi.status, ToiStatus::Unresolved, "{name}, {k}: {toi:?}");
            assert!(counts.tests <= MOST, "{name}, {k}: {counts:?}");
            hits += u64::from(toi.status != ToiStatus::Separated);
            ran += counts.tests;
        }
        // The scenes are what their names say, and a contact is never found without a test.
        let (least, most) = match scene.name {
            "apart" => (0, 0),
            "approach" | "close" => (20, 80),
            _ => (200, 200),
        };
        assert!((least..=most).contains(&hits), "{}: {hits}", scene.name);
        assert!(scene.name == "overlapping at the start" || ran >= hits);
    }
}

#[test]
fn interleaved_combs_are_told_apart_by_directions() {
    let ([a, b], [m1, m2]) = combs();
    let options = ToiOptions::default();
    let (toi, counts) = first_contact_counted(&a, &m1, &b, &m2, SECONDS, &options);
    assert_eq!(toi.status, ToiStatus::Separated);
    assert!(counts.nodes > 10_000, "the teeth are between each other");
    assert!(counts.tests <= MOST, "{counts:?}");
}

/// A ring that touches a cuboid's faces: of 12 cones and 12 triangles those are tested that touch too, not
/// the far side of the ring.
#[test]
fn pairs_still_apart_at_the_first_contact_are_not_tested() {
    let around = |k: u32| {
        let angle = k as Real / 12.0 * std::f32::consts::TAU;
        MedialSphere::new(Vector::new(0.4 * angle.cos(), 0.4 * angle.sin(), 0.0), 0.08)
    };
    let edges = (0..12).map(|k| [k, (k + 1) % 12]).collect();
    let ring = MedialMesh::new((0..12).map(around).collect(), edges, vec![]).expect("a ring");
    let (points, triangles) = Cuboid::new(Vector::new(20.0, 0.5, 20.0)).to_trimesh();
    let mut cuboid = PrimitiveList::default();
    for triangle in triangles {
        cuboid.push(&triangle.map(|k| MedialSphere::new(points[k as usize], 0.0)));
    }
    let still = NonlinearRigidMotion::constant_position;
    let options = ToiOptions::default();
    for tilt in [0.0, 0.3, 1.0] {
        let lowest = |height: Real| {
            let turn = Vector::new(0.0, 0.0, 0.1) + Vector::new(tilt, 0.0, 0.0);
            let pose = Pose::new(Vector::new(0.3, height, 0.7), turn);
            let low = ring
                .spheres()
                .iter()
                .map(|s| (pose * s.center).y - s.radius);
            (pose, low.fold(Real::MAX, Real::min))
        };
        let (_, low) = lowest(0.0);
        // Half the tolerance above the upper face.
        let (pose, _) = lowest(0.5 - low + 0.5 * options.tolerance);
        let falling = NonlinearRigidMotion {
            linvel: Vector::new(0.0, -10.0, 3.0),
            ..still(pose)
        };
        let (toi, counts) = first_contact_counted(
            &ring,
            &falling,
            &cuboid,
            &still(Pose::IDENTITY),
            SECONDS,
            &options,
        );
        assert_eq!((toi.status, toi.upper), (ToiStatus::Contact, 0.0), "{tilt}");
        assert!(counts.tests <= 8, "{tilt}: {counts:?}");
    }
}

/// A die on the floor of a cup that swings round a pivot, as bodies in a drum or a bucket do: it goes along the chord
/// of the arc on which the floor goes, and turns with it. A direction that turns with the floor keeps them apart.
#[test]
fn what_turns_with_a_face_is_looked_at_a_few_times() {
    let [floor, die] = [[0.15, 0.006, 0.15], [0.02; 3]]
        .map(|half| MedialMesh::cuboid(Vector::from_array(half)).expect("a box"));
    let seconds = 1.0 / 60.0;
    for (spin, gap) in [
        (2.0, 1.0e-4),
        (5.0, 1.0e-4),
        (9.0, 1.0e-4),
        (9.0, 1.0e-3),
        (20.0, 1.0e-3),
    ] {
        let pivot = Vector::Y * 0.8;
        let omega = Vector::Z * spin;
        let swing = NonlinearRigidMotion::new(Pose::IDENTITY, pivot, Vector::ZERO, omega);
        let place = Pose::from_translation(Vector::new(0.05, 0.026 + gap, 0.03));
        let along = swing.position_at_time(seconds) * place;
        let speed = (along.translation - place.translation) / seconds;
        let carried = NonlinearRigidMotion::new(place, Vector::ZERO, speed, omega);
        let options = ToiOptions::default();
        let query = first_contact_counted(&floor, &swing, &die, &carried, seconds, &options);
        let (toi, counts) = query;
        assert_eq!(toi.status, ToiStatus::Separated, "{spin} rad/s: {toi:?}");
        assert!(counts.looks <= 6, "{spin} rad/s: {counts:?}");
    }
}
