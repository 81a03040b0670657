//! Sizes and representations: what the bodies collide as against when they touch.

use crate::bodies::Bodies;
use crate::crash::{Case, Crash, SPEEDS, TURNS, parry_motion};
use crate::outcome::{Outcome, quantile};
use crate::report::{Plot, Point, Section};
use crate::stack::stack;
use rapier3d_medial::BuildOptions;

const HEAD: [&str; 18] = [
    "representation",
    "parts",
    "build s",
    "memory kB",
    "shape error m",
    "motions",
    "hits",
    "missed",
    "ghosts",
    "beyond shape error",
    "farthest apart m",
    "latest s",
    "time error p50 s",
    "time error p95 s",
    "query p50 us",
    "query p95 us",
    "step ms",
    "tests a step",
];

/// Metres that parry's casts leave between bodies at the time of their answer.
const PARRYS: f64 = 2.0e-4;

/// What of it is plotted against the number of primitives.
const SIZE: [usize; 7] = [0, 1, 4, 13, 14, 16, 17];

/// All representations over all motions; slow ones over a share of them.
pub fn measure(
    crash: &Crash,
    medial: &[Bodies],
    peers: &[Bodies],
    progress: &dyn Fn(),
) -> Vec<Section> {
    let default = BuildOptions::default().primitives.unwrap_or(0);
    let mut rows = Vec::new();
    let mut series = Vec::new();
    let (mut steps, mut queries) = (Vec::new(), Vec::new());
    for (name, group) in [("medial meshes", medial), ("parry's shapes", peers)] {
        let mut points = Vec::new();
        for bodies in group {
            let cases = crash.cases.iter().step_by(bodies.every);
            let outcome = outcome(crash, bodies, cases, progress);
            let time = quantile(&outcome.microseconds, 0.5);
            let stack = stack(bodies, &crash.meshes[0]);
            rows.push(vec![
                bodies.name.clone(),
                bodies.parts.to_string(),
                format!("{:.2}", bodies.seconds),
                format!("{:.0}", bodies.kilobytes),
                format!("{:.4}", bodies.shape_error),
                outcome.microseconds.len().to_string(),
                outcome.hits.to_string(),
                outcome.missed.to_string(),
                outcome.ghosts.to_string(),
                outcome.beyond_shape.to_string(),
                format!("{:.4}", outcome.farthest),
                format!("{:.1e}", outcome.latest()),
                format!("{:.2e}", outcome.error(0.5)),
                format!("{:.2e}", outcome.error(0.95)),
                format!("{time:.1}"),
                format!("{:.1}", quantile(&outcome.microseconds, 0.95)),
                format!("{:.3}", stack.milliseconds),
                stack
                    .tests
                    .map_or("-".into(), |tests| format!("{tests:.0}")),
            ]);
            if bodies.is_medial() {
                let parts = bodies.parts as f64;
                steps.push((parts, stack.milliseconds));
                queries.push((parts, time / 1.0e3));
            }
            let error = outcome.error(0.95);
            if error.is_finite() {
                points.push(Point {
                    default: bodies.name == format!("medial mesh, {default}"),
                    label: bodies.name.replace("medial mesh, ", ""),
                    time,
                    error: error.max(1.0e-6),
                });
            }
        }
        series.push((name.to_string(), points));
    }
    let sized = medial.iter().zip(&rows);
    let sized = sized.map(|(_, row)| SIZE.map(|column| row[column].clone()).to_vec());
    let sizes = Section {
        name: "sizes",
        title: "Query and step by number of primitives (the paper's Figure 16 and Table 4)",
        text: "The medial meshes of the table above: one continuous query of creature and blob, median, \
               and a whole step, mean, while three creatures fall on each other and come to lie: three \
               seconds, five times. The step is rapier's with this crate's hook, on one core."
            .into(),
        note: "",
        plot: Plot::Lines {
            x: "primitives of the creature",
            y: "milliseconds",
            log: [true, true],
            series: vec![("whole step".into(), steps), ("one query".into(), queries)],
        },
        head: SIZE.map(|column| HEAD[column]).to_vec(),
        rows: sized.collect(),
    };
    let table = Section {
        name: "representations",
        title: "What the bodies collide as",
        text: format!(
            "A spiky creature, 4 m wide, flies into a blob for one second: speeds of {SPEEDS:?} widths a \
             second, turns of {TURNS:.1?} radians. The truth is when their triangles touch, by conservative \
             advancement on exact distances of triangles. The error is that of the contact's time, 95th \
             percentile over the contacts found. Beyond shape error counts contacts that were missed, \
             and answers at whose time the triangles were further apart than the two shapes are off, as \
             the builder bounds it (of parry's shapes: as measured at points of both surfaces). Memory is \
             what the creature's shape keeps allocated. A step is one of three creatures that fall on each \
             other, rapier's with this crate's hook or alone, mean over three seconds, five \
             times. Triangle meshes and voxels answer every hundredth motion: they take long."
        ),
        note: "A coarser mesh is answered sooner, a finer one is nearer; a decomposition into convex \
               parts touches at the right time where only tips meet, and takes longer.",
        plot: Plot::Front {
            time: "one continuous query, microseconds, median",
            error: "error of the time of impact, seconds, 95th percentile",
            series,
        },
        head: HEAD.to_vec(),
        rows,
    };
    vec![table, sizes]
}

