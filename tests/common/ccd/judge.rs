//! Verdicts on answers to continuous collision queries, and their tallies.
//!
//! A verdict of missed, late or false is a proof of guilt: it holds with all rounding of the oracle
//! taken in favour of the answer.

use super::contact::{FirstContact, distance_at, first_contact};
use super::motion::{Paths, Query};
use super::passage::met_by;
use rapier3d_medial::elementary::ToiStatus;
use std::time::Duration;

/// An answer, its numbers exactly as given.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// What the numbers mean.
    pub status: ToiStatus,
    /// No contact before this fraction of the step.
    pub lower: f64,
    /// Contact within the tolerance at this fraction of the step.
    pub upper: f64,
    /// The contact distance used.
    pub tolerance: f64,
    /// Iterations spent.
    pub iterations: u32,
    /// Time spent.
    pub time: Duration,
}

/// What the oracle knows of a query.
pub struct Truth {
    paths: Paths,
    target: f64,
    /// First contact. That of bodies without any thickness is told where they have surely met.
    pub contact: FirstContact,
}

impl Truth {
    /// Asks the oracle when the signed distance first is at most `target`.
    pub fn new(query: &Query, target: f64) -> Self {
        let paths = Paths::new(query);
        let rounding = paths.rounding();
        let contact = if paths.is_thin() && target < 2.0 * rounding {
            // They touch at a distance of 0 and never below, which rounding cannot tell from apart.
            let near = first_contact(&paths, 2.0 * rounding);
            let at = near.contact_at.unwrap_or(near.free_until);
            FirstContact {
                contact_at: Some(at)
                    .filter(|at| *at < 1.0)
                    .and_then(|at| met_by(&paths, at)),
                ..near
            }
        } else {
            first_contact(&paths, target)
        };
        Self {
            paths,
            target,
            contact,
        }
    }

    /// Whether the bodies surely touch within the step.
    pub fn is_hit(&self) -> bool {
        self.contact.contact_at.is_some()
    }

    /// Judges an answer whose bracket should be at most `width` wide, and how sharp it is.
    pub fn judge(&self, answer: &Answer, width: f64) -> Verdict {
        let mut verdict = self.convict(answer, width);
        if answer.status == ToiStatus::Contact {
            verdict.early = Some(self.early(answer));
        }
        verdict
    }

    /// As [`Self::judge`], but for how early it is: with a tolerance of a few roundings that takes a
    /// hundred times as long as all the rest.
    pub fn convict(&self, answer: &Answer, width: f64) -> Verdict {
        let mut verdict = Verdict::default();
        // Bounds of how far the bodies are from what counts as contact.
        let gap = |time: f64| {
            let (lower, upper) = distance_at(&self.paths, time);
            (lower - self.target, upper - self.target)
        };
        let start = gap(0.0);
        let deep_at_start = start.1 < -answer.tolerance;
        match answer.status {
            ToiStatus::Separated => verdict.missed = self.is_hit(),
            ToiStatus::Contact => {
                verdict.false_hit = gap(answer.upper).0 > answer.tolerance;
                let before = |contact: f64| (contact - answer.lower).max(0.0);
                let contact = self
                    .contact
                    .contact_at
                    .filter(|_| start.0 > answer.tolerance);
                verdict.before = contact.map(before);
                verdict.width = Some(answer.upper - answer.lower);
                verdict.wide = answer.upper - answer.lower > width;
                verdict.misnamed = deep_at_start;
            }
            ToiStatus::Overlapping => {
                verdict.false_hit = start.0 > answer.tolerance;
                verdict.misnamed = answer.lower != 0.0 || answer.upper != 0.0;
            }
            ToiStatus::Unresolved => verdict.unresolved = true,
        }
        if answer.status != ToiStatus::Separated {
            let contact = self.contact.contact_at.unwrap_or(1.0);
            verdict.late = (answer.lower - contact).max(0.0);
        }
        verdict
    }

    /// By how much `lower` precedes the time at which the tolerance is reached.
    fn early(&self, answer: &Answer) -> f64 {
        let reached = self.target + answer.tolerance;
        if distance_at(&self.paths, answer.lower).1 <= reached {
            return 0.0;
        }
        let reached = first_contact(&self.paths, reached).free_until;
        (reached - answer.lower).max(0.0)
    }
}

