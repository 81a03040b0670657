//! A nut on the thread of a bolt, greased: it turns down under its own weight, led by nothing but the
//! contact of thread on thread, until it sits on the bolt's head. The hulls of a bolt and of a nut have
//! no thread and no bore, so they start inside each other; convex parts and triangle meshes jam.
//!
//! ```text
//! cargo run --release --example nut_and_bolt
//! ```
//! Option: `--out DIR` (where the picture goes; default target/nut_and_bolt).
//!
//! Exits with 1 unless the medial nut turns down to the head, by the thread's pitch with each turn within
//! 2 %, and its height is never further off the thread than the true nut's play.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::model;
use common::render::Camera;
use common::scene::{Actor, Kind, Run, Scene, Stage};
use common::scene_strip::{SLATE, View};
use common::screw::{BOLT, NUT_HALF, PITCH, bolt, nut, play};
use common::table::Table;
use rapier3d::prelude::*;
use std::f32::consts::TAU;
use std::path::Path;
use std::process::ExitCode;

/// Height of the nut's centre at the start, in metres.
const START: Real = 5.9;
/// Of grease: above 0.14 the thread would hold the nut.
const FRICTION: Real = 0.02;
/// Fifteen seconds.
const STEPS: usize = 900;
const PRIMITIVES: usize = 300;
const KINDS: [Kind; 4] = [Kind::Medial, Kind::Hulls, Kind::Parts, Kind::Triangles];

fn main() -> ExitCode {
    example_with_out("target/nut_and_bolt", nut_and_bolt)
}

fn nut_and_bolt(out: &Path) -> Result<(), String> {
    let on_thread = Pose::new(Vector::Y * START, Vector::Y * (TAU * START / PITCH));
    let scene = Scene::new(vec![
        Actor {
            model: model("build the bolt", bolt(), PRIMITIVES)?,
            start: RigidBodyBuilder::fixed(),
            color: SLATE,
        },
        Actor {
            model: model("build the nut", nut(), PRIMITIVES)?,
            start: RigidBodyBuilder::dynamic().pose(on_thread),
            color: Vector::new(0.85, 0.55, 0.12),
        },
    ]);
    let runs = KINDS.map(|kind| scene.run(kind, STEPS, grease));
    let view = View {
        camera: Camera {
            eye: Vector::new(6.0, 8.5, 15.0),
            target: Vector::new(0.0, 3.9, 0.0),
            field_of_view: 0.60,
            shadows: 8.0,
        },
        tile: [220, 250],
        steps: &[0, 150, 300, 450, usize::MAX],
        ghost: 0.0,
    };
    let path = out.join("nut_and_bolt.png");
    view.strip(&scene, &runs.each_ref()).save(&path)?;

    let descents = runs.each_ref().map(descent);
    let mut table = Table::default();
    table.row("", KINDS.map(|kind| kind.name().to_lowercase()));
    let mut row = |name: &str, cell: &dyn Fn(usize) -> String| {
        table.row(name, [0, 1, 2, 3].map(cell));
    };
    row("turns", &|k| format!("{:.2}", descents[k].turns));
    row("m down", &|k| format!("{:.2}", descents[k].down));
    row(&format!("m down per turn, of {PITCH}"), &|k| {
        let pitch = descents[k].pitch;
        pitch.map_or("-".to_string(), |pitch| format!("{pitch:.3}"))
    });
    row(&format!("pitches off the thread, of {:.2}", play()), &|k| {
        format!("{:.2}", descents[k].off)
    });
    row("ms per step, median", &|k| {
        format!("{:.2}", runs[k].quantile(runs[k].milliseconds.len(), 0.5))
    });
    println!("{}\n\n{table}", path.display());
    verdict(descents[0].failures())
}

fn grease(stage: &mut Stage, step: usize) {
    let colliders = stage.world.colliders.iter_mut().filter(|_| step == 0);
    colliders.for_each(|(_, collider)| collider.set_friction(FRICTION));
}

/// How a nut went.
struct Descent {
    /// To the right, as down the thread.
    turns: Real,
    /// Metres.
    down: Real,
    /// Metres down per turn, from a half turn to two and a half; of a nut that got so far.
    pitch: Option<Real>,
    /// Most that the nut was off the height that its turns call for, in pitches.
    off: Real,
}

fn descent(run: &Run) -> Descent {
    let nuts: Vec<Pose> = run.history.iter().map(|poses| poses[1]).collect();
    let mut places = vec![(0.0, 0.0)];
    for pair in nuts.windows(2) {
        let turn = pair[1].rotation * pair[0].rotation.inverse();
        let (turned, _) = places[places.len() - 1];
        let down = START - pair[1].translation.y;
        places.push((turned - 2.0 * turn.y.atan2(turn.w) / TAU, down));
    }
    let at = |turn: Real| places.iter().find(|(turns, _)| *turns >= turn);
    let pitch = at(0.5).zip(at(2.5));
    let off = places.iter().map(|(t, down)| (down / PITCH - t).abs());
    let (turns, down) = places[places.len() - 1];
    Descent {
        turns,
        down,
        pitch: pitch.map(|((t0, down0), (t1, down1))| (down1 - down0) / (t1 - t0)),
        off: off.fold(0.0, Real::max),
    }
}

impl Descent {
    fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        match self.pitch {
            None => failures.push(format!("the nut made {:.2} turns only", self.turns)),
            Some(pitch) if (pitch / PITCH - 1.0).abs() > 0.02 => {
                failures.push(format!("{pitch} m down per turn, not {PITCH}"));
            }
            Some(_) => {}
        }
        if self.off > play() {
            failures.push(format!("{} pitches off the thread", self.off));
        }
        // The medial meshes are thicker than the true ones.
        let above = START - self.down - BOLT.0 - NUT_HALF;
        if !(0.0..0.3).contains(&above) {
            failures.push(format!("the nut ended {above} m above the head"));
        }
        failures
    }
}
