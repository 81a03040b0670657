//! A torus of 1,536 triangles as a medial mesh and as parry's convex decomposition, both against
//! the true torus.

use super::mesh::ring;
use super::surface_error::spread_points;
use rapier3d::parry::shape::{Compound, Shape, SharedShape, TriMesh};
use rapier3d::parry::transformation::vhacd::VHACDParameters;
use rapier3d::prelude::{Pose, Real, Vector};
use rapier3d_medial::{BuildError, BuildOptions, MedialMesh, Quality};
use std::fmt::Write;
use std::time::Instant;

/// Radius of the centre circle.
const MAJOR: Real = 0.5;
/// Radius of the tube.
const MINOR: Real = 0.12;
/// Points at which an error is looked for, on each surface.
const POINTS: usize = 200_000;

/// The table in Markdown: largest error, number of convex parts, seconds of building.
pub fn torus_table() -> Result<String, BuildError> {
    let mut text = String::from("| | parts | largest error | seconds |\n|---|---|---|---|\n");
    let mut row = |name: &str, parts: usize, error: Real, seconds: f64| {
        let _ = writeln!(text, "| {name} | {parts} | {error:.4} | {seconds:.2} |");
    };
    let torus = ring(MAJOR, MINOR, 48, 16);
    for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
        let mut options = BuildOptions::default();
        options.primitives = Some(27);
        options.enclose = false;
        options.quality = quality;
        let start = Instant::now();
        let (mesh, report) = MedialMesh::from_trimesh(&torus.vertices, &torus.indices, &options)?;
        let seconds = start.elapsed().as_secs_f64();
        let (vertices, indices) = mesh.envelope(0.005);
        let boundary = TriMesh::new(vertices, indices).expect("a torus has a boundary");
        let exposed: Vec<_> = spread_points(&boundary, POINTS).collect();
        let name = format!("medial mesh, `{quality:?}`");
        row(&name, report.primitives, error(&mesh, &exposed), seconds);
    }
    let default = VHACDParameters::default();
    for (resolution, concavity) in [
        (default.resolution, default.concavity),
        (128, 0.001),
        (256, 0.0005),
    ] {
        let parameters = VHACDParameters {
            resolution,
            concavity,
            ..default
        };
        let start = Instant::now();
        let shape = SharedShape::convex_decomposition_with_params(
            &torus.vertices,
            &torus.indices,
            &parameters,
        );
        let seconds = start.elapsed().as_secs_f64();
        let compound = shape.as_shape::<Compound>().expect("a compound");
        let name = format!("VHACD, {resolution} / {concavity}");
        let parts = compound.shapes().len();
        row(
            &name,
            parts,
            error(compound, &exposed_points(compound)),
            seconds,
        );
    }
    Ok(text)
}

/// The larger of: how far the true torus sticks out of `shape`, and how far `exposed`, points on the
/// boundary of `shape`, are from the true torus.
fn error(shape: &dyn Shape, exposed: &[Vector]) -> Real {
    let torus = ring(MAJOR, MINOR, 960, 320).to_parry();
    let sticks_out = torus
        .vertices()
        .iter()
        .map(|&p| shape.distance_to_local_point(p, true));
    let off = exposed.iter().map(|&p| {
        let across = p.x.hypot(p.z) - MAJOR;
        (across.hypot(p.y) - MINOR).abs()
    });
    sticks_out.chain(off).fold(0.0, Real::max)
}

/// Points on the faces of a compound's convex parts that no other part covers.
fn exposed_points(compound: &Compound) -> Vec<Vector> {
    let parts = compound.shapes();
    let on_part = |number: usize| {
        let (pose, part) = &parts[number];
        let hull = part.as_convex_polyhedron().expect("a convex part");
        let (vertices, indices) = hull.to_trimesh();
        let surface = TriMesh::new(vertices, indices).expect("a part has faces");
        let points: Vec<_> = spread_points(&surface, POINTS / parts.len())
            .map(|p| *pose * p)
            .collect();
        points
    };
    let covered = |p: Vector, by: &(Pose, SharedShape)| by.1.contains_point(&by.0, p);
    (0..parts.len())
        .flat_map(|number| {
            let others = parts.iter().enumerate().filter(move |(k, _)| *k != number);
            on_part(number)
                .into_iter()
                .filter(move |&p| !others.clone().any(|(_, other)| covered(p, other)))
        })
        .collect()
}
