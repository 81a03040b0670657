//! A body as rapier's colliders have it, side by side: the triangle mesh, its medial mesh (the spheres'
//! centres, and every primitive in a colour of its own), rapier's convex decomposition and its convex
//! hull, each with its largest error in percent of the longest side. Then a heap of each is dropped, and
//! its steps are timed.
//!
//! ```text
//! cargo run --release --example compare -- my.obj
//! cargo run --release --example compare
//! ```
//! Without a file it takes the creature of the other examples. Options: `--primitives N` (at most;
//! default 60), `--out DIR` (where the picture goes; default target/compare).
//!
//! Exits with 1 when the mesh cannot be built, or when the medial mesh is further from it than the hull.

mod common;

use common::arguments::{MeshOptions, example_with_mesh};
use common::build::build;
use common::creature::creature;
use common::light::{Facet, facets};
use common::mesh::Mesh;
use common::random::Random;
use common::render::{Camera, Image};
use common::scene::{Actor, Kind, Model, Scene};
use common::scene_strip::{View, rainbow};
use common::shape_error::shape_error;
use common::skeleton::Skeleton;
use common::strip::tile;
use common::surface_error::surface_error;
use common::surfaces::surface;
use common::table::Table;
use rapier3d::prelude::*;
use rapier3d_medial::{MedialMesh, MedialPrimitive, MedialSphere};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Longest side, in metres, that meshes are scaled to.
const SIZE: Real = 1.0;
/// Radius at which the medial axis is drawn, in metres.
const LINE: Real = 0.006;
/// Points on each surface at which errors are looked at.
const POINTS: usize = 20_000;
/// Bodies in the heap that is timed, and its steps.
const BODIES: usize = 12;
const STEPS: usize = 240;

fn main() -> ExitCode {
    example_with_mesh(60, "target/compare", compare)
}

