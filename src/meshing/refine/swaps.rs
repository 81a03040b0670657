//! Swaps: primitives move from where they matter least to where the error is largest.
//!
//! A round removes the cheapest, inserts as many where the draft is worst (`insert.rs`), refits
//! (`refit.rs`), and keeps the result if its score is better. Rounds remove fewer and fewer. It is local
//! search: no bound on the result, but never a worse score. The cheapest are so by measured cost
//! (`measured_collapse.rs`); among many primitives by the quadrics', which is as good there and far quicker.

use crate::error::BuildError;
use crate::meshing::draft::Draft;
use crate::meshing::refine::insert::insert;
use crate::meshing::refine::measured_collapse::reduce_measured;
use crate::meshing::refine::refit::{FitTarget, refit};
use crate::meshing::simplify::ball_quadrics::BOUNDARY_WEIGHT_SOLID;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::watch::Watch;

/// Number of primitives above which measured cost no longer beats the quadrics' and takes too long.
pub const LARGE: usize = 1000;

/// Rounds end where two in turn leave scores above this many of the best: what they took out they cannot put back.
const MAX_SCORE_RATIO: f64 = 1.4;

/// A fitted draft and its score.
pub type Scored = (Draft, f64);

/// How much is swapped.
#[derive(Clone, Copy)]
pub struct Swaps {
    /// Share of the primitives that the first round moves; later ones move less.
    pub share: f64,
    /// Rounds.
    pub rounds: usize,
    /// Insertions within a round: with fewer than three most rounds of small counts fail.
    pub insertions: usize,
    /// Iterations of the refit that ends each.
    pub iterations: usize,
}

/// Swaps among `most` primitives: the start, and after it each draft that is better than all before.
pub fn swap(
    start: Scored,
    target: &FitTarget,
    most: usize,
    swaps: Swaps,
    watch: &mut Watch,
) -> Result<Vec<Scored>, BuildError> {
    let mut drafts = Vec::new();
    let mut best = start;
    let mut hopeless = 0;
    for round in 0..swaps.rounds {
        let removed = swaps.share * most as f64 / (1.0 + 0.5 * round as f64);
        let removed = (removed as usize).max(2);
        // Below that nothing is left to hang the new ones on. A round beyond the budget of fits is not begun.
        if removed + 2 > most || watch.ends_fit(target.budget) {
            break;
        }
        watch.begin("swaps")?;
        let (weight, tree) = (BOUNDARY_WEIGHT_SOLID, target.tree);
        let simplifier = Simplifier::new(best.0.clone(), weight, tree, watch)?;
        let mut draft = remove(simplifier, most - removed, target, watch)?;
        grow(&mut draft, target, most, swaps.insertions, watch)?;
        watch.begin("refit")?;
        let score = refit(&mut draft, target, swaps.iterations, watch)?;
        hopeless = if score > MAX_SCORE_RATIO * best.1 {
            hopeless + 1
        } else {
            0
        };
        if hopeless >= 2 {
            break;
        }
        if score < best.1 {
            drafts.push(std::mem::replace(&mut best, (draft, score)));
        }
    }
    drafts.push(best);
    Ok(drafts)
}

/// Collapses by measured cost, over half of the samples, up to [`LARGE`] primitives; above by the
/// quadrics'.
pub fn remove(
    mut simplifier: Simplifier,
    most: usize,
    target: &FitTarget,
    watch: &mut Watch,
) -> Result<Draft, BuildError> {
    if most > LARGE {
        simplifier.reduce_to(most, watch)?;
    } else {
        let samples = target.samples.iter().step_by(2).map(|s| s.point);
        reduce_measured(&mut simplifier, most, samples.collect(), target.tree, watch)?;
    }
    Ok(simplifier.draft())
}

/// Inserts up to `most` primitives in `rounds`, with a short refit after each but the last, as far as the budget of
/// fits goes.
pub fn grow(
    draft: &mut Draft,
    target: &FitTarget,
    most: usize,
    rounds: usize,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    for round in 0..rounds {
        let left = most.saturating_sub(draft.primitives().len());
        if left == 0 || watch.ends_fit(target.budget) {
            break;
        }
        watch.begin("insert")?;
        let added = insert(draft, target, left.div_ceil(rounds - round), watch)?;
        if round + 1 < rounds && added > 0 {
            watch.begin("refit")?;
            refit(draft, target, 2, watch)?;
        }
    }
    Ok(())
}
