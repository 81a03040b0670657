//! The medial mesh has the topology of its solid: as many parts, holes and cavities.

use crate::build;
use crate::meshes::*;
use parry3d::math::Vector;
use rapier3d_medial::{BuildOptions, MedialMesh};

/// A ring needs three primitives; one is one all the same.
#[test]
fn the_count_is_kept_before_the_hole() {
    let mesh = torus(0.5, 0.12, 24, 8);
    let options = BuildOptions {
        primitives: Some(1),
        enclose: false,
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    let (medial, report) = built.expect("a ring builds");
    assert_eq!(medial.primitive_count(), 1);
    let given_up = |n: &String| n.contains("given up");
    assert!(report.notes.iter().any(given_up), "{:?}", report.notes);
}

#[test]
fn the_euler_number_is_that_of_the_solid() {
    let ball = |radius: f32| capsule(0.0, radius, 24, 8);
    let ring = || torus(0.5, 0.12, 40, 12);
    // A ring through the first one: two parts with a hole each.
    let second = ring()
        .map(|v| Vector::new(v.x + 0.5, v.z, v.y))
        .inside_out();
    let cases = [
        // Collapses alone leave six voids here.
        ("ring", torus(0.5, 0.12, 48, 16), 500, 0),
        ("ball", ball(0.5), 300, 1),
        ("linked rings", ring().and(second), 200, 0),
        ("hollow ball", ball(0.5).and(ball(0.3).inside_out()), 200, 2),
        (
            "two balls",
            ball(0.3).and(ball(0.3).map(|v| v + Vector::X)),
            100,
            2,
        ),
    ];
    for (name, mesh, primitives, euler) in cases {
        let (_, report) = build(&mesh, primitives, false);
        assert_eq!(report.euler, euler, "{name} at {primitives}");
    }
}
