//! The search for the first contact of one pair, which can be interrupted: it goes on only while no other pair comes
//! first. Most pairs are never searched beyond the next impact, because it gives one of the two another motion.

use crate::elementary::ToiOptions;
use crate::math::Real;
use crate::medial::MedialMesh;
use crate::pair::first_contact::Query;
use crate::pair::pair_list::PairList;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::near_lists::NearLists;
use crate::rapier::impacts::pair_culling::PairCulling;
use crate::rapier::impacts::toi_query::{CcdPolicy, QueryOptions, Work};
use crate::rapier::view::step_view::StepView;

/// The medial meshes of both, where they are.
pub type Meshes<'m> = [Option<&'m MedialMesh>; 2];

/// Caches that earlier searches of the step left for later ones: the records of culling, and the lists of near
/// primitives.
pub type SearchCaches<'k> = (&'k mut PairCulling, &'k mut NearLists);

/// The search for the first contact of one pair from some time on, valid while neither of the two has another motion.
pub struct LazyToiQuery<'m> {
    /// Seconds into the step.
    from: Real,
    query_options: QueryOptions,
    running: Option<RunningSearches<'m>>,
}

type MeshQuery<'m> = Query<'m, MedialMesh, MedialMesh>;

/// The searches of two medial meshes once they have begun: for the first contact, and for the floor.
struct RunningSearches<'m> {
    first: Box<MeshQuery<'m>>,
    /// The query for the floor; `None` outside before it is known whether there is one.
    floor: Option<Option<Box<MeshQuery<'m>>>>,
}

/// Progress of a query.
pub enum QueryProgress {
    /// Nothing meets before, in seconds into the step.
    FreeUntil(Real),
    /// The first contact.
    Hit(Hit),
    /// The two do not meet in this step.
    Never,
}

impl QueryProgress {
    fn time(&self) -> Real {
        match self {
            Self::FreeUntil(time) | Self::Hit(Hit { time, .. }) => *time,
            Self::Never => Real::MAX,
        }
    }
}

impl From<Option<Hit>> for QueryProgress {
    fn from(hit: Option<Hit>) -> Self {
        hit.map_or(Self::Never, Self::Hit)
    }
}

impl<'m> LazyToiQuery<'m> {
    /// Nothing is looked at yet.
    pub fn new(from: Real, query_options: QueryOptions) -> Self {
        Self {
            from,
            query_options,
            running: None,
        }
    }

    /// Looks on, at least until `until`, in seconds into the step, or until the budget is spent. Pairs with another
    /// shape are looked at to the end.
    pub fn advance_to(
        &mut self,
        policy: &CcdPolicy,
        view: &StepView,
        pair: [usize; 2],
        meshes: Meshes<'m>,
        until: Real,
        (known, work): (SearchCaches, &mut Work),
    ) -> QueryProgress {
        let from = self.from;
        let [Some(mesh1), Some(mesh2)] = meshes else {
            let hit = policy.first_contact(view, pair, from, &self.query_options, None, work);
            return hit.into();
        };
        let seconds = policy.dt - from;
        let left = &self.query_options.reachable;
        let begin = |options: &ToiOptions, pairs: Option<&PairList>, work: &mut Work| {
            let motions = pair.map(|k| view.motion(k, from));
            work.begin(&motions, options);
            let motions = motions.each_ref();
            let query = Query::new(motions, (mesh1, mesh2), seconds, options, left.clone());
            Box::new(query.among(pairs))
        };
        let look_on = |query: &mut MeshQuery, work: &mut Work| {
            let before = query.counts();
            let share = f64::from(until - from) / f64::from(seconds);
            let free = query.search_within(share, policy.budget_left(work));
            work.counts += query.counts() - before;
            match free {
                Some(share) => QueryProgress::FreeUntil(from + share * seconds),
                None => {
                    let toi = query.toi();
                    Hit::of(&toi, query.met(), from, seconds).into()
                }
            }
        };
        let query_options = &self.query_options;
        let running = self.running.get_or_insert_with(|| {
            let (outlines, lists) = known;
            let (of, options) = ((pair, [mesh1, mesh2]), &query_options.first);
            let near = lists.list(view, outlines, of, [from, policy.dt], options, work);
            RunningSearches {
                first: begin(options, near.as_ref().map(|near| near.pairs()), work),
                floor: None,
            }
        });
        let first = look_on(&mut running.first, work);
        if first.time() <= from {
            return first;
        }
        // All that touched at the start is known now.
        let floor = running.floor.get_or_insert_with(|| {
            let options = query_options.floor.as_ref()?;
            let deep = running.first.may_get_to(policy.floor_depth())?;
            Some(begin(options, Some(&deep), work))
        });
        match floor.as_mut().map(|query| look_on(query, work)) {
            Some(floor) if floor.time() < first.time() => floor,
            _ => first,
        }
    }
}
