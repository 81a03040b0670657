//! The paper's three benchmarks at its sizes, with bodies made in code: Multi-bodies, two creatures
//! (its T-rexes) and Falling Rings. One table in the columns of its Tables 1 and 2, its own figures
//! beside, and the curves of its Figure 8.

use crate::brute_force::{Brute, brute_force};
use crate::common::build::build_as_many;
use crate::common::creature::{creature, creature_with_cells};
use crate::common::decimate::decimated;
use crate::common::mesh::ring;
use crate::common::pillars::field;
use crate::common::random::Random;
use crate::common::scene::{Actor, Kind, Model, Scene};
use crate::common::skeleton::Skeleton;
use crate::report::{Plot, Section};
use rapier3d::prelude::*;
use rapier3d_medial::StepReport;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Instant;

/// Of the paper's Tables 1 and 2: triangles, spheres, primitives, elementary pairs, Init, CD, CR, Upd,
/// frames per second, on an Intel i7 5960X and an NVIDIA RTX 2060 SUPER.
const PAPER: [[&str; 9]; 3] = [
    [
        "276643", "5214", "2263", "8581733", "13.781", "6.30", "0.016", "1.489", "56",
    ],
    [
        "200004", "5878", "2472", "74755481", "10.343", "9.57", "0.038", "0.829", "35",
    ],
    [
        "19115", "876", "433", "101192", "0.438", "3.28", "0.035", "0.137", "75",
    ],
];
const NAMES: [&str; 3] = ["Multi-bodies", "two creatures", "Falling Rings"];

/// What a frame took.
struct Frame {
    milliseconds: f64,
    report: StepReport,
    /// Of brute force on the same frame, where it was done.
    brute: Option<Brute>,
}

fn still(model: &Arc<Model>, start: RigidBodyBuilder) -> Actor {
    Actor {
        model: Arc::clone(model),
        start,
        color: Vector::ONE,
    }
}

/// Two creatures of 1,236 primitives, one upside down above the other.
fn creatures(quick: bool) -> Result<Scene, String> {
    let (mesh, skeleton) = if quick {
        creature()
    } else {
        creature_with_cells(0.0255)
    };
    let medial = build_as_many("two creatures", &mesh, 1236)?;
    let model = Model::new(mesh, skeleton, medial);
    let place = |place, turn| RigidBodyBuilder::dynamic().pose(Pose::new(place, turn));
    Ok(Scene::new(vec![
        still(&model, place(Vector::Y * 0.02, Vector::Y * 0.4)),
        still(&model, place(Vector::new(0.25, 6.0, 0.2), Vector::Z * PI)),
    ]))
}

/// Fifteen rings of 27 primitives and 1,200 triangles above a creature of 28 and 1,115.
fn rings() -> Result<Scene, String> {
    let mesh = ring(0.5, 0.1, 40, 15);
    let medial = build_as_many("a ring", &mesh, 27)?;
    let rings = Model::new(mesh, Skeleton::ring(0.5, 0.1, 40), medial);
    let (fine, skeleton) = creature();
    let mesh = decimated(&fine, 560);
    let medial = build_as_many("a small creature", &mesh, 28)?;
    let stands = Model::new(mesh, skeleton, medial);
    let mut random = Random(9);
    let mut actors: Vec<Actor> = (0..15)
        .map(|k| {
            let angle = TAU * 0.618_034 * k as Real;
            let out = 1.35 * ((k as Real + 0.6) / 15.0).sqrt();
            let height = 3.2 + 0.55 * k as Real;
            let place = Vector::new(out * angle.cos(), height, out * angle.sin());
            let pose = Pose::new(place, random.direction() * random.between(0.0, 1.2));
            still(
                &rings,
                RigidBodyBuilder::dynamic().pose(pose).angular_damping(0.5),
            )
        })
        .collect();
    actors.push(still(&stands, RigidBodyBuilder::fixed()));
    Ok(Scene::new(actors))
}

/// Steps a scene; brute force is done on `samples` frames, evenly spread over the second half.
fn play(scene: &Scene, frames: usize, samples: usize) -> Vec<Frame> {
    let mut stage = scene.stage(Kind::Medial);
    let every = frames / 2 / samples.max(1);
    (0..frames)
        .map(|number| {
            let before = stage.poses();
            let start = Instant::now();
            let report = stage.step();
            let milliseconds = 1.0e3 * start.elapsed().as_secs_f64();
            let sampled = number >= frames / 2 && (number - frames / 2) % every == every / 2;
            let brute = sampled.then(|| brute_force(scene, &before, &stage.poses()));
            Frame {
                milliseconds,
                report,
                brute,
            }
        })
        .collect()
}

fn mean(frames: &[Frame], of: impl Fn(&Frame) -> f64) -> f64 {
    frames.iter().map(of).sum::<f64>() / frames.len() as f64
}

/// Seconds of this crate's search: contacts of all pairs, which pairs to mute, first contacts.
fn searching(frame: &Frame) -> f64 {
    let report = &frame.report;
    1.0e3 * (report.batch_seconds + report.mute_seconds + report.event_seconds)
}

