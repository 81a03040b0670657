//! Chooses the number of primitives that fits best, among the one asked for and smaller round ones: round bodies need
//! few, and very many often fit worse.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::options::Quality;
use crate::meshing::recipe::candidate::{Candidate, Enclosed};
use crate::meshing::recipe::source::{GAVE_UP, Source};
use crate::meshing::refine::fit::{self, Collapsed};
use crate::meshing::refine::refit::FitTarget;
use crate::meshing::refine::swaps::LARGE;
use crate::meshing::simplify::shared_count::SolidAndSheets;
use crate::meshing::watch::Watch;

/// A fit whose largest residual is below this share of the plain collapse's is better without
/// measuring both.
const CLEARLY_BETTER: f64 = 0.75;

/// How much larger a plain collapse's error may be, before enclosure, than that of its fit after it:
/// 1.3 on a ring, 2 on the bug, where all counts of primitives differ by more.
pub const LARGEST_GAIN: f64 = 2.0;

/// The same ratio for a medial mesh that keeps sharp edges: 1.15 was seen on plates with curved rims. Larger, and more
/// counts are fitted; smaller, and one that would have won may be left out.
const GAIN_OF_CREASED: f64 = 1.3;

/// The same ratio for a medial mesh without sharp edges, when one that keeps them is known: 1.5 was seen on plates with
/// curved rims.
const GAIN_OF_ROUNDED: f64 = 1.5;

/// Samples of an envelope need be no nearer to each other than what is known of the boundary is fine; but they are at
/// most this many times farther apart than usual, for bulges between them are not seen.
const COARSER: f64 = 3.0;

/// A round body's counts ([`fit::round_from`]) are tried upwards until this many in turn fit no better.
const FAILURES: usize = 2;

/// A medial mesh collapsed to the counts that are tried.
pub struct Collapses {
    /// The mesh collapsed to the count asked for.
    first: Collapsed,
    /// The mesh collapsed to smaller counts.
    smaller: Vec<Collapsed>,
    kept_topology: bool,
    /// Convex creases that it keeps.
    creases: Vec<[Point; 2]>,
    /// Largest residual at the count asked for, by few samples.
    pub rough_error: f64,
}

impl Collapses {
    /// How many creases it may keep.
    pub fn creases(&self) -> usize {
        self.creases.len()
    }

    /// Notes for where `wins` primitives fit best, and `left` larger counts were not fitted.
    fn notes(&self, wins: usize, left: usize) -> Vec<String> {
        let (mut notes, most) = (Vec::new(), self.first.most);
        if wins < most {
            notes.push(match left {
                0 => format!("{wins} primitives fit better than {most}"),
                _ => format!(
                    "a round body: {wins} primitives fit best, and larger numbers, up to {most}, gain nothing"
                ),
            });
        }
        if !self.kept_topology {
            notes.push(GAVE_UP.into());
        }
        notes
    }
}

