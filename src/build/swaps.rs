//! Swaps: primitives move from where they matter least to where the error is largest.
//!
//! A round removes the cheapest by measured cost (`measured.rs`), inserts as many where the draft is
//! worst (`insert.rs`), refits (`refit.rs`), and keeps the result if its score is better. Rounds
//! remove fewer and fewer. It is local search: no bound on the result, but never a worse score.

use super::draft::Draft;
use super::insert::insert;
use super::measured::reduce_measured;
use super::refit::{Target, refit};
use super::simplify::{BOUNDARY_WEIGHT_SOLID, Simplifier};
use super::watch::Watch;
use crate::error::BuildError;

/// A fitted draft and its score.
pub type Scored = (Draft, f64);

/// `rounds` of swaps of the share `share` of `most` primitives, less in each later round.
pub fn swap(
    start: Scored,
    target: &Target,
    most: usize,
    share: f64,
    rounds: usize,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    let (mut best, mut score) = start;
    for round in 0..rounds {
        let removed = share * most as f64 / (1.0 + 0.5 * round as f64);
        let removed = (removed as usize).max(2);
        // Below that nothing is left to hang the new ones on.
        if removed + 2 > most {
            break;
        }
        watch.begin("swaps")?;
        let simplifier = Simplifier::new(best.clone(), BOUNDARY_WEIGHT_SOLID, target.tree, watch)?;
        let mut draft = remove(simplifier, most - removed, target, watch)?;
        grow(&mut draft, target, most, 2, watch)?;
        watch.begin("refit")?;
        let new = refit(&mut draft, target, 4, watch)?;
        if new < score {
            (best, score) = (draft, new);
        }
    }
    Ok((best, score))
}

/// Collapses by measured cost, over half of the samples where there are few primitives.
pub fn remove(
    mut simplifier: Simplifier,
    most: usize,
    target: &Target,
    watch: &mut Watch,
) -> Result<Draft, BuildError> {
    let every = if most < 1000 { 2 } else { 1 };
    let samples = target.samples.iter().step_by(every).map(|s| s.point);
    reduce_measured(&mut simplifier, most, samples.collect(), target.tree, watch)?;
    Ok(simplifier.draft())
}

/// Inserts up to `most` primitives in `rounds`, with a short refit after each but the last.
pub fn grow(
    draft: &mut Draft,
    target: &Target,
    most: usize,
    rounds: usize,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    for round in 0..rounds {
        let left = most.saturating_sub(draft.primitives().len());
        if left == 0 {
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
