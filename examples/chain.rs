//! A chain of links hangs from a bar, is pulled sideways at the start, and swings. With medial meshes
//! each link keeps hanging in the next. The convex hulls of two linked links overlap: the solver
//! throws them apart at the first step.
//!
//! ```text
//! cargo run --release --example chain
//! ```
//! Option: `--out DIR` (where the picture goes; default target/chain).
//!
//! Exits with 1 when a link of the medial chain is no longer linked with the next: a centre line
//! runs through the other's hole as often to one side as to the other.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::model;
use common::mesh::tube;
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Run, Scene};
use common::scene_strip::{SLATE, View, rainbow};
use common::skeleton::Skeleton;
use common::table::Table;
use common::threading::{passes, placed};
use rapier3d::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

const LINKS: usize = 8;
/// Half the straight part, radius of the round ends, radius of the wire, in metres.
const LINK: [Real; 3] = [0.10, 0.12, 0.04];
/// Ten seconds.
const STEPS: usize = 600;

fn main() -> ExitCode {
    example_with_out("target/chain", chain)
}

fn chain(out: &Path) -> Result<(), String> {
    let outline = outline();
    let mesh = tube(&outline, LINK[2], 14);
    let lines = Skeleton::tube(&outline, LINK[2]);
    let link = model("build the link", (mesh, lines), 32)?;
    let scene = scene(&link);
    let runs = [Kind::Medial, Kind::Hulls].map(|kind| scene.run(kind, STEPS, |_, _| ()));
    let view = View {
        camera: Camera {
            eye: Vector::new(0.85, 2.6, 6.6),
            target: Vector::new(0.55, 2.0, 0.0),
            field_of_view: 0.82,
            shadows: 4.0,
        },
        tile: [240, 260],
        steps: &[0, 10, 35, 70, 500],
        ghost: 0.0,
    };
    let path = out.join("chain.png");
    view.strip(&scene, &[&runs[0], &runs[1]]).save(&path)?;

    let broken = [0, 1].map(|k| broken(&outline, &runs[k]));
    let mut table = Table::default();
    table.row("", runs.iter().map(|run| run.kind.name().to_lowercase()));
    let most = broken.iter().map(|b| b.iter().max().copied().unwrap_or(0));
    table.row(
        &format!("pairs of {} no longer linked, at most", LINKS - 1),
        most,
    );
    table.row("in the end", broken.iter().map(|b| b[b.len() - 1]));
    let fastest = runs.iter().map(|run| format!("{:.1}", fastest(run)));
    table.row("largest speed, m/s", fastest);
    println!("{}\n\n{table}", path.display());
    let mut failures = Vec::new();
    if let Some(step) = broken[0].iter().position(|count| *count > 0) {
        failures.push(format!("the chain broke after {step} steps"));
    }
    if !runs[0].audit.finite {
        failures.push("a pose is not finite".to_string());
    }
    verdict(failures)
}

/// Links in one line that leans to the side, each turned a quarter round against the one before; the
/// first is fixed.
fn scene(link: &Arc<Model>) -> Scene {
    let pitch = 2.0 * (LINK[0] + LINK[1] - LINK[2]) - 0.004;
    let down = Vector::new(-1.0, -0.35, 0.0).normalize();
    let tilt = Rotation::from_rotation_arc(Vector::X, down);
    let actors = (0..LINKS).map(|k| {
        let turn = Rotation::from_rotation_x(FRAC_PI_2 * k as Real);
        let place = Vector::new(0.75, 3.5, 0.0) + down * (pitch * k as Real);
        let body = if k == 0 {
            RigidBodyBuilder::fixed()
        } else {
            RigidBodyBuilder::dynamic()
        };
        Actor {
            model: Arc::clone(link),
            start: body.pose(Pose::from_parts(place, tilt * turn)),
            color: if k == 0 {
                SLATE
            } else {
                rainbow(k as Real / LINKS as Real)
            },
        }
    });
    Scene::new(actors.collect())
}

/// Centre line of a link: a stadium along x, in the plane y = 0.
fn outline() -> Vec<Vector> {
    let [straight, round, _] = LINK;
    let end = |side: Real| {
        (0..=12).map(move |k| {
            let angle = side * FRAC_PI_2 - PI * k as Real / 12.0;
            let (sin, cos) = angle.sin_cos();
            Vector::new(side * straight + round * cos, 0.0, round * sin)
        })
    };
    end(1.0).chain(end(-1.0)).collect()
}

/// Pairs of neighbours that are not linked, after each step.
fn broken(outline: &[Vector], run: &Run) -> Vec<usize> {
    let mut closed = outline.to_vec();
    closed.push(outline[0]);
    let apart =
        |pair: &&[Pose]| passes(&placed(&closed, &pair[0]), &placed(outline, &pair[1])) == 0;
    let count = |poses: &Vec<Pose>| poses.windows(2).filter(apart).count();
    run.history.iter().map(count).collect()
}

/// Largest speed of a link's origin, from the poses.
fn fastest(run: &Run) -> Real {
    let speed = |(a, b): (&Pose, &Pose)| 60.0 * a.translation.distance(b.translation);
    let steps = run.history.windows(2);
    let speeds = steps.flat_map(|w| w[0].iter().zip(&w[1]).map(speed));
    speeds.fold(0.0, Real::max)
}
