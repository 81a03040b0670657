//! Triangle mesh in, medial mesh out, with a progress bar and a line on the result.

use super::mesh::{Mesh, capsule};
use super::progress::bar;
use super::scene::Model;
use super::skeleton::{Bone, Skeleton};
use rapier3d::prelude::{Real, Vector};
use rapier3d_medial::{BuildReport, Progress, prelude::*};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Builds a medial mesh of so many primitives. `name` goes on the progress bar.
pub fn build(name: &'static str, mesh: &Mesh, primitives: usize) -> Result<MedialMesh, String> {
    Ok(told(name, mesh, build_with_report(name, mesh, primitives)?))
}

/// The same by the plain collapse, for comparisons at equal counts: it takes fewer where they fit better
/// less often than the default does.
pub fn build_as_many(
    name: &'static str,
    mesh: &Mesh,
    primitives: usize,
) -> Result<MedialMesh, String> {
    let quality = Quality::Fast;
    let built = build_with_options(name, mesh, primitives, quality)?;
    Ok(told(name, mesh, built))
}

/// Prints a line on the result.
fn told(name: &str, mesh: &Mesh, (medial, report): (MedialMesh, BuildReport)) -> MedialMesh {
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
    medial
}

/// Builds a body of a mesh made in code and of the inner lines that it was made round.
pub fn model(
    name: &'static str,
    (mesh, lines): (Mesh, Skeleton),
    primitives: usize,
) -> Result<Arc<Model>, String> {
    mesh.check_closed()?;
    let medial = build(name, &mesh, primitives)?;
    Ok(Model::new(mesh, lines, medial))
}

/// A capsule along y, which needs no builder: half the length of its axis, its radius, sides of its mesh.
pub fn capsule_model(half: Real, radius: Real, around: u32) -> Result<Arc<Model>, String> {
    let ends = [Vector::Y * half, Vector::NEG_Y * half];
    let radii = [radius; 2];
    let medial = MedialMesh::capsule(ends[0], ends[1], radius).map_err(|e| e.to_string())?;
    let mesh = capsule(half, radius, around);
    mesh.check_closed()?;
    let lines = Skeleton::new(vec![Bone { ends, radii }]);
    Ok(Model::new(mesh, lines, medial))
}

/// A medial mesh, without the line, but with all that the builder says.
pub fn build_with_report(
    name: &'static str,
    mesh: &Mesh,
    primitives: usize,
) -> Result<(MedialMesh, BuildReport), String> {
    build_with_options(name, mesh, primitives, Quality::default())
}

fn build_with_options(
    name: &'static str,
    mesh: &Mesh,
    primitives: usize,
    quality: Quality,
) -> Result<(MedialMesh, BuildReport), String> {
    let options = BuildOptions {
        primitives: Some(primitives),
        quality,
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

/// Prints what the builder measured, found and took.
pub fn print(mesh: &Mesh, report: &BuildReport) {
    let share = |error: Real| format!("{:.2} %", 100.0 * error / report.longest_side);
    let error = &report.hausdorff;
    println!(
        "{} triangles, {} primitives",
        mesh.indices.len(),
        report.primitives
    );
    println!("of the longest side, at most:");
    println!(
        "  mesh to medial mesh  {}",
        share(error.surface_to_envelope)
    );
    println!(
        "  medial mesh to mesh  {}",
        share(error.envelope_to_surface)
    );
    println!("  mesh sticks out by   {}", share(error.uncovered));
    println!("{:#?}", report.findings);
    report
        .notes
        .iter()
        .for_each(|note| println!("note: {note}"));
    for (stage, seconds) in &report.seconds {
        println!("{stage:24} {seconds:7.3} s");
    }
}
