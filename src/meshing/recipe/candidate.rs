//! A possible result of a build: a medial mesh, enclosed if asked for, and how far it is from the surface. Builds make
//! several and return the best.

use crate::error::BuildError;
use crate::meshing::certify::enclose::enclose;
use crate::meshing::certify::hausdorff::measure;
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::options::{Hausdorff, Quality, Variant};
use crate::meshing::recipe::source::Source;
use crate::meshing::recipe::tightened::GAIN_OF_TIGHT;
use crate::meshing::refine::refit::FitTarget;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;

/// A finished medial mesh and what was measured on it, in the builder's frame.
pub struct Candidate {
    pub draft: Draft,
    pub hausdorff: Hausdorff,
    pub before: Option<Hausdorff>,
    pub notes: Vec<String>,
    pub variant: Variant,
    /// Number of primitives with which it would be exact, where it is not.
    pub exact_with: Option<usize>,
}

impl Candidate {
    pub fn error(&self) -> f64 {
        f64::from(self.hausdorff.error())
    }

    /// Says that spheres of radius 0 lie on `edges` of the source, as far as they pay.
    pub fn keeps_creases(&mut self, edges: usize) {
        self.variant = Variant::Creased { edges };
        let note =
            format!("{edges} sharp convex edges are kept where that makes the error smaller");
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
    pub before: Option<Draft>,
    /// The least error so far without [`Quality::Best`]: it decides which counts are tried, so that
    /// they are the same for both.
    pub lower_quality: f64,
}

impl Enclosed {
    pub fn error(&self) -> f64 {
        self.hausdorff.error().into()
    }

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
            _ => Effort::FINE,
        }
    }

    /// Encloses when asked to, and measures the result.
    pub fn enclosed(
        &self,
        draft: Draft,
        effort: Effort,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        let (draft, before) = self.covering(draft, watch)?;
        self.measured(draft, before, effort, watch)
    }

    /// A draft that covers the surface when asked to, and what it was before.
    pub fn covering(
        &self,
        mut draft: Draft,
        watch: &mut Watch,
    ) -> Result<(Draft, Option<Draft>), BuildError> {
        if !self.limits.enclose {
            return Ok((draft, None));
        }
        watch.begin("enclose")?;
        let before = draft.clone();
        enclose(
            &mut draft,
            &self.surface,
            self.limits.allow_uncovered,
            watch,
        )?;
        Ok((draft, Some(before)))
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

    /// The better of two; the second is measured only until it is worse. Where a target is given, what covers the
    /// surface more closely than the second does is tried as well.
    pub fn or_better(
        &self,
        mut best: Option<Enclosed>,
        other: Draft,
        target: Option<&FitTarget>,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        let (loose, before) = self.covering(other, watch)?;
        let least = best.as_ref().map_or(f64::INFINITY, Enclosed::error);
        if let Some(target) = target
            && let Some(tight) = self.tightened(&loose, GAIN_OF_TIGHT * least, target, watch)?
        {
            best = Some(self.or_covering(best, tight, before.clone(), watch)?);
        }
        self.or_covering(best, loose, before, watch)
    }

    /// The better of two, of which the second is enclosed already.
    fn or_covering(
        &self,
        best: Option<Enclosed>,
        draft: Draft,
        before: Option<Draft>,
        watch: &mut Watch,
    ) -> Result<Enclosed, BuildError> {
        let effort = Effort {
            enough: best.as_ref().map_or(f64::INFINITY, Enclosed::error),
            ..self.effort()
        };
        let next = self.measured(draft, before, effort, watch)?;
        Ok(match best {
            None => next,
            Some(best) if next.error() >= best.error() => best,
            Some(best) => Enclosed {
                lower_quality: best.lower_quality,
                ..next
            },
        })
    }

    /// Measures as well what was there before the enclosure.
    pub fn reported(&self, enclosed: Enclosed, watch: &mut Watch) -> Result<Candidate, BuildError> {
        let mut before = None;
        if let Some(draft) = &enclosed.before {
            watch.begin("measure")?;
            before = Some(self.error_of(draft, Effort::REPORT, watch)?);
        }
        Ok(Candidate {
            draft: enclosed.draft,
            hausdorff: enclosed.hausdorff,
            before,
            notes: Vec::new(),
            variant: Variant::Rounded,
            exact_with: None,
        })
    }
}
