//! A hook, moved by hand (kinematic), reaches under the rim of a ring that lies on three posts, lifts
//! it, and swings it about. The hull of a hook has no bend and the hull of a ring no hole, so hulls only
//! push each other away.
//!
//! ```text
//! cargo run --release --example hook_and_ring
//! ```
//! Option: `--out DIR` (where the picture goes; default target/hook_and_ring).
//!
//! Exits with 1 unless from the lift to the end the hook's line runs through the medial ring, as
//! their formulas tell, no inner line crossed another, and no two bodies overlap deeply.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::model;
use common::mesh::ring;
use common::render::Camera;
use common::scene::{Actor, Kind, Run, Scene, Stage};
use common::scene_strip::{SLATE, View};
use common::skeleton::Skeleton;
use common::skin::{Limb, skin};
use common::threading::{passes, placed};
use rapier3d::prelude::*;
use std::f32::consts::TAU;
use std::path::Path;
use std::process::ExitCode;

/// Radii of the ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.5, 0.08);
/// Height of the posts, in metres.
const POSTS: Real = 0.7;
/// Side of the grid's cubes for hook and posts, in metres.
const CELL: Real = 0.022;
/// After so many steps the hook is under the rim, has lifted the ring, has swung.
const MOVES: [usize; 3] = [60, 180, 480];

fn main() -> ExitCode {
    example_with_out("target/hook_and_ring", hook_and_ring)
}

fn hook_and_ring(out: &Path) -> Result<(), String> {
    let scene = scene()?;
    let runs = [Kind::Medial, Kind::Hulls].map(|kind| scene.run(kind, MOVES[2], move_hook));
    let view = View {
        camera: Camera {
            eye: Vector::new(1.6, 2.3, 5.6),
            target: Vector::new(0.35, 1.35, 0.0),
            field_of_view: 0.58,
            shadows: 3.0,
        },
        tile: [340, 340],
        steps: &[0, MOVES[0], 110, MOVES[1], 300],
        ghost: 0.05,
    };
    let path = out.join("hook_and_ring.png");
    view.strip(&scene, &[&runs[0], &runs[1]]).save(&path)?;
    println!("{}", path.display());
    let held = [0, 1].map(|k| held(&scene, &runs[k]));
    let all = MOVES[2] - MOVES[1] + 1;
    for (run, held) in runs.iter().zip(held) {
        let name = run.kind.name().to_lowercase();
        println!("{name}: hook through ring in {held} of {all} steps after the lift");
    }
    let mut failures = runs[0].audit.failures();
    if held[0] < all {
        failures.push(format!(
            "the hook held the ring in {} of {all} steps",
            held[0]
        ));
    }
    verdict(failures)
}

/// The ring, the hook, the posts.
fn scene() -> Result<Scene, String> {
    let (major, minor) = RING;
    let lines = Skeleton::ring(major, minor, 40);
    let ring = model("build the ring", (ring(major, minor, 40, 15), lines), 40)?;
    let hook = model("build the hook", skin(&[hook()], CELL), 80)?;
    let stand = model("build the posts", skin(&posts(), CELL), 80)?;
    let lying = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * (POSTS + minor + 0.002))
        .angular_damping(0.5)
        .can_sleep(false);
    let moved = RigidBodyBuilder::kinematic_position_based().translation(hook_at(0));
    Ok(Scene::new(vec![
        Actor::new(&ring, lying, Vector::new(0.90, 0.55, 0.08)),
        Actor::new(&hook, moved, Vector::new(0.15, 0.35, 0.70)),
        Actor::new(&stand, RigidBodyBuilder::fixed(), SLATE),
    ]))
}

fn hook() -> Limb {
    vec![
        [0.25, 1.3, 0.0, 0.05],
        [0.25, 0.05, 0.0, 0.05],
        [0.12, -0.12, 0.0, 0.05],
        [-0.12, -0.12, 0.0, 0.05],
        [-0.25, 0.30, 0.0, 0.05],
    ]
}

/// Three posts under the ring, none where the hook comes, joined by a foot on the ground.
fn posts() -> Vec<Limb> {
    let post = |angle: Real| {
        let (sin, cos) = angle.sin_cos();
        let [x, z] = [RING.0 * cos, RING.0 * sin];
        vec![
            [0.0, 0.06, 0.0, 0.06],
            [x, 0.06, z, 0.06],
            [x, POSTS - 0.05, z, 0.05],
        ]
    };
    [0.21, 0.5, 0.79].map(|share| post(share * TAU)).to_vec()
}

/// Where the hook's origin is before a step: it comes from the right, goes up, and swings.
fn hook_at(step: usize) -> Vector {
    let share = |from: usize, to: usize| {
        let x = (step.saturating_sub(from) as Real / (to - from) as Real).min(1.0);
        x * x * (3.0 - 2.0 * x)
    };
    let swing = share(MOVES[1], MOVES[2]) * TAU;
    Vector::new(
        1.7 - 1.2 * share(0, MOVES[0]) - 0.5 * (1.0 - swing.cos()),
        0.3 + 1.6 * share(MOVES[0], MOVES[1]),
        0.5 * swing.sin(),
    )
}

fn move_hook(stage: &mut Stage, step: usize) {
    let hook = &mut stage.world.bodies[stage.bodies[1].0];
    hook.set_next_kinematic_translation(hook_at(step + 1));
}

/// In how many of the steps after the lift the hook's line runs through the ring.
fn held(scene: &Scene, run: &Run) -> usize {
    let [circle, line] = [0, 1].map(|k| scene.actors[k].model.skeleton.line());
    let through =
        |poses: &&Vec<Pose>| passes(&placed(&line, &poses[1]), &placed(&circle, &poses[0])) != 0;
    run.history[MOVES[1]..].iter().filter(through).count()
}
