//! Rings fall on a spiky creature, as in the paper's third benchmark (Figures 7 and 15): once with
//! medial meshes, where they hang on its spikes, and once with convex hulls, where they float.
//!
//! ```text
//! cargo run --release --example falling_rings
//! ```
//! Options: `--steps N` (at most; default 1500), `--out DIR` (where the pictures go; default
//! target/falling_rings), `--quick` (5 rings, small pictures).
//!
//! Exits with 1 when a check fails: all rings stay above the ground, none passes through another or
//! the creature, all sleep in the end. The checks work on the formulas and triangles that the
//! bodies were made of, not on their colliders.

mod common;

use common::arguments::Arguments;
use common::creature::creature;
use common::mesh::ring;
use common::progress::bar;
use common::scene::{Model, Run, Scene, Stage};
use common::scene_strip::draw;
use common::scene_table::table;
use common::skeleton::Skeleton;
use rapier3d::prelude::*;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Radii of a ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.5, 0.1);
/// The steps that the strip of pictures shows; the last picture is of the end.
const SHOWN: [usize; 4] = [45, 80, 120, usize::MAX];

struct Options {
    steps: usize,
    out: PathBuf,
    quick: bool,
}

fn options() -> Result<Options, String> {
    let mut arguments = Arguments::from_env();
    let options = Options {
        steps: arguments.value("--steps")?.map_or(1500, NonZeroUsize::get),
        out: arguments
            .value("--out")?
            .unwrap_or("target/falling_rings".into()),
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
    let (major, minor) = RING;
    let ring = Model::new(ring(major, minor, 40, 15), Skeleton::ring(major, minor, 40))?;
    let (mesh, bones) = creature();
    let creature = Model::new(mesh, bones)?;
    let scene = Scene::new(ring, creature, if options.quick { 5 } else { 15 });
    let hulls = simulate(
        "hulls: simulate",
        &scene,
        convex_hulls(&scene),
        options.steps,
    );
    let runs = [("CONVEX HULLS", &hulls)];
    let strip = draw(&scene, &runs, &SHOWN, if options.quick { 240 } else { 480 });
    let path = options.out.join("falling_rings.png");
    strip
        .save(&path)
        .map_err(|e| format!("cannot write {}: {e}", path.display()))?;
    println!("{}", path.display());
    println!("{}", table(&runs));
    Ok(())
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
