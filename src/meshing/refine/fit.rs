//! The recipe from a plain collapse to a fitted draft: starts, refits, insertion, swaps.
//!
//! One recipe for all models; every number depends on the count of primitives and the quality only.
//! A start with fewer primitives than wanted is refitted and grown where it is worst: that finds
//! tips and thin parts that a collapse gave up. Small counts scatter, so several starts are tried.

use crate::error::BuildError;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::refine::refit::{FitTarget, refit};
use crate::meshing::refine::swaps::{LARGE, Scored, Swaps, grow, remove, swap};
use crate::meshing::simplify::ball_quadrics::BOUNDARY_WEIGHT_SOLID;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::simplify::shared_count::SolidAndSheets;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::samples::{even_samples, vertex_samples};
use crate::meshing::watch::Watch;
use std::collections::{BTreeMap, BTreeSet};

/// Number of primitives up to which several starts are tried, and larger shares swapped.
pub const SMALL: usize = 200;

/// Spacing of envelope samples (longest side 1), up to [`SMALL`], up to [`LARGE`] and above: it must
/// stay below the size of the primitives, for bulges between samples are not seen.
const ENVELOPE_SPACING: [f64; 3] = [0.01, 0.007, 0.005];

/// Samples of the surface for each primitive, up to [`LARGE`] primitives and above. With ten for each of 2,000
/// the largest error lies between samples, a third above what the fit sees.
const SAMPLES_PER_PRIMITIVE: [usize; 2] = [10, 15];

/// Samples of the surface besides those for each primitive.
const LEAST_SAMPLES: usize = 3_000;

/// Largest number of samples of the surface, without its vertices. Each iteration of a fit looks at all of them.
const MOST_SAMPLES: usize = 33_000;

/// Share of a build's budget of fits that may be spent before drafts are made to cover the surface more closely: of
/// tangled surfaces that gains most.
pub const BUDGET: f64 = 0.5;

/// The samples to fit `most` primitives to.
pub fn target<'a>(surface: &Surface, tree: &'a TriangleTree, most: usize) -> FitTarget<'a> {
    let (over_small, over_large) = (usize::from(most > SMALL), usize::from(most > LARGE));
    let of_primitives = SAMPLES_PER_PRIMITIVE[over_large].saturating_mul(most);
    let count = of_primitives.saturating_add(LEAST_SAMPLES);
    let count = count.min(MOST_SAMPLES);
    let vertices = [5_000, 10_000][over_small];
    let mut samples = even_samples(surface, count, &mut Random::new(5));
    let corners = vertex_samples(surface);
    let every = corners.len().div_ceil(vertices).max(1);
    samples.extend(corners.into_iter().step_by(every));
    FitTarget {
        tree,
        samples,
        spacing: ENVELOPE_SPACING[over_small + over_large],
        creases: &[],
        beyond: 0.0,
        budget: BUDGET,
    }
}

/// Drafts of a plain collapse on its way to a count.
pub struct Collapsed {
    /// The count.
    pub most: usize,
    /// About twice as many primitives as a start.
    pub fine: Option<Draft>,
    /// Draft of as many primitives as a start has.
    pub start: Draft,
    /// Draft of as many as wanted: what [`crate::meshing::Quality::Fast`] gives.
    pub plain: Draft,
}

impl Collapsed {
    fn bytes(&self) -> usize {
        let fine = self.fine.as_ref().map_or(0, Draft::bytes);
        fine + self.start.bytes() + self.plain.bytes()
    }
}

/// Number of primitives of a start; the rest is inserted.
pub fn start_count(most: usize) -> usize {
    let share = if most > LARGE { 0.85 } else { 0.8 };
    ((most as f64 * share) as usize).max(8).min(most)
}

/// Primitives of what a start by measured cost is collapsed from.
pub fn fine_count(most: usize) -> usize {
    let start = start_count(most);
    (2 * start).max(start + 100)
}

/// Round counts that are tried as well when a larger one is asked for.
pub const ROUND: [usize; 12] = [
    50_000, 20_000, 10_000, 5_000, 2_000, 1_000, 500, 200, 100, 50, 20, 10,
];

/// Collapses to `most` primitives, and to the round counts below as long as the topology stays: the
/// drafts for each, the largest count first and by itself, and whether that one kept the topology.
pub fn collapse(
    mut parts: SolidAndSheets,
    most: usize,
    watch: &mut Watch,
) -> Result<(Collapsed, Vec<Collapsed>, bool), BuildError> {
    // More than there is would be copied again and again.
    let most = most.min(parts.primitives()).max(1);
    parts.set_measures_early(most > LARGE);
    let round = ROUND.into_iter().filter(|n| *n < most);
    let tried = std::iter::once(most).chain(round);
    let counts: BTreeSet<usize> = tried
        .clone()
        .flat_map(|n| [fine_count(n), n, start_count(n)])
        .collect();
    let least = start_count(most);
    let mut drafts = BTreeMap::new();
    let mut kept = true;
    for &count in counts.iter().rev() {
        parts.reduce_to(count, watch)?;
        let keeps = !parts.broke_topology();
        if count < least && !keeps {
            break;
        }
        kept &= keeps;
        drafts.insert(count, parts.draft());
    }
    drop(parts);
    let tried = tried.take_while(|n| drafts.contains_key(&start_count(*n)));
    let of = |count: usize| drafts[&count].clone();
    let collapsed = |most| Collapsed {
        most,
        fine: (most <= LARGE).then(|| of(fine_count(most))),
        start: of(start_count(most)),
        plain: of(most),
    };
    let smaller: Vec<Collapsed> = tried.skip(1).map(collapsed).collect();
    let first = collapsed(most);
    watch.keep(smaller.iter().chain([&first]).map(Collapsed::bytes).sum());
    Ok((first, smaller, kept))
}

