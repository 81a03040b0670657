//! One elementary query: tolerance, precision and the paper's iteration; and the motion model.

use crate::ccd::families::Family;
use crate::ccd::judge::{Answer, Truth};
use crate::ccd::motion::{Motion, Query};
use crate::ccd::rng::Rng;
use crate::ccd::subject::Subject;
use crate::report::{Plot, Point, Section};
use rapier3d_medial::elementary::{AlternatingStart, ToiOptions, ToiStatus};
use std::f64::consts::PI;

/// Families with true hits in most queries, on straight paths.
const STRAIGHT: [Family; 7] = [
    Family::Translation,
    Family::Grazing,
    Family::TouchApproaching,
    Family::Thin,
    Family::Parallel,
    Family::Fast,
    Family::TwoContacts,
];

/// What a setting gave over all queries.
#[derive(Default)]
struct Outcome {
    errors: Vec<f64>,
    nanoseconds: Vec<f64>,
    iterations: u64,
    hits: usize,
    missed: usize,
    false_hits: usize,
}

impl Outcome {
    fn add(&mut self, truth: &Truth, answer: &Answer) {
        self.nanoseconds.push(answer.time.as_nanos() as f64);
        self.iterations += u64::from(answer.iterations);
        let found = answer.status != ToiStatus::Separated;
        match truth.contact.contact_at {
            Some(time) => {
                self.hits += 1;
                self.missed += usize::from(!found);
                if found {
                    self.errors.push((answer.upper - time).abs());
                }
            }
            None => self.false_hits += usize::from(found),
        }
    }

    /// Quantile of the errors of the contacts found.
    fn error(&mut self, share: f64) -> f64 {
        self.errors.sort_by(f64::total_cmp);
        let place = (self.errors.len().saturating_sub(1) as f64 * share).round() as usize;
        self.errors.get(place).copied().unwrap_or(f64::NAN)
    }

    /// Mean of the times, the slowest and fastest hundredth left out: the machine's interruptions.
    fn time(&mut self) -> f64 {
        self.nanoseconds.sort_by(f64::total_cmp);
        let cut = self.nanoseconds.len() / 100;
        let kept = &self.nanoseconds[cut..self.nanoseconds.len() - cut];
        kept.iter().sum::<f64>() / kept.len() as f64
    }

    fn cells(&mut self) -> Vec<String> {
        let queries = self.nanoseconds.len();
        vec![
            queries.to_string(),
            self.hits.to_string(),
            self.missed.to_string(),
            self.false_hits.to_string(),
            format!("{:.1e}", self.error(0.5)),
            format!("{:.1e}", self.error(0.95)),
            format!("{:.2}", self.iterations as f64 / queries as f64),
            format!("{:.0}", self.time()),
        ]
    }
}

const HEAD: [&str; 8] = [
    "queries",
    "hits",
    "missed",
    "false",
    "time error p50",
    "time error p95",
    "iterations",
    "ns",
];

/// Why a default may be off the front.
const NOTE: &str = "Faster points are certified too but less exact, or promise nothing: the table counts \
                    what they missed, which the plot cannot show.";

/// Smallest error that a plot shows, as a fraction of the step: the oracle's own is near it.
const FLOOR: f64 = 1.0e-11;

/// Tolerances 1e-2 to 1e-7 in both precisions, and the paper's iteration from either end.
pub fn tolerance(queries: usize, progress: &dyn Fn()) -> Section {
    let mut rng = Rng::new(21);
    let asked: Vec<(Query, Truth)> = (0..queries)
        .map(|k| {
            let family = STRAIGHT[k % STRAIGHT.len()];
            let query = family.query([2 + k % 2, 2], false, &mut rng);
            let truth = Truth::new(&query, 0.0);
            (query, truth)
        })
        .collect();
    let ends = AlternatingStart::End;
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (name, subject, start) in [
        ("certified, f64", Subject::Double, ends),
        ("certified, f32", Subject::Single, ends),
        ("the paper's, from t1", Subject::Paper, ends),
        (
            "the paper's, from t0",
            Subject::Paper,
            AlternatingStart::Start,
        ),
    ] {
        let mut points = Vec::new();
        for exponent in 2..=7 {
            let tolerance = 10f32.powi(-exponent);
            let mut options = ToiOptions::default();
            options.tolerance = tolerance;
            options.time_tolerance = tolerance;
            options.alternating_start = start;
            let mut outcome = Outcome::default();
            for (query, truth) in &asked {
                let answer = subject.answer(query, &options);
                outcome.add(truth, &answer.expect("straight paths are for all"));
            }
            let mut row = vec![name.to_string(), format!("1e-{exponent}")];
            row.extend(outcome.cells());
            rows.push(row);
            points.push(Point {
                label: format!("1e-{exponent}"),
                time: outcome.time(),
                error: outcome.error(0.95).max(FLOOR),
                default: subject == Subject::Double && tolerance == ToiOptions::default().tolerance,
            });
            progress();
        }
        series.push((name.to_string(), points));
    }
    let mut head = vec!["query", "tolerance"];
    head.extend(HEAD);
    Section {
        name: "tolerance",
        title: "Tolerance and precision of one query",
        text: format!(
            "{queries} pairs of cones and of slabs and cones about 1 long on straight paths, from \
             seven families (grazing, thin, fast, parallel, two contacts and others); the tolerance is \
             a length and, as a fraction of the step, the width of the bracket. The truth comes from \
             an oracle in f64 that shares no code with the queries. The error is that of the contacts \
             that were found; what was missed is in the table."
        ),
        note: NOTE,
        plot: Plot::Front {
            time: "one query, nanoseconds",
            error: "error of the time, fractions of the step, 95th percentile",
            series,
        },
        head,
        rows,
    }
}

