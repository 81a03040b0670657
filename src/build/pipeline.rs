//! The pipeline: from a checked surface to the best draft that the limits allow, stage by stage.

use super::candidate::Candidate;
use super::counts::Collapses;
use super::creased::{Creased, creased};
use super::enclose::enclose_exactly;
use super::largest::Effort;
use super::options::{Limits, Quality};
use super::parts::Parts;
use super::polyhedron::{EXACT, polyhedron};
use super::solid_boundary::solid_boundary;
use super::start::{Start, start};
use super::surface::Surface;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// Note on a result that is not what the source was.
pub const GAVE_UP: &str = "holes or parts were given up to reach the count";

/// The plain collapses of two medial meshes of one body are compared by few samples: the one whose largest
/// residual is above this many of the other's is not fitted.
const HOPELESS: f64 = 2.0;

/// The checked surface, its tree, and what to build from it.
pub struct Source {
    pub surface: Surface,
    pub tree: TriangleTree,
    pub limits: Limits,
    /// What fits are fitted to where the surface overlaps itself or has gaps: the boundary of the solid.
    pub boundary: Option<(Surface, TriangleTree)>,
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
        let has_sheets = self.surface.sheet.contains(&true) || start.share > 0.0;
        if self.limits.quality > Quality::Fast && !self.surface.simple && !has_sheets {
            self.boundary = solid_boundary(&self.surface, &self.tree, watch)?;
        }
        self.candidate(start, count, watch)
    }

    /// The medial axis of a convex polyhedron itself, if that is within the limit on the count.
    fn polyhedron(&self, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        let most = self.limits.primitives.unwrap_or(usize::MAX);
        let Some(angle) = self.limits.creases.angle_of_flat() else {
            return Ok(None);
        };
        let Some(draft) = polyhedron(&self.surface, &self.tree, angle, most, watch)? else {
            return Ok(None);
        };
        // Where balls cover all of the surface without growing, no part of the axis is missing.
        watch.begin("enclose")?;
        let mut covering = draft.clone();
        let certain = enclose_exactly(&mut covering, &self.surface, watch)?;
        let mut balls = covering.balls.iter().zip(&draft.balls);
        if !certain || balls.any(|(grown, ball)| grown.radius - ball.radius > EXACT) {
            return Ok(None);
        }
        let (draft, before) = match self.limits.enclose {
            true => (covering, Some(draft)),
            false => (draft, None),
        };
        let measured = self.measured(draft, before, Effort::CLOSE, watch)?;
        let mut candidate = self.reported(measured, watch)?;
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
    fn candidate(
        &self,
        start: Start,
        samples: usize,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        watch.begin("simplify")?;
        let most = self.limits.primitives.unwrap_or(usize::MAX);
        let mut parts = Parts::new(start, &self.tree, watch)?;
        if self.limits.max_error.is_none() {
            parts = match parts.into_only_solid() {
                Ok(rounded) => {
                    let rounded = self.collapses(rounded, Vec::new(), most, watch)?;
                    return self.rounded_or_creased(rounded, samples, watch);
                }
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

    /// The better of a medial mesh whose ends are rounded, and one that keeps creases, if there are any.
    fn rounded_or_creased(
        &self,
        rounded: Collapses,
        samples: usize,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let keeps = self.fits() && self.surface.simple;
        let angle = self.limits.creases.angle().filter(|_| keeps);
        let creased = match angle {
            Some(angle) => creased(&self.surface, &self.tree, angle, samples, watch)?,
            None => None,
        };
        let Some(Creased {
            simplifier,
            creases,
        }) = creased
        else {
            return self.best_of(&rounded, watch);
        };
        let creased = self.collapses(simplifier, creases, rounded.most(), watch)?;
        let [error, other] = [&rounded, &creased].map(|c| c.rough_error);
        let rounded = match error > HOPELESS * other {
            true => None,
            false => Some(self.best_of(&rounded, watch)?),
        };
        if other > HOPELESS * error
            && let Some(rounded) = rounded
        {
            return Ok(rounded);
        }
        let kept = creased.creases();
        let mut creased = self.best_of(&creased, watch)?;
        creased
            .notes
            .push(format!("{kept} convex edges are kept where they pay"));
        Ok(match rounded {
            Some(rounded) if rounded.error() <= creased.error() => rounded,
            _ => creased,
        })
    }
}
