//! The search for the first contact of one pair, which can be interrupted: it goes on only while no other pair comes
//! first. Most pairs are never searched beyond the next impact, because it gives one of the two another motion.

use super::first_contact::{Asker, Hit, Question, Work};
use super::snapshot::Snapshot;
use crate::elementary::ToiOptions;
use crate::math::Real;
use crate::medial::MedialMesh;
use crate::pair::first_contact::Query;

/// The medial meshes of both, where they are.
pub type Meshes<'m> = [Option<&'m MedialMesh>; 2];

/// A question about a pair from some time on, while neither of the two has another motion.
pub struct Inquiry<'m> {
    /// Seconds into the step.
    from: Real,
    question: Question,
    begun: Option<Begun<'m>>,
}

type MeshQuery<'m> = Query<'m, MedialMesh, MedialMesh>;

struct Begun<'m> {
    first: Box<MeshQuery<'m>>,
    /// The query for the floor; `None` outside before it is known whether there is one.
    floor: Option<Option<Box<MeshQuery<'m>>>>,
}

/// What is known of it.
pub enum Known {
    /// Nothing meets before, in seconds into the step.
    FreeUntil(Real),
    /// The first contact.
    Hit(Hit),
    /// They do not meet in this step.
    Never,
}

impl Known {
    fn time(&self) -> Real {
        match self {
            Self::FreeUntil(time) | Self::Hit(Hit { time, .. }) => *time,
            Self::Never => Real::MAX,
        }
    }
}

impl From<Option<Hit>> for Known {
    fn from(hit: Option<Hit>) -> Self {
        hit.map_or(Self::Never, Self::Hit)
    }
}

impl<'m> Inquiry<'m> {
    /// Nothing is looked at yet.
    pub fn new(from: Real, question: Question) -> Self {
        Self {
            from,
            question,
            begun: None,
        }
    }

    /// Looks on, at least until `until`, in seconds into the step, or until the budget is spent. Pairs with another
    /// shape are looked at to the end.
    pub fn pursue(
        &mut self,
        asker: &Asker,
        snapshot: &Snapshot,
        pair: [usize; 2],
        meshes: Meshes<'m>,
        until: Real,
        work: &mut Work,
    ) -> Known {
        let from = self.from;
        let [Some(mesh1), Some(mesh2)] = meshes else {
            let hit = asker.first_contact(snapshot, pair, from, &self.question, None, work);
            return hit.into();
        };
        let seconds = asker.dt - from;
        let left = &self.question.left;
        let begin = |options: &ToiOptions, work: &mut Work| {
            let motions = pair.map(|k| snapshot.motion(k, from));
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
            let free = query.search_within(share, asker.left(work));
            work.add_since(query.counts(), before);
            match free {
                Some(share) => Known::FreeUntil(from + share * seconds),
                None => Hit::of(&query.toi(), from, seconds).into(),
            }
        };
        let question = &self.question;
        let begun = self.begun.get_or_insert_with(|| Begun {
            first: begin(&question.first, work),
            floor: None,
        });
        let first = look_on(&mut begun.first, work);
        if first.time() <= from {
            return first;
        }
        // All that touched at the start is known now.
        let floor = begun.floor.get_or_insert_with(|| {
            let deep = asker.is_deep(begun.first.deepest());
            let asked = question.floor.as_ref().filter(|_| deep);
            asked.map(|options| begin(options, work))
        });
        match floor.as_mut().map(|query| look_on(query, work)) {
            Some(floor) if floor.time() < first.time() => floor,
            _ => first,
        }
    }
}
