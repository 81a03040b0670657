//! The search for the first contact of one pair, which can be interrupted: it goes on only while no other pair comes
//! first. Most pairs are never searched beyond the next impact, because it gives one of the two another motion.

use crate::elementary::ToiOptions;
use crate::math::Real;
use crate::medial::MedialMesh;
use crate::pair::first_contact::Query;
use crate::rapier::impacts::toi_query::{CcdPolicy, Hit, QueryOptions, Work};
use crate::rapier::view::step_view::StepView;

/// The medial meshes of both, where they are.
pub type Meshes<'m> = [Option<&'m MedialMesh>; 2];

/// A question about a pair from some time on, while neither of the two has another motion.
pub struct LazyToiQuery<'m> {
    /// Seconds into the step.
    from: Real,
    query_options: QueryOptions,
    begun: Option<Begun<'m>>,
}

type MeshQuery<'m> = Query<'m, MedialMesh, MedialMesh>;

struct Begun<'m> {
    first: Box<MeshQuery<'m>>,
    /// The query for the floor; `None` outside before it is known whether there is one.
    floor: Option<Option<Box<MeshQuery<'m>>>>,
}

/// What is known of it.
pub enum QueryProgress {
    /// Nothing meets before, in seconds into the step.
    FreeUntil(Real),
    /// The first contact.
    Hit(Hit),
    /// They do not meet in this step.
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
            begun: None,
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
        work: &mut Work,
    ) -> QueryProgress {
        let from = self.from;
        let [Some(mesh1), Some(mesh2)] = meshes else {
            let hit = policy.first_contact(view, pair, from, &self.query_options, None, work);
            return hit.into();
        };
        let seconds = policy.dt - from;
        let left = &self.query_options.left;
        let begin = |options: &ToiOptions, work: &mut Work| {
            let motions = pair.map(|k| view.motion(k, from));
            work.begin(&motions, options);
            let motions = motions.each_ref();
            Box::new(Query::new(
                motions,
                (mesh1, mesh2),
                seconds,
                options,
                left.clone(),
            ))
        };
        let look_on = |query: &mut MeshQuery, work: &mut Work| {
            let before = query.counts();
            let share = f64::from(until - from) / f64::from(seconds);
            let free = query.search_within(share, policy.left(work));
            work.add_since(query.counts(), before);
            match free {
                Some(share) => QueryProgress::FreeUntil(from + share * seconds),
                None => Hit::of(&query.toi(), query.met(), from, seconds).into(),
            }
        };
        let query_options = &self.query_options;
        let begun = self.begun.get_or_insert_with(|| Begun {
            first: begin(&query_options.first, work),
            floor: None,
        });
        let first = look_on(&mut begun.first, work);
        if first.time() <= from {
            return first;
        }
        // All that touched at the start is known now.
        let floor = begun.floor.get_or_insert_with(|| {
            let deep = policy.is_deep(begun.first.deepest());
            let asked = query_options.floor.as_ref().filter(|_| deep);
            asked.map(|options| begin(options, work))
        });
        match floor.as_mut().map(|query| look_on(query, work)) {
            Some(floor) if floor.time() < first.time() => floor,
            _ => first,
        }
    }
}
