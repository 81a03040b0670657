//! `medial compare`: a mesh as the colliders that rapier may have of it (medial mesh, convex decomposition, convex
//! hull, triangle mesh), each with its largest error, what it costs to make and to step, and a picture of them side by
//! side.

use crate::STOP;
use crate::build::{BAR_STEPS, QualityArgument, bar, creases, listen};
use crate::common::creature::creature;
use crate::common::mesh::Mesh;
use crate::common::random::Random;
use crate::common::scene::{Actor, Kind, Model, Scene};
use crate::common::shape_error::shape_error;
use crate::common::skeleton::Skeleton;
use crate::common::surface_error::surface_error;
use crate::common::table::Table;
use crate::compare_picture::{Labels, draw};
use crate::failure::Failure;
use crate::jobs;
use crate::output::print;
use clap::Args;
use indicatif::ProgressBar;
use rapier3d::prelude::*;
use rapier3d_medial::meshing::mesh_file;
use rapier3d_medial::{BuildOptions, MedialMesh};
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Longest side (m) that meshes are scaled to, so that all fall in the same scene.
pub const SIZE: Real = 1.0;
/// Points on each surface (a count) at which errors are measured, besides its vertices.
const POINTS: usize = 20_000;
/// Number of heaps whose steps are timed. A heap falls as chance will have it, and takes half or twice as long as
/// another.
const HEAPS: u64 = 4;
/// Number of bodies in each heap.
const BODIES: usize = 12;
/// Share of the progress bar at which the medial mesh is built.
const BUILT: f32 = 0.6;

#[derive(Args)]
pub struct CompareArguments {
    /// Triangle mesh: obj, stl, ply, off, glb or gltf. Without one, the creature of the README.
    mesh: Option<PathBuf>,
    /// Where to draw the picture.
    #[arg(short, long, value_name = "OUT.png", default_value = "compare.png")]
    output: PathBuf,
    /// Largest number of primitives of the medial mesh.
    #[arg(short, long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..))]
    primitives: u32,
    /// How much work to spend on making the medial mesh's error small.
    #[arg(short, long, value_enum, default_value_t)]
    quality: QualityArgument,
    /// Round all edges of the medial mesh, also where sharp ones would make its error smaller.
    #[arg(long)]
    round_edges: bool,
    /// Number of steps to time in each of 4 heaps of 12 bodies; with 0 nothing is timed.
    #[arg(long, value_name = "N", default_value_t = 240)]
    steps: usize,
    /// Print the table as JSON.
    #[arg(long)]
    json: bool,
}

/// The colliders of one mesh, with what they cost.
#[derive(Serialize)]
struct Comparison {
    #[serde(serialize_with = "crate::output::path")]
    picture: PathBuf,
    triangles: usize,
    /// Longest side of the bounding box, in the unit of the file.
    longest_side: f32,
    /// Number of bodies in each heap, of heaps, and of steps of each.
    bodies: usize,
    heaps: u64,
    steps: usize,
    colliders: Vec<Row>,
    /// Notes of the build of the medial mesh.
    notes: Vec<String>,
}

/// One kind of collider.
#[derive(Serialize)]
struct Row {
    collider: &'static str,
    /// Primitives, convex hulls, or triangles.
    pieces: usize,
    /// Largest distance between its surface and the mesh's, in either direction (longest side 1).
    error: f64,
    seconds_to_build: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    step_milliseconds: Option<StepTimes>,
}

#[derive(Clone, Copy, Serialize)]
struct StepTimes {
    mean: f64,
    longest: f64,
}

/// The colliders, and the seconds that each took to make.
struct Made {
    medial: (MedialMesh, f64),
    notes: Vec<String>,
    parts: (SharedShape, f64),
    hull: (SharedShape, f64),
    /// Seconds alone of rapier's own triangle mesh.
    triangles: f64,
}

