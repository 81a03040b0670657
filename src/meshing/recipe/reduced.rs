//! An exact medial mesh that has more primitives than are allowed, with edges collapsed until it has as many as are.
//! Most of it stays exact, while a fit starts from samples of the surface.

use crate::error::BuildError;
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::options::{Quality, Variant};
use crate::meshing::recipe::candidate::{Candidate, Enclosed};
use crate::meshing::recipe::extruded::NEAR;
use crate::meshing::recipe::source::Source;
use crate::meshing::refine::swaps::remove;
use crate::meshing::simplify::ball_quadrics::BOUNDARY_WEIGHT_SOLID;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::watch::Watch;

/// Ratio of the primitives of an exact medial mesh to those that are allowed, up to which it is reduced. None of the
/// hulls, drums and frames that were measured was near at twice as many.
const MOST_RATIO: usize = 2;

/// Error (longest side 1) above which one is given up.
const MOST_ERROR: f64 = 4.0 * NEAR;

/// How many times nearer one must be than a fit, where it is off by more than [`NEAR`]: in a simulation it costs more.
/// Of a chair it took three times as long as a fit that was twice as far off.
const GAIN: f64 = 3.0;

impl Source {
    /// The medial mesh `exact` with at most `most` primitives; `None` where it is far off then. Edges are collapsed in
    /// the order of their quadric error; if that is not near, and more work is allowed, also in the order of their
    /// measured error.
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
        let mut best = self.if_near(by_quadrics.draft(), most, MOST_ERROR, watch)?;
        let error = best.as_ref().map_or(MOST_ERROR, Enclosed::error);
        if error > NEAR && self.limits.quality > Quality::Fast {
            watch.begin("simplify")?;
            let draft = remove(by_measure, most, &target, watch)?;
            best = self.if_near(draft, most, error, watch)?.or(best);
        }
        let Some(best) = best else {
            return Ok(None);
        };
        let mut candidate = self.reported(best, watch)?;
        candidate.variant = Variant::Reduced;
        Ok(Some(candidate))
    }

    /// A draft that covers the surface when asked to, if it has at most `most` primitives, and an error below `enough`.
    fn if_near(
        &self,
        draft: Draft,
        most: usize,
        enough: f64,
        watch: &mut Watch,
    ) -> Result<Option<Enclosed>, BuildError> {
        if draft.primitives().len() > most {
            return Ok(None);
        }
        let effort = Effort {
            enough,
            ..Effort::FINE
        };
        let enclosed = self.enclosed(draft, effort, watch)?;
        Ok((enclosed.error() < enough).then_some(enclosed))
    }
}

/// A fit, or a reduced medial mesh, if there is one and it is so much nearer that it is worth its cost.
pub fn or_reduced(fitted: Candidate, reduced: Option<Candidate>) -> Candidate {
    match reduced {
        Some(reduced) if GAIN * reduced.error() < fitted.error() => reduced,
        _ => fitted,
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