impl Source {
    /// Collapses a medial mesh that keeps `creases`.
    pub fn collapses(
        &self,
        parts: SolidAndSheets,
        creases: Vec<[Point; 2]>,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Collapses, BuildError> {
        let (first, smaller, kept_topology) = fit::collapse(parts, most, watch)?;
        let rough = self.rough_target();
        let error = rough.largest_below(&first.plain, f64::INFINITY, watch)?;
        Ok(Collapses {
            first,
            smaller,
            kept_topology,
            creases,
            rough_error: error.unwrap_or(f64::INFINITY),
        })
    }

    /// The best by the error that is reported of what each quality up to the one asked for gives, for
    /// the count asked for and for smaller round ones: round bodies need few primitives, and from
    /// thousands on more of them often fit worse.
    ///
    /// The error never rises from one of [`fit::ROUND`] to a larger count (while both start from as
    /// many samples), nor with the quality: what gives the one is among what is tried for the other.
    /// Left out are counts whose plain collapse is too bad for any fit to make it win, or to bring it below the
    /// error of another medial mesh of the body: `rival`, infinite where that is still to come.
    pub fn best_of(
        &self,
        collapses: &Collapses,
        rival: Option<f64>,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let Collapses {
            first,
            smaller,
            creases,
            ..
        } = collapses;
        let rough = self.rough_target();
        let gain = match () {
            _ if !self.fits() => 1.0,
            _ if !creases.is_empty() => GAIN_OF_CREASED,
            _ if rival.is_some() => GAIN_OF_ROUNDED,
            _ => LARGEST_GAIN,
        };
        let round = match self.fits() && creases.is_empty() {
            true => fit::round_from(first, smaller, &rough, watch)?,
            false => None,
        };
        let (start, larger, smaller) = match round {
            Some(k) => {
                let larger = smaller[..k].iter().rev().chain([first]).collect();
                (&smaller[k], larger, &smaller[k + 1..])
            }
            None => (first, Vec::new(), &smaller[..]),
        };
        let mut best = self.fitted(start, creases, None, watch)?;
        let mut wins = start.most;
        let (mut failures, mut left) = (0, 0);
        for other in larger {
            let (before, balanced) = (best.hausdorff.error(), best.lower_quality);
            if failures < FAILURES {
                best = self.fitted(other, creases, Some(best), watch)?;
                let better = best.lower_quality < balanced;
                failures = if better { 0 } else { failures + 1 };
            } else {
                left += 1;
                let may_win = rough.largest_below(&other.plain, balanced, watch)?;
                if may_win.is_some() {
                    let plain = other.plain.clone();
                    let with_plain = self.or_better(Some(best), plain, None, watch)?;
                    best = with_plain.counted_for_lower_quality();
                }
            }
            if best.hausdorff.error() < before {
                wins = other.most;
            }
        }
        for other in smaller {
            // Where parts overlap, what is inside others is far from any solid and says nothing.
            let sure = self.fits() || !self.surface.simple;
            let least = match sure && other.most >= LARGE {
                true => f64::INFINITY,
                false => gain * best.lower_quality.min(rival.unwrap_or(f64::INFINITY)),
            };
            if rough.largest_below(&other.plain, least, watch)?.is_none() {
                continue;
            }
            let before = best.hausdorff.error();
            best = self.fitted(other, creases, Some(best), watch)?;
            if best.hausdorff.error() < before {
                wins = other.most;
            }
        }
        let mut candidate = self.reported(best, watch)?;
        candidate.notes.extend(collapses.notes(wins, left));
        Ok(candidate)
    }

    /// Whether drafts are fitted.
    pub fn fits(&self) -> bool {
        self.limits.quality > Quality::Fast
    }

    /// Target that `most` primitives are fitted to.
    pub fn target(&self, most: usize) -> FitTarget<'_> {
        let (surface, tree) = self.bounds();
        let mut target = fit::target(surface, tree, most);
        if let Some(boundary) = &self.boundary
            && self.surface.findings.boundary_coarse
        {
            let spacing = target.spacing;
            target.spacing = spacing.max(boundary.finest.min(COARSER * spacing));
        }
        target
    }

    /// Target of few samples, to tell drafts that may serve from those that cannot.
    pub fn rough_target(&self) -> FitTarget<'_> {
        self.target(1)
    }

    /// The best of `best` and what each quality gives for a count; of the plain collapse alone once the budget of
    /// fits is spent.
    pub fn fitted(
        &self,
        collapsed: &Collapsed,
        creases: &[[Point; 2]],
        best: Option<Enclosed>,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        if !self.fits() {
            let best = self.or_better(best, collapsed.plain.clone(), None, watch)?;
            return Ok(best.counted_for_lower_quality());
        }
        let mut target = self.target(collapsed.most);
        target.creases = creases;
        if watch.ends_fit(target.budget) {
            let best = self.or_better(best, collapsed.plain.clone(), Some(&target), watch)?;
            return Ok(best.counted_for_lower_quality());
        }
        let balanced = fit::balanced(collapsed, &target, watch)?;
        let mut best = self.or_better(best, balanced.0.clone(), Some(&target), watch)?;
        let clear = target.residuals(&balanced.0, watch)?.largest / CLEARLY_BETTER;
        // Next to creases much lies between samples.
        let unsure = !creases.is_empty();
        let plain = &collapsed.plain;
        if unsure || target.largest_below(plain, clear, watch)?.is_some() {
            best = self.or_better(Some(best), plain.clone(), Some(&target), watch)?;
        }
        best = best.counted_for_lower_quality();
        if self.limits.quality == Quality::Best && !watch.ends_fit(target.budget) {
            // The first is the balanced one itself.
            let drafts = fit::more(balanced, collapsed, &target, watch)?;
            for (draft, _) in drafts.into_iter().skip(1) {
                best = self.or_better(Some(best), draft, Some(&target), watch)?;
            }
        }
        Ok(best)
    }
}
