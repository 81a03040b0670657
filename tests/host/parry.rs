//! What parry 0.31 computes that this crate corrects, or asks in another way (docs/host.md). Each test is of parry's
//! own dispatcher and asserts a wrong answer: one that fails after an upgrade says that a correction may go. Of medial
//! meshes this dispatcher sees the convex parts.

use super::random::Random;
use parry3d::math::{IVector, Pose, Real, Rotation, Vector};
use parry3d::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, PointQuery, TrackedContact,
};
use parry3d::shape::{
    Capsule, Cuboid, PackedFeatureId, RoundCuboid, Shape, SharedShape, TriMesh, Triangle, Voxels,
};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::panic::catch_unwind;

type Manifold = ContactManifold<(), u32>;

/// parry's manifolds of two shapes.
fn manifolds(pose: &Pose, shapes: [&dyn Shape; 2], prediction: Real) -> Vec<Manifold> {
    let mut manifolds = Vec::new();
    let [a, b] = shapes;
    DefaultQueryDispatcher
        .contact_manifolds(pose, a, b, prediction, &mut manifolds, &mut None)
        .expect("known");
    manifolds
}

/// The deepest contact: distance, and normal out of the first shape.
fn deepest(manifolds: &[Manifold]) -> Option<(Real, Vector)> {
    let contacts = manifolds
        .iter()
        .flat_map(|m| m.points.iter().map(move |p| (p.dist, m.local_n1)));
    contacts.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// A medial mesh of slabs.
fn slabs(spheres: &[([Real; 3], Real)], edges: &[[u32; 2]], faces: &[[u32; 3]]) -> MedialMesh {
    let spheres = spheres
        .iter()
        .map(|(center, radius)| MedialSphere::new(Vector::from_array(*center), *radius))
        .collect();
    MedialMesh::new(spheres, edges.to_vec(), faces.to_vec()).expect("slabs")
}

/// One slab between three spheres.
fn slab(spheres: [([Real; 3], Real); 3]) -> MedialMesh {
    slabs(&spheres, &[[0, 1], [1, 2], [0, 2]], &[[0, 1, 2]])
}

/// Of 60 cuboids that are planted 1 % of `unit` deep in a plate of two slabs, how many have no contact, or a deepest
/// one that is aslant or as much as .1 % off.
fn wrong_on_slabs(unit: Real) -> usize {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let ground = slabs(
        &corners.map(|[x, z]| ([x, -0.1, z].map(|x| x * unit), 0.1 * unit)),
        &[[0, 1], [1, 2], [2, 3], [0, 3], [0, 2]],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let cuboid = Cuboid::new(Vector::new(0.2, 0.15, 0.25) * unit);
    let is_wrong = |k: &u8| {
        let t = Real::from(*k);
        let at = Vector::new(0.7 * t.sin(), 0.14, 0.7 * t.cos()) * unit;
        let pose = Pose::from_parts(at, Rotation::from_rotation_y(t));
        let found = deepest(&manifolds(&pose, [&ground, &cuboid], 0.02 * unit));
        found.is_none_or(|(dist, n)| (dist / unit + 0.01).abs() > 0.001 || n.y < 0.999)
    };
    (0..60).filter(is_wrong).count()
}

#[test]
fn contacts_of_small_shapes_are_wrong() {
    assert_eq!([1.0, 0.1].map(wrong_on_slabs), [0, 0]);
    let wrong = wrong_on_slabs(0.01);
    assert!(wrong > 30, "{wrong} of 60");
}

/// The gap of a cone and a triangle: of a ball that runs along the cone's axis, at 401 places.
fn gap(triangle: &Triangle, [a, b]: [MedialSphere; 2]) -> Real {
    let at = |k: u16| {
        let t = Real::from(k) / 400.0;
        let distance = triangle.distance_to_local_point(a.center.lerp(b.center, t), true);
        distance - a.radius - (b.radius - a.radius) * t
    };
    (0..=400).map(at).fold(Real::MAX, Real::min)
}

#[test]
fn contacts_of_cones_with_triangles_of_their_size_are_too_deep_now_and_then() {
    let mut random = Random(7);
    let mut too_deep = 0;
    for _ in 0..20_000 {
        let corners = [(); 3].map(|()| random.direction() * random.within(0.02, 0.2));
        let Ok(ground) = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]) else {
            continue;
        };
        let radii = [random.within(0.01, 0.1), random.within(0.01, 0.1)];
        let from = random.direction() * random.within(0.0, 0.2);
        let to = from + random.direction() * random.within(0.01, 0.2);
        let spheres = [
            MedialSphere::new(from, radii[0]),
            MedialSphere::new(to, radii[1]),
        ];
        let Ok(cone) = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]) else {
            continue;
        };
        let gap = gap(&ground.triangle(0), spheres);
        let found = deepest(&manifolds(&Pose::IDENTITY, [&ground, &cone], 0.02));
        too_deep += usize::from(found.is_some_and(|(d, _)| d < 2.0 * gap.min(0.0) - 0.001));
    }
    assert!(too_deep > 0, "none is too deep");
}

