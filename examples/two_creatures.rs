//! A creature falls upside down on another, and their limbs and spikes lock: 1,236 primitives each, as
//! many as the paper's T-rex has (Figure 6). Prints what a frame's collisions cost.
//!
//! ```text
//! cargo run --release --example two_creatures
//! ```
//! Option: `--out DIR` (where the picture goes; default target/two_creatures).
//!
//! Exits with 1 when a bone of one creature crosses a bone of the other on the way from pose to pose,
//! or when they never touch by their true meshes. Bones are those that the skins grew on.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::build_as_many;
use common::creature::creature;
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Scene};
use common::scene_strip::View;
use common::scene_table::table;
use rapier3d::prelude::*;
use std::f32::consts::PI;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

const STEPS: usize = 300;

fn main() -> ExitCode {
    example_with_out("target/two_creatures", two_creatures)
}

fn two_creatures(out: &Path) -> Result<(), String> {
    let (mesh, skeleton) = creature();
    mesh.check_closed()?;
    let medial = build_as_many("build the creature", &mesh, 1236)?;
    let creature = Model::new(mesh, skeleton, medial);
    let actor = |place: Vector, turn: Vector, color: Vector| Actor {
        model: Arc::clone(&creature),
        start: RigidBodyBuilder::dynamic().pose(Pose::new(place, turn)),
        color,
    };
    let scene = Scene::new(vec![
        actor(
            Vector::Y * 0.02,
            Vector::Y * 0.4,
            Vector::new(0.20, 0.22, 0.27),
        ),
        actor(
            Vector::new(0.25, 6.0, 0.2),
            Vector::Z * PI,
            Vector::new(0.55, 0.30, 0.12),
        ),
    ]);
    let mut touched = false;
    let run = scene.run(Kind::Medial, STEPS, |stage, _| {
        let poses = stage.poses();
        touched = touched || scene.near(0, &poses[0], 1, &poses[1]);
    });
    let view = View {
        camera: Camera {
            eye: Vector::new(2.5, 4.2, 10.0),
            target: Vector::new(0.0, 1.9, 0.0),
            field_of_view: 0.62,
            shadows: 6.0,
        },
        tile: [400, 400],
        steps: &[0, 42, 52, STEPS],
        ghost: 0.0,
    };
    let path = out.join("two_creatures.png");
    view.columns(&scene, &run, 4).save(&path)?;
    println!("{}\n\n{}", path.display(), table(&[&run]));
    let mut failures = Vec::new();
    if run.audit.crossings > 0 {
        failures.push(format!("bones crossed {} times", run.audit.crossings));
    }
    if !touched {
        failures.push("the creatures never touched".to_string());
    }
    verdict(failures)
}
