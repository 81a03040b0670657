//! The pipeline: from a checked surface to the best draft that the limits allow, stage by stage.

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::axis::start::{Start, start};
use crate::meshing::options::Variant;
use crate::meshing::recipe::candidate::Candidate;
use crate::meshing::recipe::counts::{Collapses, LARGEST_GAIN};
use crate::meshing::recipe::extruded::NEAR;
use crate::meshing::recipe::ladder::Ladder;
use crate::meshing::recipe::polyhedron::polyhedra;
use crate::meshing::recipe::smallest::Smallest;
use crate::meshing::recipe::source::Source;
use crate::meshing::simplify::creased::{Creased, creased};
use crate::meshing::simplify::shared_count::SolidAndSheets;
use crate::meshing::surface::boundary::solid_boundary;
use crate::meshing::watch::Watch;

/// Ratio of the largest residuals, at few samples, of the plain collapses of two medial meshes of a body. One that is
/// worse than the other by more than this is not fitted.
const MAX_ROUGH_RATIO: f64 = 2.0;

/// Samples for tens of primitives.
const FEW_SAMPLES: usize = 2_000;

impl Source {
    /// Makes the best candidate that the limits allow: balls inside where the surface bounds matter, slabs where it is
    /// a sheet. Where it is not exact but could be, it says with how many primitives.
    pub fn best_candidate(&mut self, watch: &mut Watch) -> Result<Candidate, BuildError> {
        let exact = self.exact(self.limits.exact_up_to(), watch)?;
        // With faces that are not quite flat it may be off by more than is allowed.
        let exact = exact.filter(|exact| exact.keeps(self.limits.max_error));
        let count = exact.as_ref().map(|exact| exact.draft.primitives().len());
        let asked = self.limits.primitives.unwrap_or(usize::MAX);
        let (exact, larger) = match count <= Some(asked) {
            true => (exact, None),
            false => (None, exact),
        };
        let is_uneven = self.boundary.as_ref().is_some_and(|b| b.uneven.is_some());
        if is_uneven {
            if let Some(exact) = exact {
                return Ok(exact);
            }
            // Nothing else keeps the parts: what fills their cracks is to tell how deep they are.
            self.find_boundary(false, watch)?;
        }
        let mut candidate = self.best_beside(exact, larger, watch)?;
        candidate.exact_with = count.filter(|_| candidate.variant != Variant::Exact);
        Ok(candidate)
    }

    /// The best candidate, where `exact` is one that is exact, and `larger` one that would be, but has more primitives
    /// than are allowed, if there are any.
    fn best_beside(
        &mut self,
        exact: Option<Candidate>,
        larger: Option<Candidate>,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        if self.limits.max_error.is_none()
            && let Some(exact) = exact
        {
            return Ok(exact);
        }
        let prism = match self.limits.max_error {
            _ if exact.is_some() => None,
            None => self.extruded(watch)?,
            Some(limit) => self.extruded_within(limit, watch)?,
        };
        let prism = match prism {
            Some(prism) if prism.error() <= NEAR => return Ok(prism),
            other => other,
        };
        let reduced = match (larger, self.limits.primitives) {
            (Some(larger), Some(most)) => self.reduced(&larger, most, watch)?,
            _ => None,
        };
        if self.limits.max_error.is_none()
            && let Some(reduced) = reduced
        {
            return Ok(reduced);
        }
        let start = self.start(exact.is_some(), watch)?;
        match self.limits.max_error {
            None => Ok(nearer(self.rounded_or_creased(start, watch)?, prism)),
            Some(limit) => self.within(limit, start, exact.or(prism), reduced, watch),
        }
    }

    /// The medial mesh of balls inside and of slabs: of few samples where it is only to be smaller than one that is
    /// exact.
    pub fn start(&mut self, few: bool, watch: &mut Watch) -> Result<Start, BuildError> {
        let count = match few {
            true => FEW_SAMPLES,
            false => self.limits.samples(self.surface.area),
        };
        let mut findings = std::mem::take(&mut self.surface.findings);
        let own = (&self.surface, &self.tree);
        let start = start(own, self.bounds(), count, &mut findings, watch)?;
        self.surface.findings = findings;
        Ok(start)
    }

    /// The medial mesh whose ends are rounded, and one that keeps creases, if there are any, to be asked for many
    /// counts.
    pub fn ladders(
        &self,
        start: Start,
        watch: &mut Watch,
    ) -> Result<(Ladder<'_>, Option<Ladder<'_>>), BuildError> {
        watch.begin("simplify")?;
        let samples = start.samples;
        let rounded = SolidAndSheets::new(start, &self.tree, watch)?;
        let creased = self.creased(samples, watch)?;
        let creased = creased.map(|c| Ladder::new(SolidAndSheets::solid(c.simplifier), c.creases));
        Ok((Ladder::new(rounded, Vec::new()), creased))
    }

    /// Finds the boundary of the solid; `of_parts` as for [`solid_boundary`].
    fn find_boundary(&mut self, of_parts: bool, watch: &mut Watch) -> Result<(), BuildError> {
        let mut findings = std::mem::take(&mut self.surface.findings);
        self.boundary = solid_boundary(&self.surface, &self.tree, of_parts, &mut findings, watch)?;
        self.surface.findings = findings;
        Ok(())
    }