/// The deepest contact's distance cannot be more than the gap along its normal.
#[test]
fn normals_of_sharp_edges_that_just_touch_a_face_are_noise_now_and_then() {
    let edge = [([-0.2, -0.08, -0.12], 0.0), ([0.2, -0.08, -0.12], 0.0)];
    let slab = slab([edge[0], edge[1], ([-0.12, 0.0, -0.04], 0.08)]);
    let ground = Cuboid::new(Vector::new(0.2, 0.5, 0.1));
    let mut random = Random(9);
    let mut wrong = 0;
    for _ in 0..20_000 {
        let [x, z] = [(); 2].map(|()| random.within(-0.3, 0.3));
        let at = Vector::new(x, 0.58 + random.within(-1.0e-3, 1.0e-3), z);
        let tilt = Rotation::from_scaled_axis(random.direction() * random.within(0.0, 1.0e-3));
        let turn = Rotation::from_rotation_y(random.within(0.0, 6.3));
        let pose = Pose::from_parts(at, tilt * turn);
        let found = deepest(&manifolds(&pose, [&ground, &slab], 0.02));
        wrong += usize::from(found.is_some_and(|(dist, n)| {
            let lowest = slab.spheres().iter();
            let lowest = lowest.map(|s| n.dot(pose * s.center) - s.radius);
            let highest = n.abs().dot(ground.half_extents);
            lowest.fold(Real::MAX, Real::min) - highest < dist - 1.0e-4
        }));
    }
    assert!(wrong > 0, "all are right");
}

/// A level floor of voxels with its top at height 0.
fn voxels() -> Voxels {
    let cells = (-8..8).flat_map(|x| (-8..8).map(move |z| IVector::new(x, -1, z)));
    Voxels::new(Vector::splat(0.25), &cells.collect::<Vec<_>>())
}

#[test]
fn thin_slabs_that_just_stand_on_voxels_have_no_contacts_or_contacts_aslant_now_and_then() {
    let slab = slab([
        ([-0.2, -0.08, 0.0], 0.0),
        ([0.2, -0.08, 0.0], 0.0),
        ([0.0, 0.1, 0.0], 0.0),
    ]);
    let ground = voxels();
    let mut random = Random(9);
    let mut wrong = 0;
    for _ in 0..20_000 {
        let [x, z] = [(); 2].map(|()| random.within(-0.9, 0.9));
        let at = Vector::new(x, 0.08 - random.within(1.0e-5, 1.0e-3), z);
        let tilt = Rotation::from_scaled_axis(random.direction() * 1.0e-5);
        let pose = Pose::from_parts(
            at,
            tilt * Rotation::from_rotation_y(random.within(0.0, 6.3)),
        );
        let found = deepest(&manifolds(&pose, [&ground, &slab], 0.02));
        wrong += usize::from(found.is_none_or(|(_, n)| n.y < 0.9));
    }
    assert!(wrong > 0, "all are right");
}

#[test]
fn composite_shapes_have_no_contacts_with_voxels_before_they_touch() {
    let cuboid = SharedShape::cuboid(0.2, 0.3, 0.2);
    let compound = SharedShape::compound(vec![(Pose::IDENTITY, cuboid.clone())]);
    let pose = Pose::translation(0.0, 0.31, 0.0);
    let found =
        [cuboid, compound].map(|s| deepest(&manifolds(&pose, [&voxels(), &*s], 0.1)).is_some());
    assert_eq!(found, [true, false]);
}

/// parry matches contacts by features, which several contacts of an edge or a face share.
#[test]
fn contacts_of_one_feature_all_get_the_impulse_of_one_of_them() {
    let feature = PackedFeatureId::face(0);
    let contact = |x: Real, impulse| TrackedContact {
        data: impulse,
        ..TrackedContact::new(Vector::X * x, Vector::X * x, feature, feature, 0.0)
    };
    let mut now = Manifold::new();
    now.points.extend([contact(0.0, 0), contact(1.0, 0)]);
    now.match_contacts(&[contact(0.0, 3), contact(1.0, 5)]);
    let impulses: Vec<u32> = now.points.iter().map(|p| p.data).collect();
    assert_eq!(impulses, [5, 5]);
}

#[test]
fn workspaces_panic_once_their_list_was_emptied() {
    let panics = catch_unwind(|| {
        let ball = SharedShape::ball(0.3);
        let compound = SharedShape::compound(vec![(Pose::IDENTITY, ball.clone())]);
        let (mut list, mut workspace) = (Vec::<Manifold>::new(), None);
        for _ in 0..2 {
            list.clear();
            let pose = Pose::translation(0.0, 0.5, 0.0);
            let _ = DefaultQueryDispatcher.contact_manifolds(
                &pose,
                &*compound,
                &*ball,
                0.02,
                &mut list,
                &mut workspace,
            );
        }
    });
    assert!(panics.is_err());
}

#[test]
fn capsules_without_length_panic_at_points_that_are_no_numbers() {
    let panics = catch_unwind(|| {
        let capsule = Capsule::new(Vector::ZERO, Vector::ZERO, 0.1);
        capsule.contains_local_point(Vector::splat(Real::NAN))
    });
    assert!(panics.is_err());
}

#[test]
fn small_rounded_cuboids_hold_points_outside_of_them() {
    let holds = |unit: Real| {
        let body = RoundCuboid {
            inner_shape: Cuboid::new(Vector::splat(unit)),
            border_radius: 0.5 * unit,
        };
        body.contains_local_point(Vector::X * 1.6 * unit)
    };
    assert_eq!([0.1, 0.01].map(holds), [false, true]);
}
