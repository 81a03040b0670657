//! An error instead of a count: the fewest primitives that keep it, and errors by count.

use crate::meshes::*;
use parry3d::math::Vector;
use rapier3d_medial::meshing::{ErrorAt, error_curve};
use rapier3d_medial::{BuildError, BuildOptions, BuildReport, MedialMesh, Progress, Quality};
use std::ops::ControlFlow;

fn built(mesh: &Mesh, options: &BuildOptions) -> (usize, f32, BuildReport) {
    let (medial, report) =
        MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, options).expect("built");
    let error = report.hausdorff.error() / report.longest_side;
    (medial.primitive_count(), error, report)
}

fn within(max_error: f32, quality: Quality) -> BuildOptions {
    BuildOptions {
        primitives: None,
        max_error: Some(max_error),
        quality,
        ..Default::default()
    }
}

/// The count that keeps an error, which the report says it does.
fn smallest(mesh: &Mesh, max_error: f32, quality: Quality) -> usize {
    let (count, error, report) = built(mesh, &within(max_error, quality));
    assert!(error <= max_error, "{error} for {max_error}");
    assert!(report.target_reached, "{:?}", report.notes);
    count
}

#[test]
fn planted_bodies_get_as_many_primitives_as_they_are_made_of() {
    // Its facets are off by 0.2 (1 − cos 5.6°), .14 % of its length.
    let one_cone = capsule(0.3, 0.2, 32, 12);
    assert_eq!(smallest(&one_cone, 0.015, Quality::Balanced), 1);
    let one_ball = capsule(0.0, 0.5, 32, 12);
    assert_eq!(smallest(&one_ball, 0.02, Quality::Balanced), 1);
    let three = (0..3).fold(capsule(0.0, 0.2, 16, 6), |all, k| {
        all.and(capsule(0.0, 0.2, 16, 6).map(|v| v + Vector::X * (0.7 * (k + 1) as f32)))
    });
    assert_eq!(smallest(&three, 0.02, Quality::Fast), 4);
}

/// The medial axis of a cube is twelve triangles from its middle to its edges.
#[test]
fn a_cube_is_exact_at_twelve_and_rounder_below() {
    let cube = cuboid(Vector::ONE);
    let (count, error, report) = built(&cube, &within(0.002, Quality::Balanced));
    assert!(count == 12 && error < 1e-6, "{count} {error}");
    assert!(report.target_reached);
    // A ball through the corners is off by half of √3 − 1.
    let loose = smallest(&cube, 0.4, Quality::Balanced);
    assert_eq!(loose, 1);
}

/// Each smaller count, built for itself, breaks the limit.
#[test]
fn no_smaller_count_keeps_it() {
    let ring = torus(0.5, 0.12, 30, 12);
    for (limit, quality, below) in [(0.05, Quality::Fast, 5), (0.05, Quality::Balanced, 2)] {
        let count = smallest(&ring, limit, quality);
        for fewer in count.saturating_sub(below).max(1)..count {
            let options = BuildOptions {
                primitives: Some(fewer),
                quality,
                ..Default::default()
            };
            let (_, error, _) = built(&ring, &options);
            assert!(
                error > limit,
                "{fewer} primitives have error {error}, {count} were taken for {limit}"
            );
        }
    }
}

#[test]
fn a_closer_limit_takes_no_fewer() {
    let mesh = l_shape();
    let limits = [0.12, 0.08, 0.05, 0.035];
    let counts = limits.map(|limit| smallest(&mesh, limit, Quality::Fast));
    assert!(counts.is_sorted(), "{counts:?}");
    assert!(counts[0] < counts[3], "{counts:?}");
}