/// Straight paths, straight paths with the sagitta added to the radii, and exact rotation.
pub fn motion(queries: usize, progress: &dyn Fn()) -> Section {
    let mut rows = Vec::new();
    let mut series: Vec<(String, Vec<Point>)> = Vec::new();
    for (label, angle) in [
        ("0.01", 0.01),
        ("0.03", 0.03),
        ("0.1", 0.1),
        ("0.3", 0.3),
        ("1", 1.0),
        ("π", PI),
    ] {
        let mut rng = Rng::new(22);
        let mut outcomes: [Outcome; 3] = Default::default();
        for k in 0..queries {
            let mut query = Family::LargeRotation.query([2 + k % 2, 2], true, &mut rng);
            turn_by(&mut query, angle);
            let truth = Truth::new(&query, 0.0);
            let straight = query.straightened();
            let thicker = inflated(&query, &straight);
            for (query, outcome) in [&straight, &thicker, &query].into_iter().zip(&mut outcomes) {
                let mut options = ToiOptions::default();
                options.tolerance = 1.0e-5;
                options.time_tolerance = 1.0e-5;
                let answer = Subject::Double.answer(query, &options);
                outcome.add(&truth, &answer.expect("any motion"));
            }
        }
        let names = ["straight", "straight, sagitta added", "exact rotation"];
        for (number, (name, mut outcome)) in names.into_iter().zip(outcomes).enumerate() {
            let mut row = vec![name.to_string(), label.to_string()];
            row.extend(outcome.cells());
            rows.push(row);
            if series.len() <= number {
                series.push((name.to_string(), Vec::new()));
            }
            series[number].1.push(Point {
                label: label.to_string(),
                time: outcome.time(),
                error: outcome.error(0.95).max(FLOOR),
                default: number == 2,
            });
        }
        progress();
    }
    let mut head = vec!["paths", "turn rad"];
    head.extend(HEAD);
    Section {
        name: "motion",
        title: "Straight paths against exact rotation",
        text: format!(
            "{queries} pairs for each angle: both bodies turn by it in the step. Straight: each \
             sphere's centre on the chord of its path, as in the paper. Sagitta added: the same with \
             |ωΔt|²ρ/8 added to each radius, which finds every contact and reports some too early or \
             that are none. The truth is the oracle's, on the exact motion; tolerance 1e-5."
        ),
        note: NOTE,
        plot: Plot::Front {
            time: "one query, nanoseconds",
            error: "error of the time, fractions of the step, 95th percentile",
            series,
        },
        head,
        rows,
    }
}

/// Makes both bodies turn by an angle in the step, about the axes that they have.
fn turn_by(query: &mut Query, angle: f64) {
    if let Motion::Rigid(motions, seconds) = &mut query.motion {
        for motion in motions.iter_mut() {
            let rate = motion.angvel.norm();
            if rate > 0.0 {
                // Rounded, so that the oracle judges the numbers that the queries get.
                let turned = motion.angvel * (angle / (rate * *seconds));
                motion.angvel = turned.map(|x| f64::from(x as f32));
            }
        }
    }
}

/// The straight query with every radius grown by what a point of the body is off its chord at most.
fn inflated(query: &Query, straight: &Query) -> Query {
    let mut thicker = straight.clone();
    if let Motion::Rigid(motions, seconds) = &query.motion {
        for (k, motion) in motions.iter().enumerate() {
            let angle = motion.angvel.norm() * seconds;
            for (ball, bent) in thicker.balls[k].iter_mut().zip(&query.balls[k]) {
                let arm = (bent.center - motion.local_center).norm();
                ball.radius += angle * angle * arm / 8.0;
            }
        }
    }
    thicker
}
