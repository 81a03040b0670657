//! The paper's three benchmarks at its sizes: Multi-bodies, two creatures (its T-rexes) and Falling
//! Rings. One table in the columns of its Tables 1 and 2, its own figures beside, and the curves of
//! its Figure 8.

use crate::benchmarks::{creatures, multi_bodies, rings};
use crate::brute_force::{Brute, brute_force};
use crate::common::scene::{Kind, Model, Scene};
use crate::report::{Plot, Section};
use rapier3d::prelude::*;
use rapier3d_medial::batch::Batch;
use rapier3d_medial::{Backend, StepReport};
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
const HEAD: [&str; 16] = [
    "benchmark",
    "who",
    "triangles",
    "spheres",
    "primitives",
    "elementary pairs",
    "tests a frame",
    "Init s",
    "CD ms",
    "rapier's CD ms",
    "CR ms",
    "Upd ms",
    "whole step ms",
    "FPS",
    "brute force, lanes ms",
    "brute force, paper's iteration ms",
];

/// What a frame took.
struct Frame {
    milliseconds: f64,
    report: StepReport,
    stages: Option<Stages>,
    /// Of brute force on the same frame, where it was done.
    brute: Option<Brute>,
}

/// Milliseconds of rapier's own step. The three together are the whole of it.
#[derive(Clone, Copy)]
struct Stages {
    /// Broad phase, narrow phase (all manifolds, those with the ground among them), sweeps.
    collisions: f64,
    /// Islands, constraints, solver.
    response: f64,
    /// The rest: sleeping, forces, poses and boxes of bodies, what the user changed.
    update: f64,
}

impl Stages {
    /// Of the last step; rapier has it only with its feature `profiler`.
    fn of(world: &PhysicsWorld) -> Option<Self> {
        let counters = &world.physics_pipeline.counters;
        let sweeps = counters.ccd.toi_computation_time.time_ms();
        let collisions = counters.collision_detection_time_ms() + sweeps;
        let stages = &counters.stages;
        let response = counters.island_construction_time_ms()
            + stages.island_constraints_collection_time.time_ms()
            + counters.solver_time_ms();
        let whole = counters.step_time_ms();
        (whole > 0.0).then_some(Self {
            collisions,
            response,
            update: whole - collisions - response,
        })
    }
}

/// Steps a scene; brute force is done on `samples` frames, evenly spread over the second half.
fn play(scene: &Scene, frames: usize, samples: usize) -> Vec<Frame> {
    let mut stage = scene.stage(Kind::Medial);
    stage.world.physics_pipeline.counters.enable();
    let every = frames / 2 / samples.max(1);
    (0..frames)
        .map(|number| {
            let before = stage.poses();
            let start = Instant::now();
            let report = stage.step();
            let milliseconds = 1.0e3 * start.elapsed().as_secs_f64();
            let sampled =
                samples > 0 && number >= frames / 2 && (number - frames / 2) % every == every / 2;
            let brute = sampled.then(|| brute_force(scene, &before, &stage.poses()));
            Frame {
                milliseconds,
                report,
                stages: Stages::of(&stage.world),
                brute,
            }
        })
        .collect()
}

fn mean(frames: &[Frame], of: impl Fn(&Frame) -> f64) -> f64 {
    frames.iter().map(of).sum::<f64>() / frames.len() as f64
}

/// Milliseconds of this crate's search: contacts of all pairs, which pairs to mute, first contacts.
fn searching(frame: &Frame) -> f64 {
    let report = &frame.report;
    1.0e3 * (report.batch_seconds + report.mute_seconds + report.event_seconds)
}

/// Who, and what a frame took; without brute force where none was done.
fn row(name: &str, who: &str, scene: &Scene, init: Option<f64>, frames: &[Frame]) -> Vec<String> {
    let sum = |of: fn(&Model) -> usize| -> String {
        let counts = scene.actors.iter().map(|a| of(&a.model));
        counts.sum::<usize>().to_string()
    };
    let brute: Vec<&Brute> = frames.iter().filter_map(|f| f.brute.as_ref()).collect();
    let brute = |digits: usize, of: fn(&Brute) -> f64| {
        let sum: f64 = brute.iter().map(|b| of(b)).sum();
        match brute.len() {
            0 => String::from("-"),
            count => format!("{:.digits$}", sum / count as f64),
        }
    };
    let stages: Option<Vec<Stages>> = frames.iter().map(|f| f.stages).collect();
    let stage = |of: fn(&Stages) -> f64| {
        let mean = |all: &Vec<Stages>| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let mean = stages.as_ref().map(mean);
        mean.map_or("in CR".into(), |mean| format!("{mean:.3}"))
    };
    let response = match stages {
        Some(_) => stage(|s| s.response),
        None => format!("{:.3}", mean(frames, |f| 1.0e3 * f.report.step_seconds)),
    };
    let whole = mean(frames, |f| f.milliseconds);
    vec![
        name.to_string(),
        who.to_string(),
        sum(|m| m.mesh.indices.len()),
        sum(|m| m.medial.spheres().len()),
        sum(|m| m.medial.primitive_count()),
        brute(0, |b| b.tests as f64),
        format!("{:.0}", mean(frames, |f| f.report.elementary_tests as f64)),
        init.map_or("-".into(), |seconds| format!("{seconds:.1}")),
        format!("{:.3}", mean(frames, searching)),
        stage(|s| s.collisions),
        response,
        stage(|s| s.update),
        format!("{whole:.3}"),
        format!("{:.0}", 1.0e3 / whole),
        brute(1, |b| b.lanes_milliseconds),
        brute(0, |b| b.paper_milliseconds),
    ]
}

