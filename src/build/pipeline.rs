//! The pipeline: from a checked surface to the best draft that the limits allow, stage by stage.

use super::draft::Draft;
use super::enclose::enclose;
use super::fit::{self, Collapsed};
use super::hausdorff::measure;
use super::largest::Effort;
use super::options::{Hausdorff, Limits, Quality};
use super::parts::Parts;
use super::polyhedron::{EXACT, polyhedron};
use super::simplify::Simplifier;
use super::start::{Start, start};
use super::surface::Surface;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// Counts tried when the error is the limit shrink by this factor from one to the next.
const LADDER: f64 = 0.8;

/// A finished medial mesh and what was measured on it, in the builder's frame.
pub struct Candidate {
    pub draft: Draft,
    pub hausdorff: Hausdorff,
    pub before: Option<Hausdorff>,
    pub notes: Vec<String>,
}

impl Candidate {
    fn error(&self) -> f64 {
        f64::from(self.hausdorff.error())
    }

    /// Whether the error is within a limit.
    pub fn keeps(&self, max_error: Option<f64>) -> bool {
        max_error.is_none_or(|limit| self.error() <= limit)
    }
}

/// Note on a result that is not what the source was.
const GAVE_UP: &str = "holes or parts were given up to reach the count";

/// A fit whose largest residual is below this share of the plain collapse's is better without
/// measuring both.
const CLEARLY_BETTER: f64 = 0.75;

/// How much larger a plain collapse's error may be, before enclosure, than that of its fit after it:
/// 1.3 on a ring, 2 on the bug, where all counts of primitives differ by more.
const LARGEST_GAIN: f64 = 2.0;

/// A round body's counts ([`fit::round_from`]) are tried upwards until this many in turn fit no better.
const FAILURES: usize = 2;

/// The checked surface, its tree, and what to build from it.
pub struct Source {
    pub surface: Surface,
    pub tree: TriangleTree,
    pub limits: Limits,
}

impl Source {
    /// Balls inside where the surface bounds matter, slabs where it is a sheet.
    pub fn best_candidate(&mut self, watch: &mut Watch) -> Result<Candidate, BuildError> {
        if let Some(exact) = self.polyhedron(watch)? {
            return Ok(exact);
        }
        let count = self.limits.samples(self.surface.area);
        let mut findings = std::mem::take(&mut self.surface.findings);
        let start = start(&self.surface, &self.tree, count, &mut findings, watch)?;
        self.surface.findings = findings;
        self.candidate(start, watch)
    }

    /// The medial axis of a convex polyhedron itself, if that is within the limit on the count.
    fn polyhedron(&self, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        let most = self.limits.primitives.unwrap_or(usize::MAX);
        let Some(angle) = self.limits.creases.angle() else {
            return Ok(None);
        };
        let Some(draft) = polyhedron(&self.surface, &self.tree, angle, most, watch)? else {
            return Ok(None);
        };
        // Where balls cover all of the surface without growing, no part of the axis is missing.
        let mut covering = draft.clone();
        enclose(&mut covering, &self.surface, 0.0, watch)?;
        let mut balls = covering.balls.iter().zip(&draft.balls);
        if balls.any(|(grown, ball)| grown.radius - ball.radius > EXACT) {
            return Ok(None);
        }
        let mut candidate = self.finish(draft, watch)?;
        if candidate.error() > EXACT {
            return Ok(None);
        }
        let count = candidate.draft.primitives().len();
        candidate.notes.push(format!(
            "a convex polyhedron: its own medial axis has {count} primitives, and is exact"
        ));
        Ok(Some(candidate))
    }

