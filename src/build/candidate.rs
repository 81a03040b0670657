//! A possible result of a build: a medial mesh, enclosed if asked for, and how far it is from the surface. Builds make
//! several and return the best.

use super::draft::Draft;
use super::enclose::enclose;
use super::hausdorff::measure;
use super::largest::Effort;
use super::options::{Hausdorff, Quality, Variant};
use super::pipeline::Source;
use super::surface::Surface;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// A finished medial mesh and what was measured on it, in the builder's frame.
pub struct Candidate {
    pub draft: Draft,
    pub hausdorff: Hausdorff,
    pub before: Option<Hausdorff>,
    pub notes: Vec<String>,
    pub variant: Variant,
}

impl Candidate {
    pub fn error(&self) -> f64 {
        f64::from(self.hausdorff.error())
    }

    /// Says that spheres of radius 0 lie on `edges` of the source, as far as they pay.
    pub fn keeps_creases(&mut self, edges: usize) {
        self.variant = Variant::Creased { edges };
        let note = format!("{edges} convex edges are kept where they pay");
        self.notes.push(note);
    }

    /// Whether the error is within a limit.
    pub fn keeps(&self, max_error: Option<f64>) -> bool {
        max_error.is_none_or(|limit| self.error() <= limit)
    }
}

/// A draft after enclosure, its error, and the draft before.
pub struct Enclosed {
    pub draft: Draft,
    pub hausdorff: Hausdorff,
    before: Option<Draft>,
    /// The least error so far without [`Quality::Best`]: it decides which counts are tried, so that
    /// they are the same for both.
    pub lower_quality: f64,
}

impl Enclosed {
    pub fn counted_for_lower_quality(mut self) -> Self {
        let error = f64::from(self.hausdorff.error());
        self.lower_quality = self.lower_quality.min(error);
        self
    }
}

impl Source {
    /// How closely to look at errors: a limit on them is held as closely as can be.
    fn effort(&self) -> Effort {
        match self.limits.quality {
            Quality::Fast if self.limits.max_error.is_none() => Effort::COARSE,
            _ => Effort::CLOSE,
        }
    }

    /// Encloses when asked to, and measures the result.
    pub fn enclosed(
        &self,
        draft: Draft,
        effort: Effort,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        if !self.limits.enclose {
            return self.measured(draft, None, effort, watch);
        }
        watch.begin("enclose")?;
        let before = draft.clone();
        let (mut draft, allowed) = (draft, self.limits.allow_uncovered);
        enclose(&mut draft, &self.surface, allowed, watch)?;
        self.measured(draft, Some(before), effort, watch)
    }

    /// Measures a draft; `before` is what it was before enclosure.
    pub fn measured(
        &self,
        draft: Draft,
        before: Option<Draft>,
        effort: Effort,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        watch.begin("measure")?;
        let hausdorff = self.error_of(&draft, effort, watch)?;
        Ok(Enclosed {
            draft,
            lower_quality: hausdorff.error().into(),
            hausdorff,
            before,
        })
    }

    /// Distances between a draft and the boundary of the solid, both ways.
    fn error_of(
        &self,
        draft: &Draft,
        effort: Effort,
        watch: &mut Watch,
    ) -> Result<Hausdorff, BuildError> {
        let (surface, tree) = self.bounds();
        measure(surface, tree, &self.tree, draft, effort, watch)
    }

    /// The boundary of the solid and its tree.
    pub fn bounds(&self) -> (&Surface, &TriangleTree) {
        match &self.boundary {
            Some(boundary) => (&boundary.surface, &boundary.tree),
            None => (&self.surface, &self.tree),
        }
    }

    /// The better of two; the second is measured only until it is worse.
    pub fn or_better(
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
    pub fn reported(&self, enclosed: Enclosed, watch: &mut Watch) -> Result<Candidate, BuildError> {
        let mut before = None;
        if let Some(draft) = &enclosed.before {
            watch.begin("measure")?;
            before = Some(self.error_of(draft, Effort::ROUGH, watch)?);
        }
        Ok(Candidate {
            draft: enclosed.draft,
            hausdorff: enclosed.hausdorff,
            before,
            notes: Vec::new(),
            variant: Variant::Rounded,
        })
    }
}
