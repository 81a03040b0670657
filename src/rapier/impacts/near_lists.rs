//! Lists of near primitives, kept for pairs that are searched again in one step. An impact gives two bodies another
//! motion, and all their pairs are searched once more, although the same few primitives are near. This file decides
//! when a list is made; what a list is, and why it holds, is in [`crate::pair::near_pairs`].

use crate::elementary::{Paths, ToiOptions};
use crate::math::Real;
use crate::math::fast_hash::FastMap;
use crate::medial::MedialMesh;
use crate::pair::near_pairs::NearPairs;
use crate::rapier::impacts::pair_culling::PairCulling;
use crate::rapier::impacts::toi_query::Work;
use crate::rapier::view::step_view::StepView;
use std::sync::Arc;

/// Queries of a pair in a step before a list is made: a list costs as much as a query.
const QUERIES_BEFORE_LIST: u32 = 1;

/// Margin of a list in units of what the two may travel against each other in the rest of the step. Larger, and more is
/// listed; smaller, and a list holds for fewer impacts.
const MARGIN: f64 = 0.5;

/// Lists of near primitives of each pair that was searched in this step.
#[derive(Default)]
pub struct NearLists(FastMap<[usize; 2], PairRecord>);

/// How often a pair was searched in this step, and its list once it has one.
#[derive(Default)]
struct PairRecord {
    times: u32,
    near: Option<Arc<NearPairs>>,
    /// Whether too much is near.
    is_crowded: bool,
}

impl NearLists {
    /// A list that holds for a query of a pair from `from` to `end` (seconds into the step), if there is one or it is
    /// worth making.
    pub fn list(
        &mut self,
        view: &StepView,
        outlines: &mut PairCulling,
        (pair, meshes): ([usize; 2], [&MedialMesh; 2]),
        [from, end]: [Real; 2],
        options: &ToiOptions,
        work: &mut Work,
    ) -> Option<Arc<NearPairs>> {
        let asked = self.0.entry(pair).or_default();
        asked.times += 1;
        if asked.times <= QUERIES_BEFORE_LIST || asked.is_crowded || options.paths != Paths::Exact {
            return None;
        }
        let motions = &pair.map(|k| view.motion(k, from));
        let seconds = end - from;
        let arms = [0, 1].map(|k| {
            let bound = &view.colliders[pair[k]].bound;
            let arm = (bound.center() - motions[k].local_center).length() + bound.radius();
            f64::from(arm) * (1.0 + 8.0 * f64::from(Real::EPSILON))
        });
        let reach = f64::from(options.target_distance) + f64::from(options.tolerance);
        let holds = |near: &&Arc<NearPairs>| near.holds_for(motions, seconds, arms, reach);
        if let Some(near) = asked.near.as_ref().filter(holds) {
            return Some(Arc::clone(near));
        }
        let slide = f64::from((motions[0].linvel - motions[1].linvel).length());
        let swing = |k: usize| arms[k] * f64::from(motions[k].angvel.length());
        let travel = (slide + swing(0) + swing(1)) * f64::from(seconds);
        let reaches = [reach, MARGIN * travel];
        let within = ((reach + MARGIN * travel) as Real).next_up();
        let near = match outlines.apart_until(view, pair, from, within) {
            None => NearPairs::none(motions, seconds, reaches),
            Some((_, left)) => {
                let near = NearPairs::new((meshes[0], meshes[1]), motions, seconds, reaches, left);
                asked.is_crowded = near.is_none();
                near?
            }
        };
        work.counts.nodes += u64::from(near.nodes());
        let near = Arc::new(near);
        asked.near = Some(Arc::clone(&near));
        Some(near)
    }
}
