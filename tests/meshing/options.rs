//! Determinism, units, progress, limits, mass.

use crate::build;
use crate::meshes::*;
use parry3d::math::Vector;
use rapier3d_medial::{BuildError, BuildOptions, MedialMesh, Progress, Quality};
use std::ops::ControlFlow;

fn ring() -> Mesh {
    torus(0.5, 0.12, 30, 12)
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let mesh = ring();
    let (a, report_a) = build(&mesh, 60, true);
    let (b, report_b) = build(&mesh, 60, true);
    let bits = |m: &MedialMesh| -> Vec<[u32; 4]> {
        let of = |s: &rapier3d_medial::MedialSphere| {
            [s.center.x, s.center.y, s.center.z, s.radius].map(f32::to_bits)
        };
        m.spheres().iter().map(of).collect()
    };
    assert_eq!(bits(&a), bits(&b));
    assert_eq!((a.edges(), a.faces()), (b.edges(), b.faces()));
    assert_eq!(report_a.hausdorff, report_b.hausdorff);
}

#[test]
fn units_and_places_do_not_matter() {
    let (reference, report) = build(&ring(), 27, true);
    let error = |r: &rapier3d_medial::BuildReport| r.hausdorff.surface_to_envelope / r.longest_side;
    for (scale, shift) in [(1e-3, 0.0), (1e-3, 3.0), (0.7, 0.0), (1.0, 3.0), (1e5, 3.0)] {
        let shift = Vector::new(shift, -shift, 0.5 * shift) * scale;
        let (moved, moved_report) = build(&ring().map(|v| v * scale + shift), 27, true);
        assert_eq!(moved.primitive_count(), reference.primitive_count());
        // Rounding of the input may send the collapse another way; the error stays alike.
        let ratio = error(&moved_report) / error(&report);
        assert!(
            (0.5..2.0).contains(&ratio),
            "scale {scale} shift {shift}: {ratio}"
        );
        let center = moved.mass_properties(1.0).local_com;
        assert!(
            (center - shift).length() < 1e-4 * scale,
            "{center} for {shift}"
        );
    }
}

/// Of a plate of a ten-thousandth too, whose mass single precision knows to a thousandth.
#[test]
fn mass_is_that_of_the_source() {
    for [x, y, z] in [[1.0, 0.7, 0.4f32], [1.0, 0.7, 1.0e-4], [0.9, 1.0e-3, 0.6]] {
        let mesh = cuboid(Vector::new(x, y, z));
        let (medial, _) = build(&mesh, 3, true);
        let mass = medial.mass_properties(2.0);
        let expected = 2.0 * x * y * z;
        let off = (mass.mass() / expected - 1.0).abs();
        assert!(off < 1e-6, "{} of {expected}", mass.mass());
        assert!((mass.local_com - 0.5 * Vector::new(x, y, z)).length() < 1e-6);
        // Inertia of a box: m (b² + c²) / 12 about each axis.
        let about = |b: f32, c: f32| expected * (b * b + c * c) / 12.0;
        let mut expected = [about(y, z), about(x, z), about(x, y)];
        let inertia = mass.principal_inertia();
        let mut found = [inertia.x, inertia.y, inertia.z];
        expected.sort_by(f32::total_cmp);
        found.sort_by(f32::total_cmp);
        for (e, f) in expected.iter().zip(found) {
            assert!((e - f).abs() < 1e-5 * e, "{expected:?} {found:?}");
        }
    }
}

#[test]
fn progress_runs_from_nothing_to_all() {
    let mesh = ring();
    let mut seen: Vec<Progress> = Vec::new();
    let mut options = BuildOptions::default();
    options.primitives = Some(30);
    let built =
        MedialMesh::from_trimesh_with_progress(&mesh.vertices, &mesh.indices, &options, &mut |p| {
            seen.push(p);
            ControlFlow::Continue(())
        });
    let (_, report) = built.expect("built");
    assert!(seen.windows(2).all(|w| w[0].fraction <= w[1].fraction));
    assert!(seen[0].fraction < 0.01);
    assert_eq!(seen.last().map(|p| p.fraction), Some(1.0));
    for (stage, seconds) in &report.seconds {
        assert!(
            *seconds >= 0.0 && seen.iter().any(|p| p.stage == *stage),
            "{stage}"
        );
    }
    assert!(report.seconds.len() >= 6, "{:?}", report.seconds);
    // At the least the ten thousand samples that it starts from, and eight Delaunay cells for each.
    assert!(report.memory > 10_000 * 8 * 32, "{}", report.memory);
    assert!(report.memory < 64 << 20, "{}", report.memory);
}

