//! Triangle mesh in, medial mesh out, with a progress bar and a line on the result.

use super::mesh::Mesh;
use super::progress::bar;
use rapier3d_medial::{BuildReport, Progress, prelude::*};
use std::ops::ControlFlow;

/// Builds a medial mesh of so many primitives. `name` goes on the progress bar.
pub fn build(name: &'static str, mesh: &Mesh, primitives: usize) -> Result<MedialMesh, String> {
    let (medial, report) = build_with_report(name, mesh, primitives)?;
    let error = report
        .hausdorff
        .surface_to_envelope
        .max(report.hausdorff.envelope_to_surface);
    println!(
        "{name}: {} triangles, {} primitives, {:.2} % off at most, {:.1} s",
        mesh.indices.len(),
        report.primitives,
        100.0 * error / report.longest_side,
        report
            .seconds
            .iter()
            .map(|(_, seconds)| seconds)
            .sum::<f64>(),
    );
    Ok(medial)
}

/// The same, without the line, but with all that the builder says.
pub fn build_with_report(
    name: &'static str,
    mesh: &Mesh,
    primitives: usize,
) -> Result<(MedialMesh, BuildReport), String> {
    let options = BuildOptions {
        primitives: Some(primitives),
        ..Default::default()
    };
    let bar = bar(name, 100);
    let mut show = |progress: Progress| {
        bar.set_position((100.0 * progress.fraction) as u64);
        ControlFlow::Continue(())
    };
    let built =
        MedialMesh::from_trimesh_with_progress(&mesh.vertices, &mesh.indices, &options, &mut show);
    bar.finish();
    built.map_err(|e| format!("cannot {name}: {e}"))
}