fn papers(number: usize) -> Vec<String> {
    let mut row = vec![NAMES[number], "paper"];
    row.extend(PAPER[number]);
    // What it does not tell: tests of a frame, two parts of our step, brute force, which its CD is.
    for place in [6, 9, 12, 14, 15] {
        row.insert(place, "-");
    }
    row.into_iter().map(String::from).collect()
}

/// The name of the device that batches go to, or why there is none.
fn device() -> Result<String, String> {
    let batch = Batch::new(Backend::Gpu);
    #[cfg(feature = "gpu")]
    if let Some(gpu) = batch.gpu() {
        return Ok(gpu.name().to_string());
    }
    let error = batch.report().error.as_ref();
    Err(error.map_or("no device".into(), ToString::to_string))
}

/// The same on a device, or a row that says why not.
fn row_of_device(name: &str, scene: &mut Scene, frames: usize) -> Vec<String> {
    match device() {
        Ok(device) => {
            scene.backend = Backend::Gpu;
            let who = format!("this crate on {device}");
            row(name, &who, scene, None, &play(scene, frames, 0))
        }
        Err(reason) => {
            let mut row = vec!["-".to_string(); HEAD.len()];
            row[0] = name.into();
            row[1] = format!("this crate on a device: {reason}");
            row
        }
    }
}

/// The table, and a plot of elementary tests and one of times over the frames.
pub fn measure(quick: bool, progress: &dyn Fn()) -> Result<Vec<Section>, String> {
    let (frames, samples) = if quick { (120, 1) } else { (300, 3) };
    let mut rows = Vec::new();
    let (mut tests, mut times, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for (number, name) in NAMES.into_iter().enumerate() {
        let start = Instant::now();
        let mut scene = match number {
            0 => multi_bodies(quick)?,
            1 => creatures(quick)?,
            _ => rings()?,
        };
        let init = start.elapsed().as_secs_f64();
        progress();
        let played = play(&scene, frames, samples);
        progress();
        rows.push(row(name, "this crate", &scene, Some(init), &played));
        rows.push(row_of_device(name, &mut scene, frames));
        progress();
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
                f.report.continuous_queries.to_string(),
                f.report.cache_misses.to_string(),
                format!("{:.3}", searching(f)),
                f.stages
                    .map_or("-".into(), |s| format!("{:.3}", s.collisions)),
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
               crate's search: contacts, muting, first contacts and impulses. The other three are rapier's \
               step, by its own counters (<code>--features rapier3d/profiler</code>; all in CR without): its \
               CD is broad and narrow phase, manifolds with the ground among them, and sweeps; CR is islands, \
               constraints and solver; Upd is all the rest. Frames per second are of the whole step without \
               drawing, the paper's with. The paper's figures are from an Intel i7 5960X with an NVIDIA RTX \
               2060 SUPER: other hardware; its CD is that of every elementary pair. Rows on a device are the \
               same worlds with batches that go through it (<code>--features gpu</code>). Brute force is on \
               sampled frames in the same run, as the paper does it: every elementary pair on straight paths, \
               in eight lanes by the certified query, and one in fifty pairs of primitives by the paper's own \
               iteration, times fifty."
            .into(),
        note: "",
        plot: Plot::Lines {
            x: "frame",
            y: "whole step, milliseconds",
            log: [false, false],
            series: times,
        },
        head: HEAD.to_vec(),
        rows,
    };
    let curves = Section {
        name: "frames",
        title: "Elementary tests in each frame (Figure 8)",
        text: "The same runs, frame by frame. Continuous queries are first contacts, those of rapier's \
               sweeps against fixed bodies among them; pairs out of batch had their contacts computed when \
               rapier asked, as no one had foreseen them."
            .into(),
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
            "continuous queries",
            "pairs out of batch",
            "CD ms",
            "rapier's CD ms",
            "whole step ms",
        ],
        rows: all,
    };
    Ok(vec![table, curves])
}
