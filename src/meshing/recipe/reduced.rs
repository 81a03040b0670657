//! An exact medial mesh that has more primitives than are allowed, with edges collapsed until it has as many as are.
//! Most of it stays exact, while a fit starts from samples of the surface.

use crate::error::BuildError;
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::options::{Quality, Variant};
use crate::meshing::recipe::candidate::Candidate;
use crate::meshing::recipe::source::Source;
use crate::meshing::refine::swaps::remove;
use crate::meshing::simplify::ball_quadrics::BOUNDARY_WEIGHT_SOLID;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::watch::Watch;

/// Ratio of the primitives of an exact medial mesh to those that are allowed, up to which it is reduced. Of what was
/// measured at half of its primitives, one hull was off by .003, another by .010, and a chair by .016.
const MOST_RATIO: usize = 2;

/// Error (longest side 1) up to which it is returned: fits of hulls are off by .005 to .012, of drums and wheels by .02
/// to .04. Farther off it is not worth what it costs in a simulation: of a chair, at .009, three times as much as a fit
/// that was twice as far off.
const MOST_ERROR: f64 = 0.005;

impl Source {
    /// The medial mesh `exact` with at most `most` primitives, if it is still off by at most [`MOST_ERROR`]. Edges are
    /// collapsed in the order of their quadric error; if that gives none, and more work is allowed, in the order of
    /// their measured error.
    pub fn reduced(
        &self,
        exact: &Candidate,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<Candidate>, BuildError> {
        let exact = without_growth(&exact.draft);
        let count = exact.primitives().len();
        if count > MOST_RATIO.saturating_mul(most) {
            return Ok(None);
        }
        watch.begin("simplify")?;
        let target = self.target(most);
        let by_measure = Simplifier::new(exact, BOUNDARY_WEIGHT_SOLID, target.tree, watch)?;
        let mut by_quadrics = by_measure.clone();
        by_quadrics.reduce_to(most, watch)?;
        let mut near = self.if_near(by_quadrics.draft(), most, watch)?;
        if near.is_none() && self.limits.quality > Quality::Fast {
            watch.begin("simplify")?;
            let draft = remove(by_measure, most, &target, watch)?;
            near = self.if_near(draft, most, watch)?;
        }
        if let Some(near) = &mut near {
            let note = format!("reduced from an exact medial mesh of {count} primitives");
            near.notes.push(note);
        }
        Ok(near)
    }

    /// A draft that covers the surface when asked to, if it has at most `most` primitives and is off by at most
    /// [`MOST_ERROR`].
    fn if_near(
        &self,
        draft: Draft,
        most: usize,
        watch: &mut Watch,
    ) -> Result<Option<Candidate>, BuildError> {
        if draft.primitives().len() > most {
            return Ok(None);
        }
        let effort = Effort {
            enough: MOST_ERROR,
            ..Effort::FINE
        };
        let enclosed = self.enclosed(draft, effort, watch)?;
        if enclosed.error() > MOST_ERROR {
            return Ok(None);
        }
        let mut candidate = self.reported(enclosed, watch)?;
        candidate.variant = Variant::Reduced;
        Ok(Some(candidate))
    }
}

/// An exact medial mesh as it was before all its balls grew alike to cover rounding: those on sharp edges had radius 0.
fn without_growth(exact: &Draft) -> Draft {
    let mut draft = exact.clone();
    let radii = draft.balls.iter().map(|ball| ball.radius);
    let growth = radii.fold(f64::INFINITY, f64::min);
    for ball in &mut draft.balls {
        ball.radius -= growth;
    }
    draft
}