    /// The medial axes of convex polyhedra or of convex pieces, where the body consists of these. Before, it finds the
    /// boundary of the solid. They have at most `most` primitives.
    pub fn exact(
        &mut self,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<Candidate>, BuildError> {
        self.find_boundary(true, watch)?;
        match self.polyhedra(most, watch)? {
            None => self.pieces(most, watch),
            convex => Ok(convex),
        }
    }

    /// The medial axis of convex polyhedra itself, if it has at most `most` primitives.
    fn polyhedra(&self, most: usize, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        let Some(angle) = self.limits.creases.angle_of_flat() else {
            return Ok(None);
        };
        watch.begin("samples")?;
        let axis = polyhedra(&self.surface, &self.tree, angle, most, watch)?;
        Ok(axis.map(|axis| axis.candidate(&self.limits)))
    }

    /// The better, within the limit on the count, of a medial mesh whose ends are rounded, and one that keeps
    /// creases, if there are any.
    fn rounded_or_creased(&self, start: Start, watch: &mut Watch) -> Result<Candidate, BuildError> {
        watch.begin("simplify")?;
        let samples = start.samples;
        let rounded = SolidAndSheets::new(start, &self.tree, watch)?;
        let most = self.limits.primitives.unwrap_or(usize::MAX);
        let most = most.min(rounded.primitives());
        let rounded = self.collapses(rounded, Vec::new(), most, watch)?;
        let creased = match self.creased(samples, watch)? {
            None => None,
            Some(Creased {
                simplifier,
                creases,
            }) => Some(self.collapses(SolidAndSheets::solid(simplifier), creases, most, watch)?),
        };
        self.better(rounded, creased, watch)
    }

    /// A medial mesh that keeps creases, if any are wanted, and there are any.
    fn creased(
        &self,
        samples: usize,
        watch: &mut Watch,
    ) -> Result<Option<Creased<'_>>, BuildError> {
        let keeps = self.fits() && self.surface.simple && !self.surface.sheet.contains(&true);
        match self.limits.creases.angle().filter(|_| keeps) {
            Some(angle) => creased(&self.surface, &self.tree, angle, samples, watch),
            None => Ok(None),
        }
    }

    /// The better of two medial meshes of one body, fitted and measured.
    fn better(
        &self,
        rounded: Collapses,
        creased: Option<Collapses>,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let Some(creased) = creased else {
            return self.best_of(&rounded, None, watch);
        };
        let sharp_first = creased.rough_error <= rounded.rough_error;
        let (first, second) = match sharp_first {
            true => (&creased, &rounded),
            false => (&rounded, &creased),
        };
        let mut best = self.best_of(first, Some(f64::INFINITY), watch)?;
        let mut is_sharp = sharp_first;
        // The other has that error to beat, and no fit gains more than so much.
        let bar = LARGEST_GAIN * best.error();
        if second.rough_error <= bar.min(MAX_ROUGH_RATIO * first.rough_error) {
            let other = self.best_of(second, Some(best.error()), watch)?;
            if other.error() < best.error() || (sharp_first && other.error() == best.error()) {
                (best, is_sharp) = (other, !sharp_first);
            }
        }
        if is_sharp {
            best.keeps_creases(creased.creases());
        }
        Ok(best)
    }

    /// The smallest medial mesh whose error is at most `limit`, or the best that there is; `exact` is one that keeps it
    /// and may be larger than it takes, and `reduced` one that may not.
    fn within(
        &self,
        limit: f64,
        start: Start,
        exact: Option<Candidate>,
        reduced: Option<Candidate>,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let (exact, reduced) = match reduced {
            Some(reduced) if exact.is_none() && reduced.keeps(Some(limit)) => (Some(reduced), None),
            reduced => (exact, reduced),
        };
        let (mut rounded, mut creased) = self.ladders(start, watch)?;
        let ladders = std::iter::once(&mut rounded)
            .chain(creased.as_mut())
            .collect();
        let asked = self.limits.primitives;
        let below = exact.as_ref().map(|e| e.draft.primitives().len() - 1);
        let top = match self.smallest(ladders, limit, below.or(asked), watch)? {
            Smallest::Found(candidate) => return Ok(*candidate),
            Smallest::OutOfReach(top) => top,
        };
        if let Some(exact) = exact {
            return Ok(exact);
        }
        watch.attempt();
        let rounded = self.collapses(rounded.finest, rounded.creases, top, watch)?;
        let creased = match creased {
            None => None,
            Some(creased) => Some(self.collapses(creased.finest, creased.creases, top, watch)?),
        };
        let prism = self.extruded(watch)?;
        let fitted = self.better(rounded, creased, watch)?;
        let mut candidate = nearer(nearer(fitted, prism), reduced);
        let (count, error) = (candidate.draft.primitives().len(), candidate.error());
        candidate.notes.push(match asked.filter(|most| *most <= top) {
            Some(most) => format!(
                "primitives {most} bound first: the least error {error:.6}, with {count}, is above max_error {}",
                limit as Real
            ),
            None => format!(
                "max_error {} is out of reach: the least error is {error:.6}, with {count} primitives",
                limit as Real
            ),
        });
        Ok(candidate)
    }
}

/// The nearer of a medial mesh and another, if there is one.
fn nearer(first: Candidate, other: Option<Candidate>) -> Candidate {
    match other {
        Some(other) if other.error() < first.error() => other,
        _ => first,
    }
}
