//! Rings fall on a spiky creature, as in the paper's third benchmark (Figures 7 and 15): once with
//! medial meshes, where they hang on its spikes, and once with convex hulls, where they float.
//!
//! ```text
//! cargo run --release --example falling_rings
//! cargo run --release --example falling_rings -- --mesh my.obj
//! ```
//! Options: `--mesh FILE` (drops 15 of your own instead, scaled to the rings' size), `--steps N`
//! (at most; default 1500), `--out DIR` (where the pictures go; default target/falling_rings),
//! `--backend cpu|auto|gpu` (where batches are computed; feature `gpu`), `--quick` (5 rings,
//! small pictures), `--animate` (a moving picture besides, which takes a minute).
//!
//! Exits with 1 when a check fails: all rings stay above the ground, none passes through another or
//! the creature, all sleep in the end. The checks work on the formulas and triangles that the
//! bodies were made of, not on their colliders.

mod common;

use common::animation::save_animation;
use common::arguments::{Arguments, example, verdict};
use common::build::{build, model};
use common::creature::creature;
use common::falling::{SIZE, falling_on, falling_ring};
use common::mesh::Mesh;
use common::render::Camera;
use common::scene::{Kind, Model};
use common::scene_strip::View;
use common::scene_table::table;
use common::skeleton::Skeleton;
use rapier3d::prelude::*;
use rapier3d_medial::Backend;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

struct Options {
    mesh: Option<PathBuf>,
    steps: usize,
    out: PathBuf,
    backend: Backend,
    quick: bool,
    animate: bool,
}

fn main() -> ExitCode {
    let options = |arguments: &mut Arguments| {
        Ok(Options {
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
            animate: arguments.flag("--animate"),
        })
    };
    example(options, falling_rings)
}

fn falling_rings(options: Options) -> Result<(), String> {
    let ring = match &options.mesh {
        // 27 primitives for 1,200 triangles, as in the paper.
        None => model("build the ring", falling_ring(), 27)?,
        Some(file) => users_mesh(file)?,
    };
    let creature = model("build the creature", creature(), 700)?;
    let mut scene = falling_on(creature, &ring, if options.quick { 5 } else { 15 });
    scene.backend = options.backend;

    let [medial, hulls] =
        [Kind::Medial, Kind::Hulls].map(|kind| scene.run(kind, options.steps, |_, _| ()));

    let width = if options.quick { 240 } else { 300 };
    let view = View {
        camera: Camera {
            eye: Vector::new(3.4, 4.4, 7.6),
            target: Vector::new(0.1, 1.2, 0.1),
            field_of_view: 0.66,
            shadows: 4.5,
        },
        tile: [width, width * 5 / 6],
        steps: &[45, 80, 120, usize::MAX],
        ghost: 0.0,
    };
    let strip = view.strip(&scene, &[&medial, &hulls]);
    let path = options.out.join("falling_rings.png");
    strip.save(&path)?;
    if options.animate {
        let steps: Vec<usize> = (40..200).step_by(6).collect();
        let small = View {
            steps: &steps,
            tile: [216, 180],
            ..view
        };
        let frames = small.frames(&scene, &[&medial, &hulls]);
        let path = options.out.join("falling_rings_moving.png");
        save_animation(&frames, 10, &path)?;
    }
    println!("{}\n\n{}", path.display(), table(&[&medial, &hulls]));
    verdict(medial.failures())
}

/// The user's mesh, scaled to the size of a ring. No formula is known for its inner lines: they are
/// those of the medial mesh, as far as they are thick.
fn users_mesh(file: &Path) -> Result<Arc<Model>, String> {
    let mesh = Mesh::read(file)?.fitted(SIZE);
    let medial = build("build your mesh", &mesh, 100)?;
    let skeleton = Skeleton::of_medial(&medial, 0.02 * SIZE);
    Ok(Model::new(mesh, skeleton, medial))
}
