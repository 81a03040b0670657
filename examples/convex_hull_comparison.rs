//! Rings fall on a coat stand, side by side as medial meshes and as convex hulls. A medial ring slides
//! down its hook and hangs, or comes to lie round the column; a hull has no hole, so it floats on the
//! hull of the stand. Red balls mark ghost contacts: colliders touch there, the true meshes do not.
//!
//! ```text
//! cargo run --release --example convex_hull_comparison
//! ```
//! Option: `--out DIR` (where the picture goes; default target/convex_hull_comparison).
//!
//! Exits with 1 unless in the end every medial ring has a hook or the column through its hole, as the
//! formulas of ring and stand tell, all rest, and no inner line has passed another.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::build;
use common::mesh::ring;
use common::random::Random;
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Run, Scene};
use common::scene_strip::{SLATE, View, rainbow};
use common::scene_table::table;
use common::skeleton::Skeleton;
use common::skin::{Limb, skin};
use common::threading::{passes, placed};
use rapier3d::prelude::*;
use std::f32::consts::TAU;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Radii of a ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.42, 0.07);
const HOOKS: usize = 6;
/// One above each hook, the others above the column.
const RINGS: usize = 9;

fn main() -> ExitCode {
    example_with_out("target/convex_hull_comparison", convex_hull_comparison)
}

fn convex_hull_comparison(out: &Path) -> Result<(), String> {
    let scene = scene()?;
    let runs = [Kind::Medial, Kind::Hulls].map(|kind| scene.run(kind, 1000, |_, _| ()));
    let view = View {
        camera: Camera {
            eye: Vector::new(2.6, 4.4, 6.6),
            target: Vector::new(0.0, 1.30, 0.0),
            field_of_view: 0.56,
            shadows: 4.0,
        },
        tile: [320, 290],
        steps: &[usize::MAX],
        ghost: 0.07,
    };
    let path = out.join("convex_hull_comparison.png");
    view.strip(&scene, &[&runs[0], &runs[1]]).save(&path)?;
    println!("{}\n\n{}", path.display(), table(&[&runs[0], &runs[1]]));
    let hung = [0, 1].map(|k| hung(&scene, &runs[k]));
    let all = RINGS;
    println!(
        "rings with a hook or the column through them: {} of {all} medial, {} of {all} hulls",
        hung[0], hung[1]
    );

    let mut failures = runs[0].failures();
    if hung[0] < all {
        failures.push(format!("only {} of {all} rings hang", hung[0]));
    }
    verdict(failures)
}

/// The rings, then the stand.
fn scene() -> Result<Scene, String> {
    let (major, minor) = RING;
    let mesh = ring(major, minor, 40, 15);
    mesh.check_closed()?;
    let medial = build("build the ring", &mesh, 40)?;
    let ring = Model::new(mesh, Skeleton::ring(major, minor, 40), medial);
    let mut limbs: Vec<Limb> = (0..=HOOKS).map(post).collect();
    limbs.extend((0..5).map(|k| {
        let (sin, cos) = (TAU * k as Real / 5.0).sin_cos();
        vec![[0.0, 0.35, 0.0, 0.12], [0.9 * cos, 0.08, 0.9 * sin, 0.08]]
    }));
    let (mesh, skeleton) = skin(&limbs, 0.05);
    mesh.check_closed()?;
    let medial = build("build the stand", &mesh, 300)?;
    let stand = Model::new(mesh, skeleton, medial);

    let mut random = Random(5);
    let rings = (0..RINGS).map(|k| {
        let [x, y, z, _] = post(k.min(HOOKS))[3];
        let height = 0.3 + 0.4 * k.saturating_sub(HOOKS) as Real;
        let tilt = random.direction() * random.between(0.0, 0.15);
        Actor {
            model: Arc::clone(&ring),
            start: RigidBodyBuilder::dynamic()
                .pose(Pose::new(Vector::new(0.9 * x, y + height, 0.9 * z), tilt))
                .linear_damping(0.2)
                .angular_damping(1.0),
            color: rainbow(k as Real / (RINGS) as Real),
        }
    });
    let mut actors: Vec<Actor> = rings.collect();
    actors.push(Actor {
        model: stand,
        start: RigidBodyBuilder::fixed(),
        color: SLATE,
    });
    Ok(Scene::new(actors))
}

/// An arm out of the column, bent upwards at its end; the last post is the column.
fn post(number: usize) -> Limb {
    let (sin, cos) = (TAU * number as Real / HOOKS as Real).sin_cos();
    let arm = [
        (0.0, 2.0, 0.09),
        (1.1, 1.75, 0.07),
        (1.4, 1.85, 0.06),
        (1.6, 2.4, 0.05),
    ];
    let column = [
        (0.0, 0.12, 0.12),
        (0.0, 1.7, 0.10),
        (0.0, 2.1, 0.09),
        (0.0, 2.4, 0.06),
    ];
    let ball = |(out, up, radius): (Real, Real, Real)| [out * cos, up, out * sin, radius];
    if number < HOOKS { arm } else { column }.map(ball).to_vec()
}

/// How many rings have a hook or the column through their hole in the end.
fn hung(scene: &Scene, run: &Run) -> usize {
    let line = |k: usize| {
        let points = post(k).into_iter().map(|[x, y, z, _]| Vector::new(x, y, z));
        placed(&points.collect::<Vec<_>>(), &Pose::IDENTITY)
    };
    let posts: Vec<_> = (0..=HOOKS).map(line).collect();
    let hangs = |pose: &&Pose| {
        let circle = scene.actors[0].model.skeleton.line();
        posts
            .iter()
            .any(|post| passes(post, &placed(&circle, pose)) != 0)
    };
    run.poses_after(usize::MAX)[..RINGS]
        .iter()
        .filter(hangs)
        .count()
}
