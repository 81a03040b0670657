//! Large meshes. What takes seconds is run by hand:
//! `cargo test --release --test meshing scale -- --ignored --nocapture --test-threads 1`.

use crate::meshes::*;
use rapier3d_medial::Quality;
use rapier3d_medial::{BuildOptions, MedialMesh};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A ring with waves on it, of `2 · around · across` triangles.
fn wavy_ring(around: u32, across: u32) -> Mesh {
    torus(0.5, 0.15, around, across).map(|v| {
        let angle = v.y.atan2(v.x);
        v * (1.0 + 0.05 * (9.0 * angle).sin() + 0.02 * (31.0 * v.z).sin())
    })
}

/// Largest resident set of the process so far in MB, where the system tells.
fn peak_megabytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1024)
}

fn by_hand(around: u32, across: u32, open: bool) {
    let mut mesh = wavy_ring(around, across);
    if open {
        let keep = mesh.indices.len() * 2 / 3;
        mesh.indices.truncate(keep);
    }
    println!(
        "{} triangles, open: {open}, before: {:?} MB",
        mesh.indices.len(),
        peak_megabytes()
    );
    let start = Instant::now();
    let (mut last, mut longest) = (Instant::now(), (Duration::ZERO, "", 0.0));
    let mut gaps = std::collections::BTreeMap::<&str, Duration>::new();
    let mut before = ("", 0.0);
    let built = MedialMesh::from_trimesh_with_progress(
        &mesh.vertices,
        &mesh.indices,
        &BuildOptions {
            quality: Quality::Fast,
            ..Default::default()
        },
        &mut |p| {
            let gap = last.elapsed();
            let of_stage = gaps.entry(before.0).or_default();
            *of_stage = gap.max(*of_stage);
            if gap > longest.0 {
                longest = (gap, before.0, before.1);
            }
            before = (p.stage, p.fraction);
            last = Instant::now();
            ControlFlow::Continue(())
        },
    );
    let (medial, report) = built.expect("built");
    let h = report.hausdorff;
    println!(
        "{:.2} s, peak {:?} MB, {} primitives, error {:.5}, longest gap {longest:?}\n{:?}\n{gaps:?}\n{:?}",
        start.elapsed().as_secs_f64(),
        peak_megabytes(),
        medial.primitive_count(),
        h.surface_to_envelope.max(h.envelope_to_surface) / report.longest_side,
        report.seconds,
        report.notes,
    );
}

/// In units of work, not of time: the stage that reads the whole mesh reports at least once for each
/// 1,500 triangles, however many there are. (Its loops, about twenty, report at each 16,384th item.)
#[test]
fn cleaning_up_reports_in_proportion_to_its_work() {
    for (around, across) in [(128, 64), (512, 128)] {
        let mesh = wavy_ring(around, across);
        let mut calls = 0;
        let built = MedialMesh::from_trimesh_with_progress(
            &mesh.vertices,
            &mesh.indices,
            &BuildOptions {
                quality: Quality::Fast,
                ..Default::default()
            },
            &mut |p| {
                calls += usize::from(p.stage == "surface");
                match p.stage {
                    "surface" => ControlFlow::Continue(()),
                    _ => ControlFlow::Break(()),
                }
            },
        );
        assert!(built.is_err_and(|e| e.to_string().contains("cancelled")));
        let triangles = mesh.indices.len();
        assert!(1500 * calls >= triangles, "{calls} calls for {triangles}");
    }
}

#[test]
#[ignore = "seconds in release, minutes in debug: prints time and memory for docs/measurements/medial-mesh-error.md"]
fn a_hundred_thousand_triangles() {
    by_hand(400, 125, false);
}

#[test]
#[ignore = "seconds in release, minutes in debug: prints time and memory for docs/measurements/medial-mesh-error.md"]
fn a_million_triangles() {
    by_hand(1000, 500, false);
}

#[test]
#[ignore = "seconds in release, minutes in debug: prints time and memory for docs/measurements/medial-mesh-error.md"]
fn a_million_triangles_of_an_open_surface() {
    by_hand(1000, 750, true);
}
