//! The measured distance on pairs whose distance is known.

use crate::meshes::*;
use parry3d::math::Vector;
use rapier3d_medial::meshing::hausdorff::hausdorff;
use rapier3d_medial::{MedialMesh, MedialSphere};

fn ball(center: Vector, radius: f32) -> MedialMesh {
    MedialMesh::new(vec![MedialSphere::new(center, radius)], vec![], vec![]).expect("a ball")
}

/// A fine sphere mesh of radius 1; its sagitta is below 0.6 % of the radius.
fn sphere() -> Mesh {
    capsule(0.0, 1.0, 48, 16)
}

const SAGITTA: f32 = 0.006;

#[test]
fn concentric_balls_are_as_far_as_their_radii_differ() {
    let mesh = sphere();
    for radius in [0.5, 0.9, 1.0, 1.1, 1.5] {
        let h = hausdorff(&ball(Vector::ZERO, radius), &mesh.vertices, &mesh.indices)
            .expect("measured");
        let gap = (1.0 - radius).abs();
        assert!(
            (h.surface_to_envelope - gap).abs() < SAGITTA,
            "{radius}: {h:?}"
        );
        assert!(
            (h.envelope_to_surface - gap).abs() < SAGITTA,
            "{radius}: {h:?}"
        );
        assert!(
            (h.uncovered - (1.0 - radius).max(0.0)).abs() < SAGITTA,
            "{radius}: {h:?}"
        );
    }
}

#[test]
fn a_shifted_ball_is_as_far_as_its_shift() {
    let mesh = sphere();
    for shift in [0.03, 0.2, 0.7] {
        let moved = ball(Vector::new(shift, 0.0, 0.0), 1.0);
        let h = hausdorff(&moved, &mesh.vertices, &mesh.indices).expect("measured");
        // Reached at the poles along x, which are vertices.
        for d in [h.surface_to_envelope, h.envelope_to_surface, h.uncovered] {
            assert!((d - shift).abs() < SAGITTA, "{shift}: {h:?}");
        }
    }
}

#[test]
fn a_far_ball_shows_on_its_own_side_only() {
    // A ball outside, beside one that matches: the surface has a boundary near everywhere, the far
    // ball's boundary has no surface near.
    let mesh = sphere();
    let spheres = vec![
        MedialSphere::new(Vector::ZERO, 1.0),
        MedialSphere::new(Vector::new(4.0, 0.0, 0.0), 0.25),
    ];
    let pair = MedialMesh::new(spheres, vec![], vec![]).expect("two balls");
    let h = hausdorff(&pair, &mesh.vertices, &mesh.indices).expect("measured");
    assert!(h.surface_to_envelope < SAGITTA, "{h:?}");
    // The search ends when it is certain to within a fiftieth.
    assert!((h.envelope_to_surface - 3.25).abs() < 0.02 * 3.25, "{h:?}");
}

#[test]
fn a_bridged_gap_is_measured_to_the_nearest_boundary() {
    // Two plates 0.4 apart, and one slab that fills the gap as well: the inner faces lie inside,
    // 0.3 below the slab's surface at ±0.5, and the nearest boundary is that surface.
    let plate = |z: f32| cuboid(Vector::new(4.0, 4.0, 0.3)).map(|v| v + Vector::new(-2.0, -2.0, z));
    let mesh = plate(0.2).and(plate(-0.5));
    let corner = |x, y| MedialSphere::new(Vector::new(x, y, 0.0), 0.5);
    let spheres = vec![
        corner(-2.0, -2.0),
        corner(2.0, -2.0),
        corner(2.0, 2.0),
        corner(-2.0, 2.0),
    ];
    let filled = MedialMesh::new(spheres, vec![], vec![[0, 1, 2], [0, 2, 3]]).expect("slabs");
    let h = hausdorff(&filled, &mesh.vertices, &mesh.indices).expect("measured");
    assert!((h.surface_to_envelope - 0.3).abs() < 0.3 * 0.06, "{h:?}");
    assert_eq!(h.uncovered, 0.0);
}

#[test]
fn overlapping_primitives_hide_their_inner_surfaces() {
    // A ball of one hundred nearly equal balls is one ball to measure.
    let mesh = sphere();
    let spheres: Vec<_> = (0..100)
        .map(|i| {
            MedialSphere::new(
                Vector::new(0.0, 0.0, 1e-4 * i as f32),
                0.9 - 1e-4 * i as f32,
            )
        })
        .chain([MedialSphere::new(Vector::ZERO, 1.0)])
        .collect();
    let many = MedialMesh::new(spheres, vec![], vec![]).expect("balls");
    let h = hausdorff(&many, &mesh.vertices, &mesh.indices).expect("measured");
    assert!(h.envelope_to_surface < SAGITTA, "{h:?}");
}
