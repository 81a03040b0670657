//! The certificate, by points of every source triangle against every primitive.

use crate::meshes::*;
use crate::{build, solid_distance};
use parry3d::math::Vector;
use rapier3d_medial::MedialMesh;

#[test]
fn every_source_point_is_covered() {
    let ring = torus(0.5, 0.12, 30, 12);
    let far = torus(0.5, 0.12, 30, 12).map(|v| v * 10.0 + Vector::new(300.0, 0.0, 0.0));
    let cases = [
        ("ring", ring, 20),
        ("ring far away", far, 20),
        ("L", l_shape(), 40),
        ("box", cuboid(Vector::new(1.0, 0.7, 0.4)), 9),
        ("capsule", capsule(0.3, 0.2, 16, 6), 3),
        ("card", cuboid(Vector::new(1.0, 0.6, 0.02)), 30),
    ];
    for (name, mesh, primitives) in cases {
        let (medial, report) = build(&mesh, primitives, true);
        let side = mesh.longest_side();
        let magnitude = mesh
            .vertices
            .iter()
            .map(|v| v.abs().max_element())
            .fold(0.0, f32::max);
        // `signed_distance` rounds its result, and the samples are rounded to `f32`.
        let rounding = 4.0 * f32::EPSILON * (magnitude + side);
        let mut sticking_out = 0.0f32;
        for p in mesh.dense_points(0.01 * side) {
            sticking_out = sticking_out.max(solid_distance(&medial, p));
        }
        assert!(
            sticking_out <= rounding,
            "{name}: {sticking_out}, allowed {rounding}"
        );
        assert!(report.hausdorff.uncovered <= rounding, "{name}: {report:?}");
        let before = report
            .hausdorff_before_enclosure
            .expect("enclosure was asked for");
        assert!(
            before.uncovered > 100.0 * rounding || before.error() < 1e-6 * side,
            "{name}: nothing to enclose: {before:?}"
        );
    }
}

/// Triangles that are a segment or a point are part of the surface: they are covered, and without
/// enclosure the report tells how far they stick out. Planted distances from the box, by hand.
#[test]
fn segments_and_points_of_triangles_are_covered_and_measured() {
    let side = Vector::new(1.0, 0.7, 0.4);
    let above = side + Vector::new(0.0, 0.0, 1.07);
    let beside = Vector::new(2.0, 0.35, 0.2);
    let cases: [(&str, Vec<Vector>, [u32; 3], f32); 4] = [
        ("segment", vec![above], [6, 8, 8], 1.07),
        ("segment twice", vec![above, above], [8, 6, 9], 1.07),
        ("point", vec![beside], [8, 8, 8], 1.0),
        ("needle", vec![beside, beside * 2.0 - side], [6, 8, 9], 2.0),
    ];
    for (name, added, triangle, sticks_out) in cases {
        let mut mesh = cuboid(side);
        assert_eq!(
            mesh.vertices[6], side,
            "{name}: the corner that segments start from"
        );
        mesh.vertices.extend(added);
        mesh.indices.push(triangle);
        let (open, report) = build(&mesh, 9, false);
        // The medial mesh of a box is rounder than the box, by less than a tenth of it.
        let missed = |medial: &MedialMesh| {
            let points = mesh.dense_points(0.01).into_iter();
            points.fold(0.0f32, |most, p| most.max(solid_distance(medial, p)))
        };
        let uncovered = report.hausdorff.uncovered;
        assert!((uncovered - sticks_out).abs() < 0.1, "{name}: {report:?}");
        let found = missed(&open);
        assert!(
            (uncovered - found).abs() < 1e-3,
            "{name}: {found}, {report:?}"
        );
        let (closed, report) = build(&mesh, 9, true);
        let rounding = 16.0 * f32::EPSILON;
        assert!(missed(&closed) <= rounding, "{name}: {}", missed(&closed));
        assert!(report.hausdorff.uncovered <= rounding, "{name}: {report:?}");
    }
}

#[test]
fn without_enclosure_nothing_grows() {
    let mesh = torus(0.5, 0.12, 30, 12);
    let (open, report) = build(&mesh, 20, false);
    let (closed, _) = build(&mesh, 20, true);
    assert_eq!(report.hausdorff_before_enclosure, None);
    assert!(report.hausdorff.uncovered > 0.0);
    for (a, b) in open.spheres().iter().zip(closed.spheres()) {
        assert!(a.radius <= b.radius && a.center == b.center, "{a:?} {b:?}");
    }
}
