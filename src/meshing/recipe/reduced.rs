//! An exact medial mesh that has more primitives than are allowed, with edges collapsed until it has as many as are.
//! Most of it stays exact, while a fit starts from samples of the surface.

use crate::error::BuildError;
use crate::meshing::draft::Draft;
use crate::meshing::options::{Quality, Variant};
use crate::meshing::recipe::candidate::{Candidate, Enclosed};
use crate::meshing::recipe::extruded::NEAR;
use crate::meshing::recipe::source::Source;
use crate::meshing::refine::swaps::remove;
use crate::meshing::simplify::ball_quadrics::BOUNDARY_WEIGHT_SOLID;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::watch::Watch;

/// Ratio of the primitives of an exact medial mesh to those that are allowed, up to which it is reduced. At twice as
/// many, fits of hulls, frames and wheels were about as near.
const MOST_RATIO: usize = 2;

impl Source {
    /// The medial mesh `exact` with at most `most` primitives; `None` where it has far more. Edges are collapsed in the
    /// order of their quadric error; where that is not near and more work is allowed, also in the order of their
    /// measured error, and the nearer of the two is returned.
    pub fn reduced(
        &self,
        exact: &Candidate,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<Candidate>, BuildError> {
        let exact = without_growth(&exact.draft);
        if exact.primitives().len() > MOST_RATIO.saturating_mul(most) {
            return Ok(None);
        }
        watch.begin("simplify")?;
        let target = self.target(most);
        let by_measure = Simplifier::new(exact, BOUNDARY_WEIGHT_SOLID, target.tree, watch)?;
        let mut by_quadrics = by_measure.clone();
        by_quadrics.reduce_to(most, watch)?;
        let mut best = self.if_few(None, by_quadrics.draft(), most, watch)?;
        let is_near = best.as_ref().is_some_and(|best| best.error() <= NEAR);
        if !is_near && self.limits.quality > Quality::Fast {
            watch.begin("simplify")?;
            let draft = remove(by_measure, most, &target, watch)?;
            best = self.if_few(best, draft, most, watch)?;
        }
        let Some(best) = best else {
            return Ok(None);
        };
        let mut candidate = self.reported(best, watch)?;
        candidate.variant = Variant::Reduced;
        Ok(Some(candidate))
    }

    /// The better of `best` and a draft, where that has at most `most` primitives.
    fn if_few(
        &self,
        best: Option<Enclosed>,
        draft: Draft,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<Enclosed>, BuildError> {
        match draft.primitives().len() <= most {
            true => Ok(Some(self.or_better(best, draft, None, watch)?)),
            false => Ok(best),
        }
    }
}

/// An exact medial mesh as it was before all its balls grew alike to cover rounding: those on sharp edges had radius 0.
fn without_growth(exact: &Draft) -> Draft {
    let mut draft = exact.clone();
    let radii = draft.balls.iter().map(|ball| ball.radius);
    let growth = radii.fold(f64::INFINITY, f64::min);
    draft
        .balls
        .iter_mut()
        .for_each(|ball| ball.radius -= growth);
    draft
}