#[test]
fn error_out_of_reach_returns_the_best_mesh() {
    let ring = torus(0.5, 0.12, 16, 8);
    let mut options = within(1e-6, Quality::Fast);
    let (count, error, report) = built(&ring, &options);
    assert!(!report.target_reached && error > 1e-6);
    let told = report.notes.iter().find(|n| n.contains("out of reach"));
    let told = told.expect("a note");
    assert!(
        told.contains(&format!("{error:.6}")) && told.contains(&format!("with {count} primitives")),
        "{told}"
    );
    for primitives in [10, 27] {
        let fixed = BuildOptions {
            primitives: Some(primitives),
            quality: Quality::Fast,
            ..Default::default()
        };
        let (_, other, _) = built(&ring, &fixed);
        assert!(
            error <= other * 1.02,
            "{primitives} primitives: {other}, not {error}"
        );
    }
    options.primitives = Some(9);
    let (count, _, report) = built(&ring, &options);
    let bound = |n: &String| n.contains("primitives 9 bound first");
    assert!(count <= 9 && !report.target_reached && report.notes.iter().any(bound));
}

#[test]
fn progress_goes_on_while_counts_are_tried() {
    let ring = torus(0.5, 0.12, 20, 8);
    let mut seen: Vec<f32> = Vec::new();
    let mut listen = |p: Progress| {
        seen.push(p.fraction);
        ControlFlow::Continue(())
    };
    let options = within(0.05, Quality::Balanced);
    MedialMesh::from_trimesh_with_progress(&ring.vertices, &ring.indices, &options, &mut listen)
        .expect("built");
    assert!(seen.is_sorted());
    assert_eq!(seen.last(), Some(&1.0));
    let jumps = seen[..seen.len() - 1].windows(2).map(|w| w[1] - w[0]);
    assert!(jumps.fold(0.0, f32::max) < 0.25);
    let late: std::collections::BTreeSet<u32> = seen.iter().map(|f| (f * 1e3) as u32).collect();
    assert!(late.range(500..1000).count() > 10, "{late:?}");
}

fn curve(mesh: &Mesh, counts: &[usize], quality: Quality) -> Result<Vec<ErrorAt>, BuildError> {
    let options = BuildOptions {
        quality,
        ..Default::default()
    };
    let mut proceed = |_: Progress| ControlFlow::Continue(());
    let (points, side) = error_curve(
        &mesh.vertices,
        &mesh.indices,
        counts,
        &options,
        &mut proceed,
    )?;
    assert!(side > 0.0);
    Ok(points)
}

/// One construction for all counts, and a build for each: the same errors.
#[test]
fn a_curve_tells_what_builds_give() {
    let ring = torus(0.5, 0.12, 30, 12);
    let counts = [27, 5, 10, 10, 50];
    let points = curve(&ring, &counts, Quality::Fast).expect("a curve");
    let asked: Vec<usize> = points.iter().map(|p| p.asked).collect();
    assert_eq!(asked, [5, 10, 27, 50]);
    let errors = points.iter().map(|p| p.hausdorff.error());
    assert!(errors.is_sorted_by(|a, b| a >= b), "{points:?}");
    for point in points {
        let options = BuildOptions {
            primitives: Some(point.asked),
            quality: Quality::Fast,
            ..Default::default()
        };
        let (_, _, report) = built(&ring, &options);
        let (told, own) = (point.hausdorff.error(), report.hausdorff.error());
        // A build tries round counts below, too, the curve those that it was asked for.
        assert!(
            (told / own - 1.0).abs() < 0.05,
            "{} primitives: {told}, built {own}",
            point.asked
        );
        assert!(point.primitives <= point.asked);
    }
}

#[test]
fn a_curve_of_a_cube_ends_at_nothing() {
    let points = curve(&cuboid(Vector::ONE), &[4, 12, 30], Quality::Fast).expect("a curve");
    let errors: Vec<f32> = points.iter().map(|p| p.hausdorff.error()).collect();
    assert!(
        errors[0] > 0.05 && errors[1] < 1e-6 && errors[2] < 1e-6,
        "{errors:?}"
    );
    assert_eq!(points[2].primitives, 12);
}

#[test]
fn counts_of_nothing_are_refused() {
    let refused = curve(&cuboid(Vector::ONE), &[10, 0], Quality::Fast);
    let named = |e: BuildError| e.to_string().contains("`primitives`");
    assert!(refused.is_err_and(named));
    let none = curve(&cuboid(Vector::ONE), &[], Quality::Fast);
    assert!(none.is_ok_and(|points| points.is_empty()));
}
