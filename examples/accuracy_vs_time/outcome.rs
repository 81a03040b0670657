//! What a set of motions gave, beside the time at which the triangles first touch.

use crate::crash::{Case, Crash};
use std::time::Instant;

/// Answers to all motions of one setting.
#[derive(Default)]
pub struct Outcome {
    /// Of each true contact that was found: seconds after it, negative when before.
    pub errors: Vec<f64>,
    /// Microseconds of each query.
    pub microseconds: Vec<f64>,
    /// Contacts of the triangles in these motions.
    pub hits: usize,
    /// Those of them that were not reported.
    pub missed: usize,
    /// Contacts reported where the triangles have none.
    pub ghosts: usize,
    /// Answers at whose time the triangles are further apart than the shapes are off, and contacts
    /// missed.
    pub beyond_shape: usize,
    /// Farthest that the triangles were apart at the time of an answer, in metres.
    pub farthest: f64,
}

impl Outcome {
    /// Asks `query` for each case; `allowed` is how far the shapes are off.
    pub fn of<'a>(
        crash: &Crash,
        allowed: f64,
        cases: impl IntoIterator<Item = &'a Case>,
        mut query: impl FnMut(&Case) -> Option<f64>,
        progress: &dyn Fn(),
    ) -> Self {
        let mut outcome = Self::default();
        for case in cases {
            let start = Instant::now();
            let found = query(case);
            let elapsed = start.elapsed().as_secs_f64();
            outcome.microseconds.push(elapsed * 1e6);
            outcome.hits += usize::from(case.time.is_some());
            match (case.time, found) {
                (Some(time), Some(found)) => outcome.errors.push(found - time),
                (Some(_), None) => {
                    outcome.missed += 1;
                    outcome.beyond_shape += 1;
                }
                (None, Some(_)) => outcome.ghosts += 1,
                (None, None) => {}
            }
            if let Some(found) = found {
                let apart = crash.distance(case, found);
                outcome.farthest = outcome.farthest.max(apart);
                outcome.beyond_shape += usize::from(apart > allowed);
            }
            progress();
        }
        outcome
    }

    /// Quantile of the sizes of the errors.
    pub fn error(&self, share: f64) -> f64 {
        let sizes: Vec<f64> = self.errors.iter().map(|e| e.abs()).collect();
        quantile(&sizes, share)
    }

    /// Latest that a contact was found after the true time.
    pub fn latest(&self) -> f64 {
        self.errors.iter().copied().fold(0.0, f64::max)
    }
}

/// The value below which such a share of all lies; not a number where there are none.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
    sorted.get(place).copied().unwrap_or(f64::NAN)
}