fn compare(options: MeshOptions) -> Result<(), String> {
    let mesh = match &options.file {
        Some(file) => Mesh::read(file)?,
        None => creature().0,
    };
    let mesh = mesh.fitted(SIZE);
    let (medial, medial_seconds) = timed(|| build("medial mesh", &mesh, options.primitives));
    let medial = medial?;
    let (parts, parts_seconds) =
        timed(|| SharedShape::convex_decomposition(&mesh.vertices, &mesh.indices));
    let (hull, hull_seconds) = timed(|| SharedShape::convex_hull(&mesh.vertices));
    let hull = hull.ok_or("the mesh has no convex hull")?;

    let boundary = surface_error(&medial, &mesh, 0.005 * SIZE, POINTS);
    let boundary = boundary.ok_or("the medial mesh has no boundary")?;
    let errors = [
        f64::from(boundary.largest()),
        shape_error(&*parts, &mesh),
        shape_error(&*hull, &mesh),
    ]
    .map(|error| 100.0 * error / f64::from(SIZE));
    let hulls = parts.as_compound().map_or(1, |c| c.shapes().len());
    let off = errors.map(|error| format!("{error:.1} % OFF"));
    let slate = Vector::new(0.35, 0.37, 0.42);
    let pictures = [
        (
            colored(&mesh, slate),
            "TRIANGLE MESH".into(),
            format!("{} TRIANGLES", mesh.indices.len()),
        ),
        (
            axis(&medial)?,
            "ITS MEDIAL AXIS".into(),
            format!("{} SPHERES", medial.spheres().len()),
        ),
        (
            primitives(&medial)?,
            format!("MEDIAL MESH: {} PRIMITIVES", medial.primitive_count()),
            off[0].clone(),
        ),
        (
            pieces(&parts),
            format!("DECOMPOSITION: {hulls} HULLS"),
            off[1].clone(),
        ),
        (pieces(&hull), "CONVEX HULL".into(), off[2].clone()),
    ];
    let low = mesh.bounds().0.y;
    let drawn = pictures.map(|(seen, name, size)| picture(seen, low, [&name, &size]));
    let path = options.out.join("compare.png");
    tile(&[drawn.to_vec()]).save(&path)?;
    println!("{}\n", path.display());

    let skeleton = Skeleton::of_medial(&medial, 0.02 * SIZE);
    let scene = heap(&Model::new(mesh, skeleton, medial.clone()));
    let rows = [
        (Kind::Medial, medial.primitive_count(), medial_seconds),
        (Kind::Parts, hulls, parts_seconds),
        (Kind::Hulls, 1, hull_seconds),
    ];
    let mut table = Table::default();
    let heading = ["pieces", "% off", "made in s", "ms a step", "most"];
    table.row("colliders", heading);
    for ((kind, count, seconds), error) in rows.into_iter().zip(errors) {
        let [median, most] = milliseconds(&scene, kind);
        let figures = [error, seconds, median, most].map(|figure| format!("{figure:.2}"));
        let cells = [count.to_string()].into_iter().chain(figures);
        table.row(&kind.name().to_lowercase(), cells);
    }
    println!("{table}\nsteps: the median and the most of {STEPS}, {BODIES} bodies in a heap");
    match errors[0] < errors[2] {
        true => Ok(()),
        false => Err("the medial mesh is no better than the hull".into()),
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}

/// Bodies above each other, turned at random.
fn heap(model: &Arc<Model>) -> Scene {
    let mut random = Random(3);
    let actors = (0..BODIES).map(|k| {
        let turn = random.direction() * 3.0;
        let start = RigidBodyBuilder::dynamic()
            .translation(random.direction() * 0.3 + Vector::Y * (1.0 + 0.8 * k as Real))
            .rotation(turn);
        Actor::new(model, start, Vector::ONE)
    });
    Scene::new(actors.collect())
}

/// The median and the largest of the milliseconds that a step of the falling heap takes.
fn milliseconds(scene: &Scene, kind: Kind) -> [f64; 2] {
    let mut stage = scene.stage(kind);
    let step = |_| timed(|| stage.step()).1 * 1.0e3;
    let mut all: Vec<f64> = (0..STEPS).map(step).collect();
    all.sort_by(f64::total_cmp);
    [all[STEPS / 2], all[STEPS - 1]]
}

/// Facets whose lowest point is to be at `low`, put on the ground, under two lines of text.
fn picture(mut seen: Vec<Facet>, low: Real, lines: [&str; 2]) -> Image {
    for facet in &mut seen {
        facet.corners = facet.corners.map(|p| p - Vector::Y * low);
    }
    let view = View {
        camera: Camera {
            eye: Vector::new(0.75, 1.31, 2.35),
            target: Vector::new(0.0, 0.28, 0.0),
            field_of_view: 0.42,
            shadows: 2.0,
        },
        tile: [300, 300],
        steps: &[],
        ghost: 0.0,
    };
    view.labelled(&seen, &lines)
}

fn colored(mesh: &Mesh, color: Vector) -> Vec<Facet> {
    facets(mesh, Pose::IDENTITY, color).collect()
}

/// The spheres' centres and what joins them: the same mesh with thin spheres.
fn axis(medial: &MedialMesh) -> Result<Vec<Facet>, String> {
    let thin = |s: &MedialSphere| MedialSphere::new(s.center, LINE);
    let spheres = medial.spheres().iter().map(thin).collect();
    let thin = MedialMesh::new(spheres, medial.edges().to_vec(), medial.faces().to_vec());
    let thin = thin.map_err(|e| e.to_string())?;
    let (vertices, indices) = thin.envelope(LINE);
    Ok(colored(
        &Mesh { vertices, indices },
        Vector::new(0.70, 0.20, 0.12),
    ))
}

/// Every primitive in a colour of its own.
fn primitives(medial: &MedialMesh) -> Result<Vec<Facet>, String> {
    let mut seen = Vec::new();
    for (number, primitive) in medial.primitives().enumerate() {
        let spheres = primitive.spheres().to_vec();
        let alone = match primitive {
            MedialPrimitive::Sphere(_) => MedialMesh::new(spheres, vec![], vec![]),
            MedialPrimitive::Cone(_) => MedialMesh::new(spheres, vec![[0, 1]], vec![]),
            MedialPrimitive::Slab(_) => MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]),
        };
        let (vertices, indices) = alone.map_err(|e| e.to_string())?.envelope(SIZE / 100.0);
        seen.extend(colored(&Mesh { vertices, indices }, hue(number)));
    }
    Ok(seen)
}

/// Every part of a compound in a colour of its own.
fn pieces(shape: &SharedShape) -> Vec<Facet> {
    match shape.as_compound() {
        Some(parts) => parts
            .shapes()
            .iter()
            .enumerate()
            .flat_map(|(number, (_, part))| colored(&surface(&**part), hue(number)))
            .collect(),
        None => colored(&surface(&**shape), hue(0)),
    }
}

/// Colours that tell neighbours apart: golden steps round the rainbow.
fn hue(number: usize) -> Vector {
    rainbow((0.618_034 * number as Real).fract())
}