/// Makes the colliders, measures and draws them.
pub fn compare(arguments: &CompareArguments) -> Result<(), Failure> {
    jobs::check_picture(arguments.mesh.as_deref(), &arguments.output)?;
    let source = read(arguments.mesh.as_deref())?;
    listen();
    let bar = bar(1, false);
    let compared = measure(arguments, source, &bar);
    bar.finish_and_clear();
    let comparison = compared.map_err(|failure| match &arguments.mesh {
        Some(path) => failure.of(path),
        None => failure,
    })?;
    print(arguments.json, &comparison, || comparison.text())
}

fn read(path: Option<&Path>) -> Result<Mesh, Failure> {
    let Some(path) = path else {
        return Ok(creature().0);
    };
    let read = mesh_file::read(path).map_err(|e| Failure::from(e).of(path))?;
    let mesh = Mesh {
        vertices: read.vertices,
        indices: read.indices,
    };
    Ok(mesh.without_unused())
}

fn measure(
    arguments: &CompareArguments,
    source: Mesh,
    bar: &ProgressBar,
) -> Result<Comparison, Failure> {
    let (low, high) = source.bounds();
    let longest_side = (high - low).max_element();
    let mesh = source.fitted(SIZE);
    let made = make(arguments, &mesh, bar)?;
    go_on(bar, "measuring", 0.7)?;
    let boundary = surface_error(&made.medial.0, &mesh, 0.005 * SIZE, POINTS);
    let off = boundary.map_or(0.0, |boundary| f64::from(boundary.largest()));
    let side = f64::from(SIZE);
    let errors = [
        off,
        shape_error(&*made.parts.0, &mesh),
        shape_error(&*made.hull.0, &mesh),
    ]
    .map(|error| error / side);
    let hulls = made.parts.0.as_compound().map_or(1, |c| c.shapes().len());

    go_on(bar, "drawing", 0.8)?;
    let labels = Labels { errors, hulls };
    let picture = draw(&mesh, &made.medial.0, [&made.parts.0, &made.hull.0], labels)?;
    picture
        .save(&arguments.output)
        .map_err(Failure::NoPicture)?;

    let triangles = mesh.indices.len();
    let rows = [
        (
            Kind::Medial,
            "medial mesh",
            made.medial.0.primitive_count(),
            made.medial.1,
        ),
        (Kind::Parts, "convex decomposition", hulls, made.parts.1),
        (Kind::Hulls, "convex hull", 1, made.hull.1),
        (Kind::Triangles, "triangle mesh", triangles, made.triangles),
    ];
    let errors = [errors[0], errors[1], errors[2], 0.0];
    let heaps = heaps(mesh, made.medial.0);
    let mut colliders = Vec::new();
    for ((kind, collider, pieces, seconds_to_build), error) in rows.into_iter().zip(errors) {
        go_on(bar, "stepping", 0.84 + 0.04 * colliders.len() as f32)?;
        colliders.push(Row {
            collider,
            pieces,
            error,
            seconds_to_build,
            step_milliseconds: step_times(&heaps, kind, arguments.steps)?,
        });
    }
    Ok(Comparison {
        picture: arguments.output.clone(),
        triangles,
        longest_side,
        bodies: BODIES,
        heaps: HEAPS,
        steps: arguments.steps,
        colliders,
        notes: made.notes,
    })
}

