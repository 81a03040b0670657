//! Finds the smallest number of primitives that keeps to a given error, measured after enclosure
//! ([`crate::meshing::BuildOptions::max_error`]).
//!
//! Errors fall with the number of primitives, except for the scatter of single fits (a sixth). So numbers are tried
//! upwards, from the first whose plain collapse is near enough, until one keeps to the limit; then between those
//! that do and those that do not. Each is fitted, enclosed and measured as in a build of that number, until it
//! breaks the limit.

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::options::Quality;
use crate::meshing::recipe::candidate::{Candidate, Enclosed};
use crate::meshing::recipe::counts::LARGEST_GAIN;
use crate::meshing::recipe::ladder::Ladder;
use crate::meshing::recipe::source::{GAVE_UP, Source};
use crate::meshing::recipe::tightened::GAIN_OF_TIGHT;
use crate::meshing::refine::fit;
use crate::meshing::refine::refit::FitTarget;
use crate::meshing::watch::Watch;
use std::collections::BTreeSet;

/// Most primitives that are tried where the count is free.
const MAX_COUNT: usize = 10_000;

/// Factor from a count that breaks the limit to the next above that is tried.
const STEP: f64 = 1.5;

/// The result's count is the least that keeps the limit within one part in this many; fits scatter more.
const COUNT_RESOLUTION: usize = 50;

/// Number of primitives up to which each smaller count is tried in turn, since small counts scatter.
const EACH: usize = 64;

/// Counts in turn that may break the limit of the error before smaller ones are given up.
const FAILURES: usize = 3;

/// Counts in ratio [`STEP`] after which the search for a sufficient count ends if together they gained less than
/// [`STALLED_GAIN`]. The error is then that of the samples that the medial mesh is made from, which no count lowers.
const STALLED: usize = 3;

/// Share of the error that [`STALLED`] counts have to gain together.
const STALLED_GAIN: f64 = 0.1;

/// Least count at which a stall is believed.
const FINE: usize = 500;

/// Plain collapses whose largest residuals differ by less than this share are as good.
const FLAT: f64 = 1.02;

/// Search over the medial meshes of one body, with what was tried of them.
struct CountSearch<'a, 'b> {
    source: &'a Source,
    ladders: Vec<&'a mut Ladder<'b>>,
    limit: f64,
    tried: BTreeSet<usize>,
    /// Largest residual of the fit tried last, before enclosure.
    residual: f64,
}

/// A medial mesh that keeps the limit.
struct WithinLimit {
    enclosed: Enclosed,
    count: usize,
    kept_topology: bool,
    creases: usize,
}

/// Outcome of a search.
pub enum Smallest {
    /// A medial mesh that keeps the limit.
    Found(Box<Candidate>),
    /// No count keeps the limit. More primitives than this many gain nothing, or are not allowed.
    OutOfReach(usize),
}

impl Source {
    /// The fewest primitives, up to `most`, whose error is at most `limit`.
    pub fn smallest(
        &self,
        ladders: Vec<&mut Ladder>,
        limit: f64,
        most: Option<usize>,
        watch: &mut Watch,
    ) -> Result<Smallest, BuildError> {
        let finest = ladders
            .iter()
            .map(|l| l.finest.primitives())
            .max()
            .unwrap_or(0);
        let top = most.unwrap_or(MAX_COUNT).min(finest).max(1);
        let mut search = CountSearch {
            source: self,
            ladders,
            limit,
            tried: BTreeSet::new(),
            residual: f64::INFINITY,
        };
        match search.run(top, watch)? {
            Ok(found) => {
                let mut candidate = self.reported(found.enclosed, watch)?;
                let error = candidate.error();
                candidate.notes.push(format!(
                    "max_error {} is kept by {} primitives: error {error:.6}, and no smaller count that was tried \
                     keeps it",
                    limit as Real, found.count
                ));
                if found.creases > 0 {
                    candidate.keeps_creases(found.creases);
                }
                if !found.kept_topology {
                    candidate.notes.push(GAVE_UP.into());
                }
                Ok(Smallest::Found(Box::new(candidate)))
            }
            Err(top) => Ok(Smallest::OutOfReach(top)),
        }
    }
}

impl CountSearch<'_, '_> {
    /// The smallest number of primitives found that keeps the limit, or else the number from which on more of them gain
    /// nothing.
    fn run(
        &mut self,
        top: usize,
        watch: &mut Watch,
    ) -> Result<Result<WithinLimit, usize>, BuildError> {
        let Some(mut count) = self.first(top, watch)? else {
            return Ok(Err(self.flat_from(top, watch)?));
        };
        let mut residuals = Vec::new();
        let mut breaks = 0;
        let mut best = loop {
            if let Some(found) = self.attempt(count, watch)? {
                break found;
            }
            breaks = count;
            residuals.push(self.residual);
            let stalled = residuals.len() > STALLED
                && count >= FINE
                && self.residual > (1.0 - STALLED_GAIN) * residuals[residuals.len() - 1 - STALLED];
            if count >= top || stalled {
                return Ok(Err(self.flat_from(count, watch)?));
            }
            count = ((count as f64 * STEP) as usize).clamp(count + 1, top);
        };
        while breaks == 0 && best.count > 1 {
            let below = ((best.count as f64 / STEP) as usize).clamp(1, best.count - 1);
            match self.attempt(below, watch)? {
                Some(found) => best = found,
                None => breaks = below,
            }
        }
        while best.count > breaks + (best.count / COUNT_RESOLUTION).max(1) {
            let middle = breaks + (best.count - breaks) / 2;
            match self.attempt(middle, watch)? {
                Some(found) => best = found,
                None => breaks = middle,
            }
        }
        let mut failures = 0;
        let mut below = best.count;
        while below > 1 && best.count <= EACH && failures < FAILURES {
            below -= 1;
            let found = match self.tried.contains(&below) {
                true => None,
                false => self.attempt(below, watch)?,
            };
            match found {
                Some(found) => {
                    below = found.count;
                    best = found;
                    failures = 0;
                }
                None => failures += 1,
            }
        }
        Ok(Ok(best))
    }

