//! How fast an impact pushes bodies out of each other. This moves them in the rest of the step and adds nothing to the
//! velocities with which the next one begins.
//!
//! What is deep leaves a share of its depth in each step. That is too slow where the paths of the two curve into each
//! other, as those of linked rings that swing round each other: an impact stops their approach, but they curve on, and
//! each of the next impacts lets them sink in by a little more. A path that gained the approach speed `v` in the time
//! `τ` has the acceleration `a = v/τ`. Thrown back at `√(2 a d)` it comes up by `d` and returns: so with the depth
//! below the floor for `d`, they meet again no deeper than there. Where `v` was gained at once, by a blow from
//! elsewhere, there is no such path: they are thrown back at no more than `2 v`. And at no more than their velocities
//! could make of them, or else bodies between others would be thrown faster from impact to impact.

use crate::math::Real;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::toi_query::CcdPolicy;
use crate::rapier::view::step_view::StepView;

/// How fast the bodies of a hit are pushed apart, a length per second. Thin parts are kept as far from each other as
/// the least gap. `approach`: the speed at which they meet; `fastest`: the most at which points of theirs move against
/// each other; `undisturbed`: the seconds in which their own paths alone brought the approach about, if they did.
pub fn way_out(
    view: &StepView,
    policy: &CcdPolicy,
    pair: [usize; 2],
    hit: &Hit,
    approach: Real,
    fastest: Real,
    undisturbed: Option<Real>,
) -> Real {
    let tuning = &policy.tuning;
    let thickness = view.thickness_at(pair, hit.primitives);
    let below = |share: Real| (hit.depth - share * thickness + policy.least_gap()).max(0.0);
    let approach = approach.max(0.0);
    let thrown = undisturbed.map_or(0.0, |seconds| {
        let back = 2.0 * below(tuning.floor) * approach / seconds;
        back.sqrt().min(2.0 * approach).min(fastest)
    });
    thrown.max(tuning.push * below(tuning.push_depth) / policy.dt)
}