fn make(arguments: &CompareArguments, mesh: &Mesh, bar: &ProgressBar) -> Result<Made, Failure> {
    let (vertices, indices) = (&mesh.vertices, &mesh.indices);
    let options = BuildOptions {
        primitives: Some(arguments.primitives as usize),
        quality: arguments.quality.into(),
        creases: creases(arguments.round_edges),
        ..Default::default()
    };
    let (medial, medial_seconds) = timed(|| {
        MedialMesh::from_trimesh_with_progress(vertices, indices, &options, &mut |progress| {
            match go_on(bar, progress.stage, BUILT * progress.fraction) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        })
    });
    let (medial, report) = medial?;
    let (hull, hull_seconds) = timed(|| SharedShape::convex_hull(vertices));
    let hull = hull.ok_or(Failure::NoHull)?;
    go_on(bar, "convex decomposition", BUILT)?;
    let (parts, parts_seconds) = timed(|| SharedShape::convex_decomposition(vertices, indices));
    let (_, triangles) = timed(|| mesh.to_parry());
    Ok(Made {
        triangles,
        medial: (medial, medial_seconds),
        notes: report.notes,
        parts: (parts, parts_seconds),
        hull: (hull, hull_seconds),
    })
}

/// Shows the stage and the part done, unless Ctrl-C ends it here.
fn go_on(bar: &ProgressBar, stage: &'static str, fraction: f32) -> Result<(), Failure> {
    bar.set_message(stage);
    bar.set_position((fraction * BAR_STEPS as f32) as u64);
    match STOP.load(Ordering::Relaxed) {
        true => Err(Failure::Stopped(stage)),
        false => Ok(()),
    }
}

/// Does some work; returns its result and its seconds.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}

/// Heaps of bodies above each other, turned at random.
fn heaps(mesh: Mesh, medial: MedialMesh) -> Vec<Scene> {
    let skeleton = Skeleton::of_medial(&medial, 0.02 * SIZE);
    let model: Arc<Model> = Model::new(mesh, skeleton, medial);
    let heap = |seed| {
        let mut random = Random(seed);
        let actors = (0..BODIES).map(|k| {
            let turn = random.direction() * 3.0;
            let start = RigidBodyBuilder::dynamic()
                .translation(random.direction() * 0.3 + Vector::Y * (1.0 + 0.8 * k as Real))
                .rotation(turn);
            Actor::new(&model, start, Vector::ONE)
        });
        Scene::new(actors.collect())
    };
    (1..=HEAPS).map(heap).collect()
}

/// The mean and the longest of some steps of each falling heap; `None` of none.
fn step_times(heaps: &[Scene], kind: Kind, steps: usize) -> Result<Option<StepTimes>, Failure> {
    if steps == 0 {
        return Ok(None);
    }
    let mut all = Vec::new();
    for heap in heaps {
        let mut stage = heap.stage(kind);
        for _ in 0..steps {
            if STOP.load(Ordering::Relaxed) {
                return Err(Failure::Stopped("stepping"));
            }
            all.push(timed(|| stage.step()).1 * 1.0e3);
        }
    }
    Ok(Some(StepTimes {
        mean: all.iter().sum::<f64>() / all.len() as f64,
        longest: all.into_iter().fold(0.0, f64::max),
    }))
}

impl Comparison {
    fn text(&self) -> String {
        let mut table = Table::default();
        let timed = self.steps > 0;
        let mut heading = vec!["pieces", "% off", "s to build"];
        if timed {
            heading.extend(["ms a step", "longest"]);
        }
        table.row("collider", heading);
        for row in &self.colliders {
            let mut cells = vec![
                row.pieces.to_string(),
                format!("{:.2}", 100.0 * row.error),
                format!("{:.2}", row.seconds_to_build),
            ];
            if let Some(StepTimes { mean, longest }) = row.step_milliseconds {
                cells.extend([mean, longest].map(|ms| format!("{ms:.2}")));
            }
            table.row(row.collider, cells);
        }
        let mut text = format!(
            "{}\n\n{table}\n% off: largest distance from the surface of the mesh, in % of its longest side ({})\n",
            self.picture.display(),
            self.longest_side
        );
        if timed {
            text += &format!(
                "ms a step: mean of {} steps of each of {} heaps, into which {} bodies fall\n",
                self.steps, self.heaps, self.bodies
            );
        }
        for note in &self.notes {
            text += &format!("note: {note}\n");
        }
        text
    }
}