    /// Simplifies and fits to the limits, encloses and measures.
    fn candidate(&self, start: Start, watch: &mut Watch) -> Result<Candidate, BuildError> {
        watch.begin("simplify")?;
        let mut parts = Parts::new(start, &self.tree, watch)?;
        let most = self.limits.primitives.unwrap_or(usize::MAX);
        if self.limits.max_error.is_none() {
            parts = match parts.into_only_solid() {
                Ok(simplifier) => return self.best_of(simplifier, most, watch),
                Err(parts) => *parts,
            };
        }
        parts.reduce_to(most, watch)?;
        let mut candidate = match self.limits.max_error {
            Some(error) => self.coarsest(&mut parts, error, watch)?,
            None => self.finish(parts.draft(), watch)?,
        };
        if parts.broke_topology() {
            candidate.notes.push(GAVE_UP.into());
        }
        Ok(candidate)
    }

    /// The best by the error that is reported of what each quality up to the one asked for gives, for
    /// the count asked for and for smaller round ones: round bodies need few primitives, and from
    /// thousands on more of them often fit worse.
    ///
    /// The error never rises from one of [`fit::ROUND`] to a larger count (while both start from as
    /// many samples), nor with the quality: what gives the one is among what is tried for the other.
    /// Left out are counts whose plain collapse is too bad for any fit to make it win.
    fn best_of(
        &self,
        simplifier: Simplifier,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let (first, smaller, kept_topology) = fit::collapse(simplifier, most, watch)?;
        let rough = fit::rough_target(&self.surface, &self.tree);
        let gain = if self.fits() { LARGEST_GAIN } else { 1.0 };
        let round = match self.fits() {
            true => fit::round_from(&first, &smaller, &rough, watch)?,
            false => None,
        };
        let (start, larger, smaller) = match round {
            Some(k) => {
                let larger = smaller[..k].iter().rev().chain([&first]).collect();
                (&smaller[k], larger, &smaller[k + 1..])
            }
            None => (&first, Vec::new(), &smaller[..]),
        };
        let mut best = self.fitted(start, None, watch)?;
        let mut wins = start.most;
        let (mut failures, mut left) = (0, 0);
        for other in larger {
            let (before, balanced) = (best.hausdorff.error(), best.lower_quality);
            if failures < FAILURES {
                best = self.fitted(other, Some(best), watch)?;
                let better = best.lower_quality < balanced;
                failures = if better { 0 } else { failures + 1 };
            } else {
                left += 1;
                let may_win = rough.largest_below(&other.plain, balanced, watch)?;
                if may_win.is_some() {
                    let plain = other.plain.clone();
                    let with_plain = self.or_better(Some(best), plain, watch)?;
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
            let least = match sure && other.most >= fit::LARGE {
                true => f64::INFINITY,
                false => gain * best.lower_quality,
            };
            if rough.largest_below(&other.plain, least, watch)?.is_none() {
                continue;
            }
            let before = best.hausdorff.error();
            best = self.fitted(other, Some(best), watch)?;
            if best.hausdorff.error() < before {
                wins = other.most;
            }
        }
        let mut candidate = self.reported(best, watch)?;
        if wins < most {
            candidate.notes.push(match left {
                0 => format!("{wins} primitives fit better than {most}"),
                _ => format!(
                    "a round body: {wins} primitives fit best, and larger counts than were tried, up to \
                     {most}, gain nothing"
                ),
            });
        }
        if !kept_topology {
            candidate.notes.push(GAVE_UP.into());
        }
        Ok(candidate)
    }

    /// Whether drafts are fitted. Surfaces of parts that overlap do not tell inside from outside at
    /// each point.
    fn fits(&self) -> bool {
        self.limits.quality > Quality::Fast && self.surface.simple
    }

    /// How closely to look at errors: a limit on them is held as closely as can be.
    fn effort(&self) -> Effort {
        match self.limits.quality {
            Quality::Fast if self.limits.max_error.is_none() => Effort::COARSE,
            _ => Effort::CLOSE,
        }
    }

    /// The best of `best` and what each quality gives for a count.
    fn fitted(
        &self,
        collapsed: &Collapsed,
        best: Option<Enclosed>,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        if !self.fits() {
            let best = self.or_better(best, collapsed.plain.clone(), watch)?;
            return Ok(best.counted_for_lower_quality());
        }
        let target = &fit::target(&self.surface, &self.tree, collapsed.most);
        let balanced = fit::balanced(collapsed, target, watch)?;
        let mut best = self.or_better(best, balanced.0.clone(), watch)?;
        let clear = target.residuals(&balanced.0, watch)?.largest / CLEARLY_BETTER;
        if target
            .largest_below(&collapsed.plain, clear, watch)?
            .is_some()
        {
            best = self.or_better(Some(best), collapsed.plain.clone(), watch)?;
        }
        best = best.counted_for_lower_quality();
        if self.limits.quality == Quality::Best {
            // The first is the balanced one itself.
            let drafts = fit::more(balanced, collapsed, target, watch)?;
            for (draft, _) in drafts.into_iter().skip(1) {
                best = self.or_better(Some(best), draft, watch)?;
            }
        }
        Ok(best)
    }

    /// A rung of the ladder as the quality wants it: fitted where it is above [`Quality::Fast`].
    fn rung(&self, draft: Draft, watch: &mut Watch) -> Result<Candidate, BuildError> {
        if !self.fits() {
            return self.finish(draft, watch);
        }
        let target = fit::target(&self.surface, &self.tree, draft.primitives().len());
        let (draft, _) = fit::refitted(draft, &target, watch)?;
        self.finish(draft, watch)
    }

    /// The fewest primitives whose error is at most `max_error`, among counts in ratio [`LADDER`].
    fn coarsest(
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

    /// Encloses when asked to, and measures before and after.
    fn finish(&self, draft: Draft, watch: &mut Watch) -> Result<Candidate, BuildError> {
        let enclosed = self.enclosed(draft, self.effort(), watch)?;
        self.reported(enclosed, watch)
    }

    /// Encloses when asked to, and measures the result.
    fn enclosed(
        &self,
        draft: Draft,
        effort: Effort,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        let mut before = None;
        let mut enclosed = draft;
        if self.limits.enclose {
            watch.begin("enclose")?;
            before = Some(enclosed.clone());
            enclose(
                &mut enclosed,
                &self.surface,
                self.limits.allow_uncovered,
                watch,
            )?;
        }
        watch.begin("measure")?;
        let hausdorff = measure(&self.surface, &self.tree, &enclosed, effort, watch)?;
        Ok(Enclosed {
            draft: enclosed,
            lower_quality: hausdorff.error().into(),
            hausdorff,
            before,
        })
    }

    /// The better of two; the second is measured only until it is worse.
    fn or_better(
        &self,
        best: Option<Enclosed>,
        other: Draft,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        let Some(best) = best else {
            return self.enclosed(other, self.effort(), watch);
        };
        let error = best.hausdorff.error();
        let effort = Effort {
            enough: error.into(),
            ..self.effort()
        };
        let other = self.enclosed(other, effort, watch)?;
        Ok(if other.hausdorff.error() < error {
            Enclosed {
                lower_quality: best.lower_quality,
                ..other
            }
        } else {
            best
        })
    }

    /// Measures as well what was there before the enclosure.
    fn reported(&self, enclosed: Enclosed, watch: &mut Watch) -> Result<Candidate, BuildError> {
        let mut before = None;
        if let Some(draft) = &enclosed.before {
            watch.begin("measure")?;
            before = Some(measure(
                &self.surface,
                &self.tree,
                draft,
                Effort::ROUGH,
                watch,
            )?);
        }
        Ok(Candidate {
            draft: enclosed.draft,
            hausdorff: enclosed.hausdorff,
            before,
            notes: Vec::new(),
        })
    }
}

/// A draft after enclosure, its error, and the draft before.
struct Enclosed {
    draft: Draft,
    hausdorff: Hausdorff,
    before: Option<Draft>,
    /// The least error so far without [`Quality::Best`]: it decides which counts are tried, so that
    /// they are the same for both.
    lower_quality: f64,
}

impl Enclosed {
    fn counted_for_lower_quality(mut self) -> Self {
        let error = f64::from(self.hausdorff.error());
        self.lower_quality = self.lower_quality.min(error);
        self
    }
}