/// Ratio of the count asked for to a small one from which on it is tested whether the body is round: whether all larger
/// counts lower the error of the plain collapse by less than [`FLAT`]. The errors are then those of the samples and of
/// the source's own facets.
const ROUND_FROM: usize = 10;

/// Ratio by which larger counts may lower the error of a round body's plain collapse. Errors of a ring of 1,536
/// triangles (longest side 1): .0032 at 50, .0023 to .0029 from 200 to 5,000; of the bug .027 at 50, .0044 at 5,000.
const FLAT: f64 = 1.5;

/// Largest error of a round body's plain collapse (longest side 1). Farther off, the collapse is bad at all counts,
/// which says nothing of the body.
const ROUND_ERROR: f64 = 0.05;

/// Place among the `smaller` counts of the least that a round body needs; `None` where it is not round.
pub fn round_from(
    first: &Collapsed,
    smaller: &[Collapsed],
    rough: &FitTarget,
    watch: &mut Watch,
) -> Result<Option<usize>, BuildError> {
    let few = |c: &Collapsed| c.most <= SMALL && c.most * ROUND_FROM <= first.most;
    if !smaller.iter().any(few) {
        return Ok(None);
    }
    let Some(most) = rough.largest_below(&first.plain, f64::INFINITY, watch)? else {
        return Ok(None);
    };
    for k in (0..smaller.len()).rev().filter(|&k| few(&smaller[k])) {
        let enough = ROUND_ERROR.min(FLAT * most);
        let Some(own) = rough.largest_below(&smaller[k].plain, enough, watch)? else {
            continue;
        };
        let mut flat = true;
        for larger in &smaller[..k] {
            let far_better = rough.largest_below(&larger.plain, own / FLAT, watch)?;
            flat &= far_better.is_none();
        }
        if flat {
            return Ok(Some(k));
        }
    }
    Ok(None)
}

/// Swaps of up to [`SMALL`] primitives.
const SMALL_SWAPS: Swaps = Swaps {
    share: 0.15,
    rounds: 6,
    insertions: 3,
    iterations: 6,
};
/// Swaps of more primitives. With fewer iterations most rounds fail.
const SWAPS: Swaps = Swaps {
    share: 0.06,
    rounds: 3,
    insertions: 3,
    iterations: 8,
};
/// The one swap of large counts: it costs a quarter of the fit, and mends what two rounds of insertion
/// did not reach.
const LARGE_SWAP: Swaps = Swaps {
    share: 0.03,
    rounds: 1,
    insertions: 1,
    iterations: 4,
};

/// Fits a closed surface's draft to at most `most` primitives: the result of
/// [`crate::meshing::Quality::Balanced`].
pub fn balanced(
    collapsed: &Collapsed,
    target: &FitTarget,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    let most = collapsed.most;
    let mut best = match &collapsed.fine {
        Some(fine) => {
            let mut start = measured_start(fine, target, most, watch)?;
            // It keeps the topology, were it above the count.
            if start.primitives().len() > most {
                start.clone_from(&collapsed.start);
            }
            grown(start, target, most, watch)?
        }
        None => {
            let grown = grown(collapsed.start.clone(), target, most, watch)?;
            last(swap(grown, target, most, LARGE_SWAP, watch)?)
        }
    };
    if most <= SMALL {
        better(&mut best, refitted(collapsed.plain.clone(), target, watch)?);
        best = last(swap(best, target, most, SMALL_SWAPS, watch)?);
    }
    Ok(best)
}

/// Goes on from [`balanced`] with swaps, for small counts from another start as well: drafts among
/// which is the result of [`crate::meshing::Quality::Best`].
pub fn more(
    balanced: Scored,
    collapsed: &Collapsed,
    target: &FitTarget,
    watch: &mut Watch,
) -> Result<Vec<Scored>, BuildError> {
    let most = collapsed.most;
    if most > SMALL {
        return swap(balanced, target, most, SWAPS, watch);
    }
    let mut drafts = swap(balanced, target, most, SWAPS, watch)?;
    let start = grown(collapsed.start.clone(), target, most, watch)?;
    drafts.extend(swap(start, target, most, SMALL_SWAPS, watch)?);
    Ok(drafts)
}

/// A refit alone: for drafts that must keep their complex.
pub fn refitted(
    mut draft: Draft,
    target: &FitTarget,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    watch.begin("refit")?;
    let score = refit(&mut draft, target, 6, watch)?;
    Ok((draft, score))
}

fn measured_start(
    fine: &Draft,
    target: &FitTarget,
    most: usize,
    watch: &mut Watch,
) -> Result<Draft, BuildError> {
    watch.begin("simplify")?;
    let simplifier = Simplifier::new(fine.clone(), BOUNDARY_WEIGHT_SOLID, target.tree, watch)?;
    remove(simplifier, start_count(most), target, watch)
}

fn grown(
    mut draft: Draft,
    target: &FitTarget,
    most: usize,
    watch: &mut Watch,
) -> Result<Scored, BuildError> {
    watch.begin("refit")?;
    refit(&mut draft, target, 2, watch)?;
    // Measured at 500: three and five leave a third more error on bug and dolphin.
    let (rounds, last) = if most > LARGE { (2, 4) } else { (4, 7) };
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

/// The last of drafts that get better and better.
fn last(drafts: Vec<Scored>) -> Scored {
    let none = || (Draft::default(), f64::INFINITY);
    drafts.into_iter().next_back().unwrap_or_else(none)
}