    /// The least count, in ratio [`STEP`], of which a fit may keep the limit.
    fn first(&mut self, top: usize, watch: &mut Watch) -> Result<Option<usize>, BuildError> {
        let counts = counts(top);
        // Counts below `low` are too few, that of `high` may do.
        let (mut low, mut high) = (0, counts.len());
        while low < high {
            let middle = (low + high) / 2;
            let mut may = false;
            for ladder in 0..self.ladders.len() {
                may = may || self.may_keep(ladder, counts[middle], watch)?;
            }
            match may {
                true => high = middle,
                false => low = middle + 1,
            }
        }
        Ok(counts.get(high).copied())
    }

    /// The least count, in ratio [`STEP`], whose plain collapse is about as near as any.
    fn flat_from(&mut self, top: usize, watch: &mut Watch) -> Result<usize, BuildError> {
        let counts = counts(top);
        let rough = self.source.rough_target();
        let mut errors = Vec::with_capacity(counts.len());
        for &count in &counts {
            let mut error = f64::INFINITY;
            for ladder in &mut self.ladders {
                let plain = ladder.at(count, watch)?.draft();
                error = rough.largest_below(&plain, error, watch)?.unwrap_or(error);
            }
            errors.push(error);
        }
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let flat = errors.iter().position(|e| *e <= FLAT * least);
        Ok(flat.map_or(top, |k| counts[k]))
    }

    /// Whether a fit of a count may keep the limit, for all that few samples of its plain collapse tell.
    fn may_keep(
        &mut self,
        ladder: usize,
        count: usize,
        watch: &mut Watch,
    ) -> Result<bool, BuildError> {
        let gain = if self.source.fits() {
            LARGEST_GAIN
        } else {
            1.0
        };
        let plain = self.ladders[ladder].at(count, watch)?.draft();
        let rough = self.source.rough_target();
        let largest = rough.largest_below(&plain, gain * self.limit, watch)?;
        Ok(largest.is_some())
    }

    /// A medial mesh of a count that keeps the limit, if one is found.
    fn attempt(
        &mut self,
        count: usize,
        watch: &mut Watch,
    ) -> Result<Option<WithinLimit>, BuildError> {
        watch.attempt();
        self.tried.insert(count);
        self.residual = f64::INFINITY;
        for ladder in 0..self.ladders.len() {
            if !self.may_keep(ladder, count, watch)? {
                continue;
            }
            let (collapsed, kept_topology) = self.ladders[ladder].collapsed(count, watch)?;
            let mut keeping = None;
            if self.source.fits() && !watch.ends_fit(fit::BUDGET) {
                let creases = &self.ladders[ladder].creases;
                let mut target = self.source.target(count);
                target.creases = creases;
                let balanced = fit::balanced(&collapsed, &target, watch)?;
                let largest = target.residuals(&balanced.0, watch)?.largest;
                self.residual = self.residual.min(largest);
                keeping = self.keeping(balanced.0.clone(), Some(&target), watch)?;
                if keeping.is_none() && self.source.limits.quality == Quality::Best {
                    let drafts = fit::more(balanced, &collapsed, &target, watch)?;
                    for (draft, _) in drafts.into_iter().skip(1) {
                        keeping = match keeping {
                            None => self.keeping(draft, Some(&target), watch)?,
                            found => found,
                        };
                    }
                }
            }
            if keeping.is_none() {
                keeping = self.keeping(collapsed.plain, None, watch)?;
            }
            if let Some(enclosed) = keeping {
                return Ok(Some(WithinLimit {
                    count: enclosed.draft.primitives().len(),
                    enclosed,
                    kept_topology,
                    creases: self.ladders[ladder].creases.len(),
                }));
            }
        }
        Ok(None)
    }

    /// A draft, enclosed if asked for, if it keeps the limit, or where a target is given if it does once it covers the
    /// surface more closely.
    fn keeping(
        &self,
        draft: Draft,
        target: Option<&FitTarget>,
        watch: &mut Watch,
    ) -> Result<Option<Enclosed>, BuildError> {
        let (source, limit) = (self.source, self.limit);
        let effort = Effort {
            enough: limit,
            ..Effort::FINE
        };
        let keeps = |e: &Enclosed| e.error() <= limit;
        let loose = source.enclosed(draft, effort, watch)?;
        if keeps(&loose) {
            return Ok(Some(loose));
        }
        let Some(target) = target else {
            return Ok(None);
        };
        let tight = source.tightened(&loose.draft, GAIN_OF_TIGHT * limit, target, watch)?;
        let Some(tight) = tight else {
            return Ok(None);
        };
        let tight = source.measured(tight, loose.before, effort, watch)?;
        Ok(Some(tight).filter(keeps))
    }
}

/// Counts in ratio [`STEP`] up to `top`.
fn counts(top: usize) -> Vec<usize> {
    let mut counts = vec![1];
    while let Some(&count) = counts.last().filter(|c| **c < top) {
        counts.push(((count as f64 * STEP) as usize).clamp(count + 1, top));
    }
    counts
}
