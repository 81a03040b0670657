//! An error instead of a count: the fewest primitives that keep it.

use super::candidate::Candidate;
use super::draft::Draft;
use super::fit;
use super::parts::Parts;
use super::pipeline::Source;
use super::watch::Watch;
use crate::error::BuildError;

/// Counts tried when the error is the limit shrink by this factor from one to the next.
const LADDER: f64 = 0.8;

impl Source {
    /// The fewest primitives whose error is at most `max_error`, among counts in ratio [`LADDER`].
    pub fn coarsest(
        &self,
        simplifier: &mut Parts,
        max_error: f64,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let mut rungs = vec![simplifier.draft()];
        while simplifier.primitives() > 1 {
            watch.begin("simplify")?;
            let next = (simplifier.primitives() as f64 * LADDER) as usize;
            let before = simplifier.primitives();
            simplifier.reduce_to(next, watch)?;
            if simplifier.primitives() == before {
                break;
            }
            rungs.push(simplifier.draft());
        }
        let finest = rungs[0].primitives().len();
        let mut best: Option<Candidate> = None;
        // Rungs below `fine` keep the limit, rungs from `coarse` on break it.
        let (mut fine, mut coarse) = (0, rungs.len());
        while fine < coarse {
            let middle = fine + (coarse - fine) / 2;
            let candidate = self.rung(rungs[middle].clone(), watch)?;
            if candidate.error() <= max_error {
                fine = middle + 1;
                best = Some(candidate);
            } else {
                coarse = middle;
            }
        }
        let (mut candidate, binding) = match best {
            Some(candidate) => (candidate, "max_error"),
            None => (self.rung(rungs.swap_remove(0), watch)?, "primitives"),
        };
        let count = candidate.draft.primitives().len();
        let error = candidate.error();
        candidate.notes.push(match (binding, self.limits.primitives) {
            ("max_error", _) if count < finest => {
                format!("max_error {max_error} bound first: {count} primitives, error {error:.5}")
            }
            ("max_error", _) => format!("error {error:.5} is within max_error {max_error}"),
            (_, Some(most)) => format!(
                "primitives {most} bound first: error {error:.5} is above max_error {max_error}"
            ),
            (_, None) => format!(
                "max_error {max_error} is out of reach: error {error:.5} with all {count} primitives"
            ),
        });
        Ok(candidate)
    }

    /// A rung of the ladder as the quality wants it: fitted where it is above [`Quality::Fast`].
    fn rung(&self, draft: Draft, watch: &mut Watch) -> Result<Candidate, BuildError> {
        if !self.fits() {
            return self.finish(draft, watch);
        }
        let target = self.target(draft.primitives().len());
        let (draft, _) = fit::refitted(draft, &target, watch)?;
        self.finish(draft, watch)
    }
}
