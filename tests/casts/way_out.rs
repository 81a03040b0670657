//! What a shape cast tells of bodies that are in each other at the start: the shortest way out, a normal and
//! points.

use parry3d::math::{Pose, Vector};
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher};
use parry3d::shape::{ConvexPolyhedron, Shape, SharedShape};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

/// What starts inside is told the shortest way out: a normal, and a point on each body that far apart.
/// Planted: a ball and a rod in bodies whose nearest face is known.
#[test]
fn casts_from_inside_tell_the_shortest_way_out() {
    const R: f32 = 0.1;
    let v = Vector::new;
    let box_corners: Vec<Vector> = (0..8)
        .map(|i: u32| {
            let side = |bit: u32, h: f32| if i >> bit & 1 == 1 { h } else { -h };
            v(side(0, 3.0), side(1, 2.0), side(2, 4.0))
        })
        .collect();
    let hull = || ConvexPolyhedron::from_convex_hull(&box_corners).expect("a hull");
    let ball = || MedialMesh::ball(R).expect("a ball");
    // Longer than the way to the side: the face at its end is nearer to one of its spheres.
    let rod = |half: f32| MedialMesh::capsule(v(-half, 0.0, 0.0), v(half, 0.0, 0.0), R);
    let slope = v(4.0, 2.0, 0.0) / 20.0_f32.sqrt();
    // Name, closed body, mesh, where it starts, the way out's direction and length.
    let cases = [
        (
            "cuboid",
            SharedShape::cuboid(3.0, 2.0, 4.0),
            ball(),
            v(0.5, 1.0, 0.5),
            Vector::Y,
            1.0 + R,
        ),
        (
            "cuboid",
            SharedShape::cuboid(3.0, 2.0, 4.0),
            ball(),
            v(0.5, -1.0, 0.5),
            -Vector::Y,
            1.0 + R,
        ),
        (
            "cuboid",
            SharedShape::cuboid(3.0, 2.0, 4.0),
            ball(),
            v(-2.9, 0.0, 0.5),
            -Vector::X,
            0.1 + R,
        ),
        (
            "cuboid, half out",
            SharedShape::cuboid(3.0, 2.0, 4.0),
            ball(),
            v(2.95, 0.0, 0.5),
            Vector::X,
            0.05 + R,
        ),
        (
            "cuboid, a rod",
            SharedShape::cuboid(3.0, 2.0, 4.0),
            rod(2.5).expect("a rod"),
            v(0.4, 0.5, 0.0),
            Vector::Y,
            1.5 + R,
        ),
        (
            "cuboid, a rod half out",
            SharedShape::cuboid(3.0, 2.0, 4.0),
            rod(0.5).expect("a rod"),
            v(3.2, 0.5, 0.0),
            Vector::X,
            0.3 + R,
        ),
        (
            "round cuboid",
            SharedShape::round_cuboid(2.8, 1.8, 3.8, 0.2),
            ball(),
            v(0.5, 1.0, 0.5),
            Vector::Y,
            1.0 + R,
        ),
        (
            "hull",
            SharedShape::new(hull()),
            ball(),
            v(0.5, 1.0, 0.5),
            Vector::Y,
            1.0 + R,
        ),
        (
            "round hull",
            SharedShape::round_convex_hull(&box_corners, 0.5).expect("a hull"),
            ball(),
            v(0.5, 0.5, 3.5),
            Vector::Z,
            1.0 + R,
        ),
        (
            "half-space",
            SharedShape::halfspace(Vector::Y),
            ball(),
            v(0.5, -7.0, 0.5),
            Vector::Y,
            7.0 + R,
        ),
        (
            "cylinder",
            SharedShape::cylinder(3.0, 2.0),
            ball(),
            v(0.0, 2.0, 0.0),
            Vector::Y,
            1.0 + R,
        ),
        (
            "cylinder",
            SharedShape::cylinder(3.0, 2.0),
            ball(),
            v(0.0, 0.0, -1.5),
            -Vector::Z,
            0.5 + R,
        ),
        (
            "round cylinder",
            SharedShape::round_cylinder(3.0, 2.0, 0.2),
            ball(),
            v(1.9, 0.5, 0.0),
            Vector::X,
            0.3 + R,
        ),
        (
            "cone",
            SharedShape::cone(2.0, 2.0),
            ball(),
            v(0.0, -1.9, 0.3),
            -Vector::Y,
            0.1 + R,
        ),
        (
            "cone",
            SharedShape::cone(2.0, 2.0),
            ball(),
            v(0.9, 0.0, 0.0),
            slope,
            0.2 / 5.0_f32.sqrt() + R,
        ),
        (
            "compound",
            SharedShape::compound(vec![
                (
                    Pose::translation(9.0, 0.0, 0.0),
                    SharedShape::cuboid(3.0, 2.0, 4.0),
                ),
                (Pose::translation(9.0, 0.0, 20.0), SharedShape::ball(1.0)),
            ]),
            ball(),
            v(9.5, 1.0, 0.5),
            Vector::Y,
            1.0 + R,
        ),
        (
            "voxels",
            SharedShape::voxels(v(1.0, 1.0, 1.0), &[parry3d::math::IVector::ZERO]),
            ball(),
            v(0.5, 0.8, 0.5),
            Vector::Y,
            0.2 + R,
        ),
        (
            "ball",
            SharedShape::ball(2.0),
            ball(),
            v(1.5, 0.0, 0.0),
            Vector::X,
            0.5 + R,
        ),
        (
            "capsule",
            SharedShape::capsule_y(2.0, 1.0),
            ball(),
            v(0.5, 0.3, 0.0),
            Vector::X,
            0.5 + R,
        ),
    ];
    let dispatcher = MedialDispatcher::default();
    let turned = Pose::from_parts(
        v(0.3, -0.7, 2.0),
        parry3d::math::Rotation::from_rotation_z(0.5),
    );
    let mut failures = Vec::new();
    for (name, body, mesh, at, out, depth) in &cases {
        for place in [Pose::IDENTITY, turned] {
            let still = NonlinearRigidMotion::constant_position(place);
            let moves = NonlinearRigidMotion {
                linvel: Vector::X,
                ..NonlinearRigidMotion::constant_position(place * Pose::from_translation(*at))
            };
            for flipped in [false, true] {
                let (g1, g2): (&dyn Shape, _) = (mesh, body.as_ref());
                let hit = if flipped {
                    dispatcher
                        .cast_shapes_nonlinear(&still, g2, &moves, g1, 0.0, 1.0, true)
                        .map(|h| h.map(|h| h.swapped()))
                } else {
                    dispatcher.cast_shapes_nonlinear(&moves, g1, &still, g2, 0.0, 1.0, true)
                };
                let hit = hit.expect("swept").expect("a hit");
                // All in the closed body's frame, which is also turned as the mesh is.
                let (n, w1, w2) = (hit.normal1, hit.witness1 + *at, hit.witness2);
                let gap = (w2 - w1).dot(n);
                let sound = hit.time_of_impact == 0.0
                    && (n + *out).length() < 1.0e-4
                    && (hit.normal2 - *out).length() < 1.0e-4
                    && (gap + depth).abs() < 1.0e-4
                    && (w2 - w1).cross(n).length() < 1.0e-4;
                if !sound {
                    failures.push(format!("{name}: {gap} instead of {depth}, {out}: {hit:?}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Medial surfaces that cross at the start, or lie in each other, have no nearest spheres to take the
/// normal from: it is that of the smallest depth. Planted.
#[test]
fn shapes_that_cross_at_the_start_have_a_normal() {
    const R: f32 = 0.1;
    let v = Vector::new;
    let corners = [v(-3.0, -2.0, 0.0), v(3.0, -2.0, 0.0), v(0.0, 4.0, 0.0)];
    let plate = |radius: f32| {
        let spheres = corners.map(|c| MedialSphere::new(c, radius)).to_vec();
        MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).expect("a slab")
    };
    let rod = |from: f32, to: f32| {
        MedialMesh::capsule(v(0.1, 0.2, from), v(0.1, 0.2, to), R).expect("a rod")
    };
    let [a, b, c] = corners;
    let ball = || MedialMesh::ball(R).expect("a ball");
    // Name, mesh, other, the least depth, and the normal if there is but one.
    let cases = [
        (
            "slab",
            rod(-0.2, 0.6),
            SharedShape::new(plate(0.05)),
            0.2 + R + 0.05,
            Some(-Vector::Z),
        ),
        (
            "slab",
            rod(-0.5, 0.3),
            SharedShape::new(plate(0.05)),
            0.3 + R + 0.05,
            Some(Vector::Z),
        ),
        (
            "triangle",
            rod(-0.2, 0.6),
            SharedShape::triangle(a, b, c),
            0.2 + R,
            Some(-Vector::Z),
        ),
        (
            "trimesh",
            rod(-0.2, 0.6),
            SharedShape::trimesh(corners.to_vec(), vec![[0, 1, 2]]).expect("a mesh"),
            0.2 + R,
            Some(-Vector::Z),
        ),
        (
            "on its axis",
            rod(-0.5, 0.5),
            SharedShape::new(rod(-0.7, 0.7)),
            2.0 * R,
            None,
        ),
        (
            "in its centre",
            ball(),
            SharedShape::new(ball()),
            2.0 * R,
            None,
        ),
        (
            "in a ball's centre",
            ball(),
            SharedShape::ball(0.3),
            0.3 + R,
            None,
        ),
        (
            "on a capsule's axis",
            ball(),
            SharedShape::capsule_y(1.0, 0.3),
            0.3 + R,
            None,
        ),
    ];
    let mut failures = Vec::new();
    for (name, mesh, other, depth, normal) in &cases {
        let still = NonlinearRigidMotion::identity();
        let hit = MedialDispatcher::default()
            .cast_shapes_nonlinear(&still, mesh, &still, other.as_ref(), 0.0, 1.0, true)
            .expect("swept")
            .expect("a hit");
        let n = hit.normal1;
        let gap = (hit.witness2 - hit.witness1).dot(n);
        let sound = hit.time_of_impact == 0.0
            && (n.length() - 1.0).abs() < 1.0e-4
            && normal.is_none_or(|m| (n - m).length() < 1.0e-4)
            && (gap + depth).abs() < 1.0e-4;
        if !sound {
            failures.push(format!(
                "{name}: {gap} instead of {depth}, {normal:?}: {hit:?}"
            ));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}