fn outcome<'a>(
    crash: &Crash,
    bodies: &Bodies,
    cases: impl IntoIterator<Item = &'a Case>,
    progress: &dyn Fn(),
) -> Outcome {
    let allowed = match bodies.is_medial() {
        true => bodies.shape_error,
        false => bodies.shape_error + PARRYS,
    };
    let query = |case: &Case| {
        let [a, b] = case.motions.each_ref().map(parry_motion);
        bodies.first_contact([&a, &b])
    };
    Outcome::of(crash, allowed, cases, query, progress)
}

/// The paper's Figure 11: one medial mesh, a cell for each linear and angular speed.
pub fn grid(crash: &Crash, bodies: &Bodies, progress: &dyn Fn()) -> Section {
    let mut rows = Vec::new();
    let mut series = Vec::new();
    let per_cell = crash.cases.len() / (SPEEDS.len() * TURNS.len());
    let mut cells = crash.cases.chunks(per_cell);
    for speed in SPEEDS {
        let mut points = Vec::new();
        for turn in TURNS {
            let cell = cells.next().unwrap_or_default();
            let outcome = outcome(crash, bodies, cell, progress);
            rows.push(vec![
                bodies.name.clone(),
                format!("{speed}"),
                format!("{turn:.1}"),
                cell.len().to_string(),
                outcome.hits.to_string(),
                outcome.missed.to_string(),
                outcome.ghosts.to_string(),
                outcome.beyond_shape.to_string(),
                format!("{:.4}", bodies.shape_error),
                format!("{:.4}", outcome.farthest),
                format!("{:.1e}", outcome.latest()),
                format!("{:.1e}", outcome.error(0.5)),
                format!("{:.1e}", outcome.error(0.95)),
            ]);
            if !outcome.errors.is_empty() {
                points.push((turn, outcome.error(0.5).max(1.0e-6)));
            }
        }
        series.push((format!("{speed} widths/s"), points));
    }
    Section {
        name: "grid",
        title: "Linear speed by angular speed (the paper's Figure 11)",
        text: "The same motions, cell by cell, for one medial mesh: the error of the time of impact. At \
               the time of each answer the triangles are at most as far apart as the shapes are off; the \
               table has both. The slower the creature, the longer it takes to cover that distance."
            .into(),
        note: "",
        plot: Plot::Lines {
            x: "turn in the second, radians",
            y: "error of the time of impact, seconds, median",
            log: [false, true],
            series,
        },
        head: vec![
            "mesh",
            "widths/s",
            "turn rad",
            "motions",
            "hits",
            "missed",
            "ghosts",
            "beyond shape error",
            "shape error m",
            "farthest apart m",
            "latest s",
            "time error p50 s",
            "time error p95 s",
        ],
        rows,
    }
}
