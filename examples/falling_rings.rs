//! Rings fall on a spiky creature, as in the paper's third benchmark (Figures 7 and 15): once with
//! medial meshes, where they hang on its spikes, and once with convex hulls, where they float.
//!
//! ```text
//! cargo run --release --example falling_rings
//! cargo run --release --example falling_rings -- --mesh my.obj
//! ```
//! Options: `--mesh FILE` (drops 15 of your own instead, scaled to the rings' size), `--steps N` (at most; default 1500), `--out DIR` (where the pictures go; default
//! target/falling_rings), `--backend cpu|auto|gpu` (where batches are computed; feature `gpu`), `--quick` (5 rings, small pictures).
//!
//! Exits with 1 when a check fails: all rings stay above the ground, none passes through another or
//! the creature, all sleep in the end. The checks work on the formulas and triangles that the
//! bodies were made of, not on their colliders.

mod common;

use common::arguments::Arguments;
use common::creature::creature;
use common::mesh::{Mesh, ring};
use common::progress::bar;
use common::scene::{Model, Run, Scene, Stage};
use common::scene_strip::draw;
use common::scene_table::table;
use common::skeleton::Skeleton;
use rapier3d::prelude::*;
use rapier3d_medial::build::mesh_file;
use rapier3d_medial::{Progress, prelude::*};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Radii of a ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.5, 0.1);
/// The steps that the strip of pictures shows; the last picture is of the end.
const SHOWN: [usize; 4] = [45, 80, 120, usize::MAX];

struct Options {
    mesh: Option<PathBuf>,
    steps: usize,
    out: PathBuf,
    backend: Backend,
    quick: bool,
}

fn options() -> Result<Options, String> {
    let mut arguments = Arguments::from_env();
    let options = Options {
        steps: arguments.value("--steps")?.map_or(1500, NonZeroUsize::get),
        mesh: arguments.value("--mesh")?,
        out: arguments
            .value("--out")?
            .unwrap_or("target/falling_rings".into()),
        backend: match arguments.value::<String>("--backend")?.as_deref() {
            None | Some("cpu") => Backend::Cpu,
            Some("auto") => Backend::Auto,
            Some("gpu") => Backend::Gpu,
            Some(other) => return Err(format!("--backend cannot be `{other}`")),
        },
        quick: arguments.flag("--quick"),
    };
    arguments.finish().map(|()| options)
}

fn main() -> ExitCode {
    let options = match options() {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    match falling_rings(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("FAILED: {message}");
            ExitCode::FAILURE
        }
    }
}

fn falling_rings(options: &Options) -> Result<(), String> {
    let (ring, medial_ring) = match &options.mesh {
        None => rings()?,
        Some(file) => users_mesh(file)?,
    };
    let (mesh, skeleton) = creature();
    mesh.check_closed()?;
    let medial_creature = build("build the creature", &mesh, 700)?;
    let creature = Model::new(mesh, skeleton);
    let scene = Scene::new(ring, creature, if options.quick { 5 } else { 15 });

    let medial = medial_meshes(&scene, medial_ring, medial_creature, options.backend);
    let medial = simulate("simulate medial meshes", &scene, medial, options.steps);
    let hulls = convex_hulls(&scene);
    let hulls = simulate("simulate convex hulls", &scene, hulls, options.steps);

    let runs = [("MEDIAL MESHES", &medial), ("CONVEX HULLS", &hulls)];
    let strip = draw(&scene, &runs, &SHOWN, if options.quick { 240 } else { 480 });
    let path = options.out.join("falling_rings.png");
    let failed = |e| format!("cannot write {}: {e}", path.display());
    strip.save(&path).map_err(failed)?;
    println!("{}\n\n{}", path.display(), table(&runs));
    match medial.failures()[..] {
        [] => Ok(()),
        ref failures => Err(failures.join("; ")),
    }
}

/// Rings: 27 primitives for 1,200 triangles, as in the paper.
fn rings() -> Result<(Model, MedialMesh), String> {
    let (major, minor) = RING;
    let mesh = ring(major, minor, 40, 15);
    mesh.check_closed()?;
    let medial = build("build the ring", &mesh, 27)?;
    Ok((Model::new(mesh, Skeleton::ring(major, minor, 40)), medial))
}

/// The user's mesh, scaled to the size of a ring. No formula is known for its inner lines: they are
/// those of the medial mesh, as far as they are thick.
fn users_mesh(file: &Path) -> Result<(Model, MedialMesh), String> {
    let read = mesh_file::read(file).map_err(|e| e.to_string())?;
    let size = 2.0 * (RING.0 + RING.1);
    let mesh = Mesh {
        vertices: read.vertices,
        indices: read.indices,
    };
    let mesh = mesh.fitted(size);
    let medial = build("build your mesh", &mesh, 100)?;
    let skeleton = Skeleton::of_medial(&medial, 0.02 * size);
    Ok((Model::new(mesh, skeleton), medial))
}

/// Triangle mesh in, medial mesh of so many primitives out.
fn build(name: &'static str, mesh: &Mesh, primitives: usize) -> Result<MedialMesh, String> {
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
    let (medial, report) = built.map_err(|e| format!("cannot {name}: {e}"))?;
    bar.finish();
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

/// The scene with medial meshes: another collider, and another line for the step.
fn medial_meshes(
    scene: &Scene,
    ring: MedialMesh,
    creature: MedialMesh,
    backend: Backend,
) -> (Stage, impl FnMut(&mut PhysicsWorld) -> u64) {
    let collider = ColliderBuilder::medial_mesh;
    let mut stage = scene.stage(&collider(ring), &collider(creature));
    let mut options = MedialOptions::default();
    options.backend = backend;
    let mut pipeline = MedialPipeline::new(options);
    match &pipeline.batch().report().error {
        Some(reason) => println!("batches on the CPU: {reason}"),
        None => println!("batches: {backend:?}"),
    }
    pipeline.attach(&mut stage.world);
    let step = move |world: &mut PhysicsWorld| pipeline.step(world).elementary_tests;
    (stage, step)
}

/// The scene with convex hulls: plain rapier.
fn convex_hulls(scene: &Scene) -> (Stage, impl FnMut(&mut PhysicsWorld) -> u64) {
    let hull = |model: &Model| ColliderBuilder::convex_hull(&model.mesh.vertices).expect("a solid");
    let stage = scene.stage(&hull(&scene.ring), &hull(&scene.creature));
    let step = |world: &mut PhysicsWorld| {
        world.step();
        0
    };
    (stage, step)
}

fn simulate(
    name: &'static str,
    scene: &Scene,
    (stage, step): (Stage, impl FnMut(&mut PhysicsWorld) -> u64),
    steps: usize,
) -> Run {
    let bar = bar(name, steps);
    let run = scene.run(stage, steps, step, || bar.inc(1));
    bar.finish();
    run
}