fn row(name: &str, scene: &Scene, init: f64, frames: &[Frame]) -> Vec<String> {
    let sum = |of: fn(&Model) -> usize| -> String {
        scene
            .actors
            .iter()
            .map(|a| of(&a.model))
            .sum::<usize>()
            .to_string()
    };
    let brute = || frames.iter().filter_map(|f| f.brute.as_ref());
    let count = brute().count().max(1) as f64;
    let brute_mean = |of: fn(&Brute) -> f64| brute().map(of).sum::<f64>() / count;
    let whole = mean(frames, |f| f.milliseconds);
    vec![
        name.to_string(),
        "this crate".into(),
        sum(|m| m.mesh.indices.len()),
        sum(|m| m.medial.spheres().len()),
        sum(|m| m.medial.primitive_count()),
        format!("{:.0}", brute_mean(|b| b.tests as f64)),
        format!("{:.0}", mean(frames, |f| f.report.elementary_tests as f64)),
        format!("{init:.1}"),
        format!("{:.3}", mean(frames, searching)),
        format!("{:.3}", mean(frames, |f| 1.0e3 * f.report.step_seconds)),
        String::from("in CR"),
        format!("{whole:.3}"),
        format!("{:.0}", 1.0e3 / whole),
        format!("{:.1}", brute_mean(|b| b.lanes_milliseconds)),
        format!("{:.0}", brute_mean(|b| b.paper_milliseconds)),
    ]
}

fn papers(number: usize) -> Vec<String> {
    let [
        triangles,
        spheres,
        primitives,
        pairs,
        init,
        cd,
        cr,
        upd,
        fps,
    ] = PAPER[number];
    let cells = [
        NAMES[number],
        "paper",
        triangles,
        spheres,
        primitives,
        pairs,
        "-",
        init,
        cd,
        cr,
        upd,
        "-",
        fps,
        "-",
        "-",
    ];
    cells.map(String::from).to_vec()
}

/// The table, and a plot of elementary tests and one of times over the frames.
pub fn measure(quick: bool, progress: &dyn Fn()) -> Result<Vec<Section>, String> {
    let (frames, samples) = if quick { (120, 1) } else { (300, 3) };
    let mut rows = Vec::new();
    let (mut tests, mut times, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for (number, name) in NAMES.into_iter().enumerate() {
        let start = Instant::now();
        let scene = match number {
            0 if quick => field(0.014, 148)?,
            0 => field(0.0059, 148)?,
            1 => creatures(quick)?,
            _ => rings()?,
        };
        let init = start.elapsed().as_secs_f64();
        progress();
        let played = play(&scene, frames, samples);
        progress();
        rows.push(row(name, &scene, init, &played));
        rows.push(papers(number));
        let curve = |of: &dyn Fn(&Frame) -> f64| -> Vec<(f64, f64)> {
            let place = |(k, f): (usize, &Frame)| (k as f64, of(f));
            played.iter().enumerate().map(place).collect()
        };
        tests.push((name.into(), curve(&|f| f.report.elementary_tests as f64)));
        times.push((name.into(), curve(&|f| f.milliseconds)));
        all.extend(played.iter().enumerate().map(|(k, f)| {
            vec![
                name.to_string(),
                k.to_string(),
                f.report.elementary_tests.to_string(),
                format!("{:.3}", searching(f)),
                format!("{:.3}", f.milliseconds),
            ]
        }));
    }
    let table = Section {
        name: "paper",
        title: "The paper's benchmarks at its sizes (Tables 1 and 2, Figure 8)",
        text: "Bodies made in code in place of the paper's models. Elementary pairs are all distinct tests \
               of all pairs of bodies, tests those that a frame's search ran. Times are means over all frames \
               in milliseconds, Init in seconds (meshes made and turned into medial meshes). CD is this \
               crate's search: contacts, muting, first contacts and impulses; CR is the whole of rapier's \
               step, its own culling, solver and update in it; frames per second are of the whole step \
               without drawing, the paper's with. The paper's figures are from an Intel i7 5960X with an \
               NVIDIA RTX 2060 SUPER: other hardware. Brute force is on sampled frames in the same run, as \
               the paper does it: every elementary pair on straight paths, in eight lanes by the certified \
               query, and one in fifty pairs of primitives by the paper's own iteration, times fifty."
            .into(),
        note: "",
        plot: Plot::Lines {
            x: "frame",
            y: "whole step, milliseconds",
            log: [false, false],
            series: times,
        },
        head: vec![
            "benchmark", "who", "triangles", "spheres", "primitives", "elementary pairs", "tests a frame",
            "Init s", "CD ms", "CR ms", "Upd ms", "whole step ms", "FPS", "brute force, lanes ms",
            "brute force, paper's iteration ms",
        ],
        rows,
    };
    let curves = Section {
        name: "frames",
        title: "Elementary tests in each frame (Figure 8)",
        text: "The same runs, frame by frame.".into(),
        note: "",
        plot: Plot::Lines {
            x: "frame",
            y: "elementary tests run",
            log: [false, false],
            series: tests,
        },
        head: vec![
            "benchmark",
            "frame",
            "elementary tests",
            "CD ms",
            "whole step ms",
        ],
        rows: all,
    };
    Ok(vec![table, curves])
}
