//! Sizes and representations: what the bodies collide as against when they touch.

use crate::bodies::Bodies;
use crate::crash::{Case, Crash, SPEEDS, TURNS, parry_motion};
use crate::report::{Point, Section};
use rapier3d_medial::BuildOptions;
use std::time::Instant;

/// What the motions gave in one representation.
#[derive(Default)]
struct Outcome {
    /// Of each true contact that was found: seconds after it, negative when before.
    errors: Vec<f64>,
    /// Microseconds of each query.
    microseconds: Vec<f64>,
    /// Contacts of the triangles that were not reported.
    missed: usize,
    /// Contacts reported where the triangles have none.
    ghosts: usize,
    /// Of the missed and the ghosts: more than the shapes' error away from being right.
    beyond_shape: usize,
}

impl Outcome {
    fn of(crash: &Crash, bodies: &Bodies, cases: &[&Case], progress: &dyn Fn()) -> Self {
        let mut outcome = Self::default();
        for case in cases {
            let [a, b] = case.motions.each_ref().map(parry_motion);
            let start = Instant::now();
            let found = bodies.first_contact([&a, &b]);
            outcome
                .microseconds
                .push(start.elapsed().as_secs_f64() * 1e6);
            let reach = |time: f64| {
                let allowed = bodies.shape_error.unwrap_or(f64::INFINITY);
                usize::from(crash.distance(case, time) > allowed)
            };
            match (case.time, found) {
                (Some(time), Some(found)) => {
                    outcome.errors.push(found - time);
                    outcome.beyond_shape += reach(found);
                }
                (Some(_), None) => outcome.missed += 1,
                (None, Some(found)) => {
                    outcome.ghosts += 1;
                    outcome.beyond_shape += reach(found);
                }
                (None, None) => {}
            }
            progress();
        }
        outcome
    }

    fn quantile(values: &[f64], share: f64) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let place = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
        sorted.get(place).copied().unwrap_or(f64::NAN)
    }
}

/// All representations over all motions; slow ones over a share of them.
pub fn measure(
    crash: &Crash,
    medial: Vec<Bodies>,
    peers: Vec<Bodies>,
    progress: &dyn Fn(),
) -> Section {
    let head = vec![
        "representation",
        "parts",
        "build s",
        "shape error m",
        "motions",
        "hits",
        "missed",
        "ghosts",
        "beyond shape error",
        "time error p50 s",
        "time error p95 s",
        "query p50 us",
        "query p95 us",
    ];
    let default = BuildOptions::default().primitives.unwrap_or(0);
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (name, group) in [("medial meshes", medial), ("parry's shapes", peers)] {
        let mut points = Vec::new();
        for bodies in group {
            // Every fiftieth motion of what takes a second for each.
            let share = if bodies.name == "triangle mesh" {
                50
            } else {
                1
            };
            let cases: Vec<&Case> = crash.cases.iter().step_by(share).collect();
            let outcome = Outcome::of(crash, &bodies, &cases, progress);
            let sizes: Vec<f64> = outcome.errors.iter().map(|e| e.abs()).collect();
            let hits = cases.iter().filter(|c| c.time.is_some()).count();
            let (half, most) = (
                Outcome::quantile(&sizes, 0.5),
                Outcome::quantile(&sizes, 0.95),
            );
            let time = Outcome::quantile(&outcome.microseconds, 0.5);
            rows.push(vec![
                bodies.name.clone(),
                bodies.parts.to_string(),
                format!("{:.2}", bodies.seconds),
                bodies.shape_error.map_or("-".into(), |e| format!("{e:.4}")),
                cases.len().to_string(),
                hits.to_string(),
                outcome.missed.to_string(),
                outcome.ghosts.to_string(),
                bodies
                    .shape_error
                    .map_or("-".into(), |_| outcome.beyond_shape.to_string()),
                format!("{half:.2e}"),
                format!("{most:.2e}"),
                format!("{time:.1}"),
                format!("{:.1}", Outcome::quantile(&outcome.microseconds, 0.95)),
            ]);
            points.push(Point {
                default: bodies.name == format!("medial mesh, {default}"),
                label: bodies.name,
                time,
                error: most,
            });
        }
        series.push((name.to_string(), points));
    }
    let text = format!(
        "A spiky creature, 4 m wide, flies into a blob for one second: speeds of {SPEEDS:?} widths a \
         second, turns of {TURNS:?} radians. The truth is when their triangles touch, by conservative \
         advancement on exact distances of triangles. The error is that of the contact's time, 95th \
         percentile over the contacts found; beyond shape error counts the answers at whose time the \
         triangles were further apart than the two shapes are off."
    );
    Section {
        name: "representations",
        title: "What the bodies collide as",
        text,
        time_axis: "one continuous query, microseconds, median",
        error_axis: "error of the time of impact, seconds, 95th percentile",
        head,
        rows,
        series,
    }
}
