//! Shapes whose medial mesh or whose distance is known.

use crate::meshes::*;
use crate::{build, solid_distance};
use parry3d::math::Vector;
use rapier3d_medial::MedialMesh;

const BIG: f32 = 0.5;
const SMALL: f32 = 0.12;

/// Largest distance by which the solid's boundary leaves the true ring, by bisection on a grid: a
/// point farther from the true ring than `error` must be on the same side of the solid's boundary.
fn error_against_ring(medial: &MedialMesh) -> f32 {
    let mut error = 0.0f32;
    let n = 60;
    for i in 0..n * n * n {
        let unit = |k: i32| (k % n) as f32 / (n - 1) as f32 * 2.0 - 1.0;
        let p = Vector::new(0.75 * unit(i), 0.75 * unit(i / n), 0.25 * unit(i / (n * n)));
        let truth = torus_distance(p, BIG, SMALL);
        if (truth < 0.0) != (solid_distance(medial, p) < 0.0) {
            error = error.max(truth.abs());
        }
    }
    error
}

#[test]
fn a_ring_becomes_a_closed_chain_of_cones() {
    let mesh = torus(BIG, SMALL, 40, 15);
    let (medial, report) = build(&mesh, 27, false);
    assert!(medial.faces().is_empty(), "{} slabs", medial.faces().len());
    assert_eq!((medial.spheres().len(), medial.edges().len()), (27, 27));
    let mut degree = vec![0; 27];
    medial
        .edges()
        .iter()
        .flatten()
        .for_each(|&v| degree[v as usize] += 1);
    assert!(degree.iter().all(|d| *d == 2), "{degree:?}");
    assert!(
        solid_distance(&medial, Vector::ZERO) > 0.3,
        "the hole is gone"
    );
    let error = error_against_ring(&medial) / report.longest_side;
    assert!(error < 0.02, "{error}");
    // The grid has gaps, so it may only find less than the report.
    let reported = report
        .hausdorff
        .surface_to_envelope
        .max(report.hausdorff.envelope_to_surface);
    // The mesh itself is off the true ring by its sagitta: SMALL (1 − cos 12°) and
    // (BIG + SMALL)(1 − cos 4.5°).
    let sagitta = SMALL * 0.022 + (BIG + SMALL) * 0.0031;
    assert!(
        error * report.longest_side <= reported * 1.25 + sagitta,
        "{error} {reported}"
    );
}

#[test]
fn a_ring_keeps_its_hole_at_every_count_that_allows_one() {
    let mesh = torus(BIG, SMALL, 40, 15);
    for primitives in [3, 5, 12, 80] {
        let (medial, report) = build(&mesh, primitives, false);
        assert!(medial.primitive_count() <= primitives);
        let euler = medial.spheres().len() as i64 - medial.edges().len() as i64
            + medial.faces().len() as i64;
        assert_eq!(euler, 0, "{primitives}: a ring has Euler number 0");
        assert!(
            !report.notes.iter().any(|n| n.contains("given up")),
            "{:?}",
            report.notes
        );
    }
    let (_, report) = build(&mesh, 1, false);
    assert!(
        report.notes.iter().any(|n| n.contains("given up")),
        "{:?}",
        report.notes
    );
}

#[test]
fn a_hollow_ball_keeps_its_cavity() {
    let shell = capsule(0.0, 0.5, 24, 10).and(capsule(0.0, 0.3, 24, 10).inside_out());
    let (medial, report) = build(&shell, 200, false);
    assert!(
        solid_distance(&medial, Vector::ZERO) > 0.2,
        "the cavity is filled"
    );
    // Volume of the shell, less what the facets cut off.
    let volume = 4.0 / 3.0 * std::f32::consts::PI * (0.125 - 0.027);
    let mass = medial.mass_properties(1.0).mass();
    assert!(
        (mass / volume - 1.0).abs() < 0.05,
        "{mass} {volume} {:?}",
        report.notes
    );
}

#[test]
fn a_capsule_needs_one_cone() {
    let (medial, report) = build(&capsule(0.3, 0.2, 32, 12), 1, false);
    assert_eq!(medial.primitive_count(), 1);
    let [a, b] = [0, 1].map(|i| medial.spheres()[i]);
    // The facets' sagitta, 0.2 (1 − cos 5.6°), and what the collapse adds at the ends.
    let error = report
        .hausdorff
        .surface_to_envelope
        .max(report.hausdorff.envelope_to_surface);
    assert!(error < 0.01, "{error} {a:?} {b:?}");
    assert!(
        (a.radius - 0.2).abs() < 0.005 && (b.radius - 0.2).abs() < 0.005,
        "{a:?} {b:?}"
    );
}

#[test]
fn a_ball_stays_one() {
    let (medial, report) = build(&capsule(0.0, 0.5, 32, 12), 1, false);
    assert_eq!(medial.primitive_count(), 1);
    assert!(report.hausdorff.surface_to_envelope < 0.01, "{report:?}");
    let center = medial.spheres()[0].center;
    assert!(center.length() < 0.01, "{center}");
}

#[test]
fn boxes_and_corners_get_closer_with_more_primitives() {
    for (name, mesh, wanted) in [
        (
            "box",
            cuboid(Vector::new(1.0, 0.7, 0.4)),
            [0.16, 0.06, 0.03],
        ),
        ("L", l_shape(), [0.14, 0.08, 0.03]),
    ] {
        for (primitives, wanted) in [5, 100, 500].into_iter().zip(wanted) {
            let (medial, report) = build(&mesh, primitives, false);
            assert!(medial.primitive_count() <= primitives);
            let h = report.hausdorff;
            let error = h.surface_to_envelope.max(h.envelope_to_surface);
            assert!(error < wanted, "{name} at {primitives}: {error}");
        }
    }
    // The notch of the L is outside.
    let (medial, _) = build(&l_shape(), 100, true);
    assert!(solid_distance(&medial, Vector::new(0.7, 0.7, 0.15)) > 0.25);
}

#[test]
fn separate_parts_stay_separate() {
    let part = |x: f32| capsule(0.0, 0.2, 16, 6).map(move |v| v + Vector::new(x, 0.0, 0.0));
    let (medial, report) = build(&part(0.0).and(part(1.0)), 2, false);
    assert_eq!(medial.primitive_count(), 2);
    assert!(
        solid_distance(&medial, Vector::new(0.5, 0.0, 0.0)) > 0.25,
        "{:?}",
        report.notes
    );
    for x in [0.0, 1.0] {
        assert!(solid_distance(&medial, Vector::new(x, 0.0, 0.0)) < -0.15);
    }
}