/// What is wrong with an answer, and how sharp it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Verdict {
    /// Separated, but there is contact.
    pub missed: bool,
    /// By how much `lower` exceeds the true contact time; 0 when it does not.
    pub late: f64,
    /// Contact, but the bodies are further apart at `upper` than the tolerance.
    pub false_hit: bool,
    /// Overlapping at the start by more than the tolerance without saying so, or saying so with
    /// times that are not 0.
    pub misnamed: bool,
    /// The bracket is wider than asked.
    pub wide: bool,
    /// Iteration cap reached.
    pub unresolved: bool,
    /// By how much `lower` precedes the time at which the tolerance is reached.
    pub early: Option<f64>,
    /// By how much `lower` precedes the true contact, where there is one and the bodies are not within
    /// the tolerance from the start on. A body that nears another at speed `v` is within the
    /// tolerance by `tolerance / v` before it touches, and contact may be told from then on.
    pub before: Option<f64>,
    /// Width of the bracket.
    pub width: Option<f64>,
}

/// Verdicts on many answers.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Answers judged.
    pub queries: usize,
    /// Queries with contact.
    pub hits: usize,
    /// See [`Verdict`].
    pub missed: usize,
    /// Answers late by more than what is allowed.
    pub late: usize,
    /// See [`Verdict`].
    pub false_hits: usize,
    /// See [`Verdict`].
    pub misnamed: usize,
    /// See [`Verdict`].
    pub wide: usize,
    /// See [`Verdict`].
    pub unresolved: usize,
    /// Sum of iterations.
    pub iterations: u64,
    /// Most iterations.
    pub most_iterations: u32,
    early: Vec<f32>,
    before: Vec<f32>,
    width: Vec<f32>,
    /// Time of each answer.
    pub nanoseconds: Vec<f32>,
}

impl Tally {
    /// Adds the tally of other queries.
    pub fn merge(&mut self, other: Self) {
        self.queries += other.queries;
        self.hits += other.hits;
        self.missed += other.missed;
        self.late += other.late;
        self.false_hits += other.false_hits;
        self.misnamed += other.misnamed;
        self.wide += other.wide;
        self.unresolved += other.unresolved;
        self.iterations += other.iterations;
        self.most_iterations = self.most_iterations.max(other.most_iterations);
        self.early.extend(other.early);
        self.before.extend(other.before);
        self.width.extend(other.width);
        self.nanoseconds.extend(other.nanoseconds);
    }

    /// Adds a verdict; an answer counts as late beyond `late_by`.
    pub fn add(&mut self, truth: &Truth, answer: &Answer, verdict: &Verdict, late_by: f64) {
        self.nanoseconds.push(answer.time.as_nanos() as f32);
        self.queries += 1;
        self.hits += usize::from(truth.is_hit());
        self.missed += usize::from(verdict.missed);
        self.late += usize::from(verdict.late > late_by);
        self.false_hits += usize::from(verdict.false_hit);
        self.misnamed += usize::from(verdict.misnamed);
        self.wide += usize::from(verdict.wide);
        self.unresolved += usize::from(verdict.unresolved);
        self.iterations += u64::from(answer.iterations);
        self.most_iterations = self.most_iterations.max(answer.iterations);
        self.early.extend(verdict.early.map(|x| x as f32));
        self.before.extend(verdict.before.map(|x| x as f32));
        self.width.extend(verdict.width.map(|x| x as f32));
    }

    /// Median and 99th percentile of how long before true contacts `lower` is.
    pub fn before(&mut self) -> [f32; 2] {
        percentiles(&mut self.before)
    }

    /// Median and 99th percentile of how early contacts are told.
    pub fn early(&mut self) -> [f32; 2] {
        percentiles(&mut self.early)
    }

    /// Median and 99th percentile of the bracket's width.
    pub fn width(&mut self) -> [f32; 2] {
        percentiles(&mut self.width)
    }
}

/// Median and 99th percentile; 0 of nothing.
pub fn percentiles(values: &mut [f32]) -> [f32; 2] {
    values.sort_unstable_by(f32::total_cmp);
    let last = values.len().saturating_sub(1);
    [0.5, 0.99].map(|p| {
        values
            .get((p * last as f64) as usize)
            .copied()
            .unwrap_or(0.0)
    })
}
