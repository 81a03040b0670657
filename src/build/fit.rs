//! The recipe from a plain collapse to a fitted draft: starts, refits, insertion, swaps.
//!
//! One recipe for all models; every number depends on the count of primitives and the quality only.
//! A start with fewer primitives than wanted is refitted and grown where it is worst: that finds
//! tips and thin parts that a collapse gave up. Small counts scatter, so several starts are tried.

use super::draft::Draft;
use super::random::Random;
use super::refit::{Target, refit};
use super::samples::{even_samples, vertex_samples};
use super::simplify::{BOUNDARY_WEIGHT_SOLID, Simplifier};
use super::surface::Surface;
use super::swaps::{Scored, grow, remove, swap};
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// Up to this many primitives several starts are tried, and larger shares swapped.
const SMALL: usize = 200;

/// Above this many measured cost no longer beats the quadrics' and takes too long.
const LARGE: usize = 1000;

/// Spacing of envelope samples (longest side 1).
const ENVELOPE_SPACING: f64 = 0.01;

/// The samples to fit `most` primitives to.
pub fn target<'a>(surface: &Surface, tree: &'a TriangleTree, most: usize) -> Target<'a> {
    let count = (3_000 + 10 * most.min(LARGEST_FIT)).min(30_000);
    let vertices = if most <= SMALL { 5_000 } else { 10_000 };
    let mut samples = even_samples(surface, count, &mut Random::new(5));
    let corners = vertex_samples(surface);
    let every = corners.len().div_ceil(vertices).max(1);
    samples.extend(corners.into_iter().step_by(every));
    Target {
        tree,
        samples,
        spacing: ENVELOPE_SPACING,
    }
}

/// Counts above this have no more samples: the count alone must not overflow.
const LARGEST_FIT: usize = 10_000;

/// Drafts of a plain collapse on its way to the count wanted.
pub struct Collapsed {
    /// About twice as many primitives as a start.
    pub fine: Option<Draft>,
    /// As many as a start.
    pub start: Draft,
    /// As many as wanted: what [`super::Quality::Fast`] gives.
    pub plain: Draft,
}

/// Primitives of a start; the rest is inserted.
fn start_count(most: usize) -> usize {
    let share = if most > LARGE { 0.85 } else { 0.8 };
    ((most as f64 * share) as usize).max(8).min(most)
}

impl Collapsed {
    /// Collapses to `most` primitives.
    pub fn new(
        simplifier: &mut Simplifier,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let start = start_count(most);
        simplifier.reduce_to((2 * start).max(start + 100), watch)?;
        let fine = (most <= LARGE).then(|| simplifier.draft());
        if start == most {
            simplifier.reduce_to(most, watch)?;
            let plain = simplifier.draft();
            return Ok(Self {
                fine,
                start: plain.clone(),
                plain,
            });
        }
        let mut plain = None;
        if simplifier.primitives() > most {
            simplifier.reduce_to(most, watch)?;
            plain = Some(simplifier.draft());
        }
        simplifier.reduce_to(start, watch)?;
        let start = simplifier.draft();
        Ok(Self {
            fine,
            plain: plain.unwrap_or_else(|| start.clone()),
            start,
        })
    }
}

/// Fits a closed surface's draft to at most `most` primitives: the result of
/// [`super::Quality::Balanced`].
pub fn balanced(
    collapsed: &Collapsed,
    target: &Target,
    most: usize,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    let mut best = match &collapsed.fine {
        Some(fine) => {
            let start = measured_start(fine, target, most, watch)?;
            grown(start, target, most, watch)?
        }
        None => grown(collapsed.start.clone(), target, most, watch)?,
    };
    if most <= SMALL {
        better(&mut best, refitted(collapsed.plain.clone(), target, watch)?);
        best = swap(best, target, most, 0.2, 2, watch)?;
    }
    Ok(best)
}

/// Goes on from [`balanced`] with more starts and swaps: the result of [`super::Quality::Best`].
pub fn best(
    balanced: Scored,
    collapsed: &Collapsed,
    target: &Target,
    most: usize,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    let mut best = balanced;
    let (share, rounds) = if most <= SMALL { (0.2, 6) } else { (0.1, 2) };
    if most <= SMALL {
        better(
            &mut best,
            grown(collapsed.start.clone(), target, most, watch)?,
        );
    }
    swap(best, target, most, share, rounds, watch)
}

/// A refit alone: for drafts that must keep their complex.
pub fn refitted(
    mut draft: Draft,
    target: &Target,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    watch.begin("refit")?;
    let score = refit(&mut draft, target, 6, watch)?;
    Ok((draft, score))
}

fn measured_start(
    fine: &Draft,
    target: &Target,
    most: usize,
    watch: &mut Watch,
) -> Result<Draft, BuildError> {
    watch.begin("simplify")?;
    let simplifier = Simplifier::new(fine.clone(), BOUNDARY_WEIGHT_SOLID, target.tree, watch)?;
    remove(simplifier, start_count(most), target, watch)
}

fn grown(
    mut draft: Draft,
    target: &Target,
    most: usize,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    watch.begin("refit")?;
    refit(&mut draft, target, 2, watch)?;
    let (rounds, last) = if most > LARGE { (2, 4) } else { (3, 5) };
    grow(&mut draft, target, most, rounds, watch)?;
    watch.begin("refit")?;
    let score = refit(&mut draft, target, last, watch)?;
    Ok((draft, score))
}

fn better(best: &mut Scored, other: Scored) {
    if other.1 < best.1 {
        *best = other;
    }
}