/// In units of work, for clocks depend on what else runs: stages report often, and after a break
/// nothing is called again, in whichever stage it came and however far that was.
#[test]
fn a_break_ends_the_build_at_the_next_call() {
    let mesh = torus(0.5, 0.12, 24, 8);
    let mut options = BuildOptions::default();
    // Few primitives have large errors, which are soon measured.
    options.primitives = Some(8);
    let mut stages: Vec<&'static str> = Vec::new();
    let mut listen = |p: Progress| {
        stages.push(p.stage);
        ControlFlow::Continue(())
    };
    let whole = MedialMesh::from_trimesh_with_progress(
        &mesh.vertices,
        &mesh.indices,
        &options,
        &mut listen,
    );
    assert!(whole.is_ok());
    let calls_in = |stage| stages.iter().filter(|s| **s == stage).count();
    // Of these each call is a few hundred look-ups of at most 15 µs.
    for (long, least) in [
        ("simplify", 50),
        ("refit", 50),
        ("insert", 10),
        ("measure", 50),
    ] {
        assert!(
            calls_in(long) >= least,
            "{} calls in {long}",
            calls_in(long)
        );
    }
    let mut tried = std::collections::BTreeSet::new();
    for (first, &stage) in stages.iter().enumerate() {
        if !tried.insert(stage) {
            continue;
        }
        for stop in [first, first + calls_in(stage) / 8] {
            let mut calls = 0;
            let mut break_off = |_| {
                calls += 1;
                match calls <= stop {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            };
            let built = MedialMesh::from_trimesh_with_progress(
                &mesh.vertices,
                &mesh.indices,
                &options,
                &mut break_off,
            );
            let at = stages[stop];
            assert_eq!(calls, stop + 1, "called again after the break in {at}");
            let cancelled = |e| matches!(e, BuildError::Cancelled { stage } if stage == at);
            assert!(built.is_err_and(cancelled), "in {at}");
        }
    }
    assert_eq!(tried.len(), 12, "{tried:?}");
}

#[test]
fn max_error_takes_as_few_primitives_as_it_allows() {
    let mesh = ring();
    let mut counts = Vec::new();
    for limit in [0.1, 0.02] {
        let mut options = BuildOptions::default();
        options.primitives = None;
        options.max_error = Some(limit);
        let (medial, report) =
            MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("built");
        let h = report.hausdorff;
        let error = h.surface_to_envelope.max(h.envelope_to_surface) / report.longest_side;
        assert!(error <= limit, "{error} for {limit}");
        assert!(report.target_reached);
        assert!(
            report.notes.iter().any(|n| n.contains("max_error")),
            "{:?}",
            report.notes
        );
        counts.push(medial.primitive_count());
    }
    assert!(counts[0] < counts[1] && counts[1] < 60, "{counts:?}");
}

#[test]
fn the_limit_that_binds_is_named() {
    let mesh = ring();
    let limited = |primitives, max_error| {
        let mut options = BuildOptions::default();
        options.quality = Quality::Fast;
        options.primitives = Some(primitives);
        options.max_error = Some(max_error);
        let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
        let (medial, report) = built.expect("built");
        let reached = report.target_reached;
        (medial.primitive_count(), reached, report.notes.join("; "))
    };
    let (count, reached, notes) = limited(10, 0.001);
    assert!(
        count <= 10 && !reached && notes.contains("primitives 10 bound first"),
        "{count} {notes}"
    );
    let (count, reached, notes) = limited(200, 0.1);
    assert!(
        count < 100 && reached && notes.contains("max_error 0.1 is kept by"),
        "{count} {notes}"
    );
}
