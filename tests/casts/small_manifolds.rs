//! Contact manifolds of rapier's bodies of any size above a level medial floor, planted: none is deeper than the gap,
//! and the deepest one's normal is up.

use parry3d::math::{Pose, Real, Rotation, Vector};
use parry3d::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use parry3d::shape::SharedShape;
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

/// Six squares, each of two slabs .1 thick, with their top at height 0, times `unit`.
fn floor(unit: Real) -> MedialMesh {
    let id = |i: u32, j: u32| i * 3 + j;
    let spheres = (0..12u8).map(|k| {
        let [x, z] = [k / 3, k % 3].map(Real::from);
        let at = Vector::new(x - 1.5, -0.1, z - 1.0);
        MedialSphere::new(at * unit, 0.1 * unit)
    });
    let (mut edges, mut faces) = (Vec::new(), Vec::new());
    for [i, j] in [[0, 0], [0, 1], [1, 0], [1, 1], [2, 0], [2, 1]] {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        edges.extend([[a, b], [b, c], [c, d], [d, a], [a, c]].map(|[p, q]| [p.min(q), p.max(q)]));
        faces.extend([[a, b, c], [a, d, c]]);
    }
    edges.sort_unstable();
    edges.dedup();
    MedialMesh::new(spheres.collect(), edges, faces).expect("a floor")
}

/// Symptom: on slabs with edges of 16 mm contacts of capsules and boxes were up to 13 mm too deep, and many aslant.
/// Cause: parry's GJK algorithm takes triangles with edges below 3 cm for lines.
#[test]
fn contacts_of_bodies_of_any_size_are_up_and_as_deep_as_they_are() {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    for unit in [64.0, 1.0, 0.1, 0.03, 0.015, 0.001, 1.0e-5] {
        let floor = floor(unit);
        let lengths = |lengths: [Real; 3]| lengths.map(|x| x * unit);
        let ([a, b, c], [radius, half, side]) =
            (lengths([0.2, 0.15, 0.25]), lengths([0.15, 0.3, 0.2]));
        // Each with the height of its middle where it lies.
        let bodies: [(SharedShape, Real); 4] = [
            (SharedShape::cuboid(a, b, c), 0.15),
            (SharedShape::capsule_z(half, radius), 0.15),
            (SharedShape::cylinder(radius, side), 0.15),
            (SharedShape::cone(side, side), 0.2),
        ];
        for (body, height) in &bodies {
            for k in 0..40u8 {
                let t = Real::from(k);
                let gap = if k % 2 == 0 { 0.01 } else { -0.01 };
                let at = Vector::new((2.3 * t).sin(), height + gap, 0.6 * (1.1 * t).cos());
                let pose = Pose::from_parts(at * unit, Rotation::from_rotation_y(t));
                let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
                dispatcher
                    .contact_manifolds(
                        &pose,
                        &floor,
                        &**body,
                        0.02 * unit,
                        &mut manifolds,
                        &mut None,
                    )
                    .expect("known");
                let contacts = manifolds
                    .iter()
                    .flat_map(|m| m.points.iter().map(move |p| (m, p)));
                let deepest = contacts.min_by(|a, b| a.1.dist.total_cmp(&b.1.dist));
                let kind = body.shape_type();
                let Some((manifold, point)) = deepest else {
                    panic!("{kind:?} of {unit} m, {k}: no contact");
                };
                let (dist, up) = (point.dist / unit, manifold.local_n1.y);
                assert!(
                    (dist - gap).abs() < 0.001 && up > 0.999,
                    "{kind:?} of {unit} m, {k}: {dist} where the gap is {gap}, up {up}"
                );
            }
        }
    }
}
