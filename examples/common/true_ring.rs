//! A ring as a medial mesh and as parry's convex decomposition, both against the true ring.

use crate::common::mesh::ring;
use rapier3d::parry::transformation::vhacd::VHACDParameters;
use rapier3d::prelude::{Real, SharedShape, Vector};
use rapier3d_medial::{BuildOptions, MedialMesh, Quality};
use std::f32::consts::TAU;
use std::fmt::Write as _;
use std::time::Instant;

/// Radii of the ring's centre line and tube, in metres.
const BIG: Real = 0.5;
const SMALL: Real = 0.12;
/// Primitives of the medial meshes.
const PRIMITIVES: usize = 27;
/// Lines across the true surface, around and across the tube.
const LINES: [u32; 2] = [144, 32];
/// Steps along a line, and their length in units of the longest side.
const STEPS: u32 = 500;
const STEP: Real = 2e-4;

/// The table, in Markdown.
pub fn table() -> Result<String, String> {
    let mesh = ring(BIG, SMALL, 48, 16);
    let mut text = format!(
        "\nRing of {} triangles against the true ring, without enclosure:\n\n\
        | | error | parts | seconds |\n|---|---|---|---|\n",
        mesh.indices.len()
    );
    let mut row = |name: &str, shape: SharedShape, parts: usize, seconds: f64| {
        let _ = writeln!(
            text,
            "| {name} | {} | {parts} | {seconds:.2} |",
            error(&shape)
        );
    };
    for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
        let options = BuildOptions {
            primitives: Some(PRIMITIVES),
            quality,
            enclose: false,
            ..Default::default()
        };
        let start = Instant::now();
        let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
        let (medial, report) = built.map_err(|e| e.to_string())?;
        let name = format!("medial mesh, `{quality:?}`");
        let seconds = start.elapsed().as_secs_f64();
        row(&name, SharedShape::new(medial), report.primitives, seconds);
    }
    let default = VHACDParameters::default();
    let finest = VHACDParameters {
        resolution: 128,
        concavity: 0.001,
        ..default
    };
    for (name, parameters) in [("VHACD, default", default), ("VHACD, 128 / 0.001", finest)] {
        let start = Instant::now();
        let shape = SharedShape::convex_decomposition_with_params(
            &mesh.vertices,
            &mesh.indices,
            &parameters,
        );
        let seconds = start.elapsed().as_secs_f64();
        let parts = shape.as_compound().map_or(1, |c| c.shapes().len());
        row(name, shape, parts, seconds);
    }
    Ok(text)
}

/// The largest distance from the true surface, along its normals and in units of the longest side, of
/// a point that is inside one and outside the other; `above` where that is as far as was looked.
fn error(shape: &SharedShape) -> String {
    let side = 2.0 * (BIG + SMALL);
    let mut worst = 0;
    for i in 0..LINES[0] * LINES[1] {
        let u = (i / LINES[1]) as Real / LINES[0] as Real * TAU;
        let v = (i % LINES[1]) as Real / LINES[1] as Real * TAU;
        let outward = Vector::new(v.cos() * u.cos(), v.sin(), v.cos() * u.sin());
        let at = Vector::new(BIG * u.cos(), 0.0, BIG * u.sin()) + outward * SMALL;
        let is_wrong = |step: u32| {
            let way = outward * (STEP * side * step as Real);
            shape.contains_local_point(at + way) || !shape.contains_local_point(at - way)
        };
        // Only what is worse than the worst so far is looked for, from the far end.
        worst = (worst + 1..=STEPS)
            .rev()
            .find(|k| is_wrong(*k))
            .unwrap_or(worst);
    }
    let error = STEP * worst as Real;
    match worst {
        STEPS => format!("above {error:.4}"),
        _ => format!("{error:.4}"),
    }
}
