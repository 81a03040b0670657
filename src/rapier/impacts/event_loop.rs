//! The event loop: after rapier's step it finds the impacts within the step that rapier missed, and resolves them
//! in the order of their times.
//!
//! Each pair waits in a queue at the time before which it is known not to meet. The first in the queue is searched
//! further until its first contact is known or another pair comes first. An impact moves both bodies to its time and
//! gives two impulses: one to the velocities that the solver left, so that the next step begins right, and one to the
//! motion of this step, so that the rest of it is right ([`crate::rapier::impacts::response`]; the law is in
//! [`crate::rapier::impacts::impulse`]). Then all pairs of the bodies that changed are searched again. A body with
//! more than [`Tuning::max_events`](crate::rapier::tuning::Tuning) impacts stays where it is for the rest of the
//! step, or is carried along by what pushes it. No impact of a pair that the loop has is ever dropped, not even at the
//! current time; so no medial axis of such a pair crosses another on the motion that is executed. Pairs that nothing
//! could part are left to rapier's solver ([`crate::rapier::impacts::initial_overlaps`],
//! [`crate::rapier::impacts::pinched`], [`Loop::enqueue_hit`]).

use crate::batch::{Batch, ToiJob, ToiResult};
use crate::math::Real;
use crate::math::fast_hash::FastMap;
use crate::medial::MedialMesh;
use crate::rapier::host::reported_impulse::Impulse;
use crate::rapier::impacts::deep_pairs::{Deep, DeepPairs, deep};
use crate::rapier::impacts::event_queue::EventQueue;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::initial_overlaps::InitialOverlaps;
use crate::rapier::impacts::lazy_toi_query::{LazyToiQuery, Meshes, QueryProgress};
use crate::rapier::impacts::near_lists::NearLists;
use crate::rapier::impacts::outcome::Outcome;
use crate::rapier::impacts::pair_culling::PairCulling;
use crate::rapier::impacts::response::Response;
use crate::rapier::impacts::swept_boxes::SweptBoxes;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::view::eligible_pairs::{Rules, in_order, is_ccd_candidate, sweep};
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::near_what_moves;
use crate::rapier::view::participants::{Contacts, Participants};
use crate::rapier::view::step_view::StepView;
use parry3d::shape::SharedShape;
use rapier3d::geometry::NarrowPhase;

/// Shares of a step before and after which the world does not stop: what is left would be no step, and
/// a stop at the start would change nothing.
const STOPS_WITHIN: [Real; 2] = [1.0e-3, 1.0 - 1.0e-3];

/// Next event.
enum Next {
    /// Two colliders meet.
    Impact([usize; 2], Hit),
    /// A piece of the motion of bodies that joints hold ends.
    Piece(Real),
    /// The budget is spent.
    Spent,
}

/// Query or hit that a pair waits for.
pub(crate) enum Pending<'a> {
    Answer(LazyToiQuery<'a>),
    Hit(Hit),
}

/// The loop on its way.
pub(crate) struct Loop<'a> {
    pub(crate) view: &'a mut StepView,
    pub(crate) policy: CcdPolicy<'a>,
    pub(crate) rules: Rules<'a>,
    /// Pairs near enough to their medial axes to be watched, however slow they are: in rapier's contacts, or in an
    /// impact.
    deep: FastMap<[usize; 2], Deep>,
    /// Whether the user's rules let a pair respond, as far as they were asked.
    allowed: FastMap<[usize; 2], bool>,
    pub(crate) response: Response,
    /// Box of each collider from its body's last impact to the end of the step, once there was one.
    pub(crate) boxes: SweptBoxes,
    /// Colliders of each body, likewise.
    pub(crate) parts_of: Vec<Vec<usize>>,
    /// The shapes of the colliders.
    shapes: &'a [SharedShape],
    pub(crate) queue: EventQueue<Pending<'a>>,
    pub(crate) outlines: PairCulling,
    lists: NearLists,
    jobs: usize,
    events: usize,
    /// Whether the budget was spent, so that nothing waits any more but for what a driven body does.
    pub(crate) is_spent: bool,
    /// Colliders that take part, where not all do, and whether something may get to another.
    pub(crate) participants: Option<&'a Participants>,
    leaves: bool,
}

/// Finds and resolves the impacts on the motions of `view`, which is at the bodies' last poses
/// afterwards. `None` if something may get to a collider that does not take part; the motions are of no use then.
pub fn resolve(
    view: &mut StepView,
    policy: CcdPolicy,
    rules: Rules,
    contacts: Contacts,
    initial_overlaps: &mut InitialOverlaps,
    batch: &mut Batch,
    work: &mut Work,
) -> Option<Outcome> {
    let Contacts {
        narrow_phase,
        participants,
        depth,
    } = contacts;
    if participants.is_some_and(|p| near_what_moves::leaves(view, p, (policy.dt, policy.unit))) {
        return None;
    }
    let guarded = policy.tuning.guarded();
    let thinnest = view.thinnest_part();
    let deep = if depth > guarded * thinnest {
        deep(view, (narrow_phase, participants), &policy)
    } else {
        DeepPairs::default()
    };
    let left = initial_overlaps.leave(view, participants, &deep, &rules);
    let deep = deep.watched;
    let all = view.bodies.iter().enumerate();
    let taken = all.filter(|(_, body)| body.is_taken_back);
    let taken: Vec<usize> = taken.map(|(b, _)| b).collect();
    if taken.is_empty()
        && deep.is_empty()
        && !policy.may_be_fast(view, policy.tuning.fast, thinnest)
    {
        return Some(Outcome::default());
    }
    let mut response = Response::new(view.bodies.len());
    response.lead(view, &policy, &rules, &taken);
    let pairs = sweep(view, policy.dt, near_what_moves::MARGIN * policy.unit);
    let shapes: Vec<_> = view.colliders.iter().map(|p| p.shape.clone()).collect();
    let mut impacts = Loop {
        view,
        policy,
        rules,
        deep,
        allowed: left.into_iter().map(|pair| (pair, false)).collect(),
        response,
        boxes: SweptBoxes::default(),
        parts_of: Vec::new(),
        shapes: &shapes,
        queue: EventQueue::default(),
        outlines: PairCulling::new(shapes.len(), policy.dt),
        lists: NearLists::default(),
        jobs: 0,
        events: 0,
        is_spent: false,
        participants,
        leaves: false,
    };
    let mut known = FastMap::default();
    if batch.has_device() {
        let (asked, jobs): (Vec<_>, Vec<_>) = impacts.first_queries(&pairs).into_iter().unzip();
        known.extend(asked.into_iter().zip(batch.run(&jobs)));
    }
    for pair in pairs {
        impacts.ask(pair, 0.0, known.remove(&pair), work);
    }
    impacts.run(narrow_phase, work)
}

impl Loop<'_> {
    /// Resolves what the queue holds, in the order of times. `None` if something may get to a collider that does not
    /// take part.
    fn run(mut self, narrow_phase: &NarrowPhase, work: &mut Work) -> Option<Outcome> {
        while !self.leaves
            && let Some(next) = self.earliest(work)
        {
            self.find_boxes();
            match next {
                Next::Impact(pair, hit) if self.stops_at(pair, hit.time) => {
                    return Some(self.stop(hit.time, narrow_phase));
                }
                Next::Impact(pair, hit) => self.impact(pair, hit, work),
                Next::Piece(time) => self.begin_piece(time, work),
                Next::Spent => self.wait(work),
            }
        }
        (!self.leaves).then(|| self.finish())
    }

    /// Looks for the earliest impact, or end of a piece: always where the next may be, and no further than to where
    /// another may come first.
    fn earliest(&mut self, work: &mut Work) -> Option<Next> {
        loop {
            if !self.is_spent && self.policy.budget_left(work) == 0 {
                return Some(Next::Spent);
            }
            let piece = self.response.next_piece();
            let waits = self.queue.first_time();
            if let Some(time) = piece.filter(|time| waits.is_none_or(|first| *time <= first)) {
                return Some(Next::Piece(time));
            }
            let (pair, first, next) = self.queue.first()?;
            let inquiry = match first {
                Pending::Hit(hit) => return Some(Next::Impact(pair, hit.clone())),
                Pending::Answer(inquiry) => inquiry,
            };
            let until = next
                .into_iter()
                .chain(piece)
                .fold(self.policy.dt, Real::min);
            let shapes = self.shapes;
            let meshes: Meshes = pair.map(|k| shapes[k].as_shape::<MedialMesh>());
            let known = ((&mut self.outlines, &mut self.lists), &mut *work);
            match inquiry.advance_to(&self.policy, self.view, pair, meshes, until, known) {
                QueryProgress::FreeUntil(time) => self.queue.reschedule_first(time),
                QueryProgress::Hit(hit) => self.enqueue_hit(pair, hit),
                QueryProgress::Never => self.queue.remove(pair),
            }
        }
    }

    /// Puts a hit in the queue, where the user's rules allow it. Neighbours on a joint that overlap before they met
    /// in this step are left to rapier's solver: the joint presses them there again whatever an impact does.
    fn enqueue_hit(&mut self, pair: [usize; 2], hit: Hit) {
        self.queue.remove(pair);
        let (view, rules) = (&*self.view, self.rules);
        let allowed = self.allowed.entry(pair);
        let allowed = allowed.or_insert_with(|| rules.respond(view, pair));
        let is_pressed = hit.depth > 0.0 && self.response.impact_count(pair) == 0;
        *allowed &= !(is_pressed && rules.are_jointed(view, pair));
        if *allowed {
            self.queue.insert(pair, hit.time, Pending::Hit(hit));
        }
    }

    fn stops_at(&self, pair: [usize; 2], time: Real) -> bool {
        let [first, last] = STOPS_WITHIN.map(|share| share * self.policy.dt);
        (first..=last).contains(&time) && self.policy.stops(self.view, pair)
    }

    fn is_deep(&self, pair: [usize; 2]) -> bool {
        self.deep.contains_key(&pair)
    }

    /// The first queries of all pairs of medial meshes.
    fn first_queries(&self, pairs: &[[usize; 2]]) -> Vec<([usize; 2], ToiJob)> {
        let job = |pair: &[usize; 2]| {
            if !self.rules.may_respond(self.view, *pair) {
                return None;
            }
            let job = self.policy.job(self.view, *pair, self.is_deep(*pair))?;
            Some((*pair, job))
        };
        pairs.iter().filter_map(job).collect()
    }

    pub(crate) fn ask(
        &mut self,
        pair: [usize; 2],
        time: Real,
        known: Option<ToiResult>,
        work: &mut Work,
    ) {
        self.queue.remove(pair);
        // The user's filters are asked once per pair and step, and only where it matters.
        if self.allowed.get(&pair) == Some(&false)
            || !self.response.is_movable(self.view, &self.policy, pair)
        {
            return;
        }
        let met = self.response.impact_count(pair);
        let (policy, deep) = (self.policy, self.is_deep(pair));
        if !self.rules.may_respond(self.view, pair) {
            self.allowed.insert(pair, false);
            return;
        }
        let Some(mut query_options) = policy.query_options(self.view, pair, time, met, deep) else {
            return;
        };
        let medial = |k: &usize| self.view.colliders[*k].medial().is_some();
        self.jobs += usize::from(self.events == 0 && pair.iter().all(medial));
        // The floor is for primitives that the search for the first contact names.
        let known = known.filter(|known| known.deepest > policy.floor_depth());
        if known.is_some() {
            let hit = policy.first_contact(self.view, pair, time, &query_options, known, work);
            if let Some(hit) = hit {
                self.enqueue_hit(pair, hit);
            }
            return;
        }
        let reach = query_options.first.target_distance + query_options.first.tolerance;
        let outlines = &mut self.outlines;
        if let Some((until, left)) = outlines.apart_until(self.view, pair, time, reach) {
            query_options.reachable = left;
            let inquiry = Pending::Answer(LazyToiQuery::new(time, query_options));
            self.queue.insert(pair, until, inquiry);
        }
    }

    /// Lets two colliders meet.
    fn impact(&mut self, pair: [usize; 2], hit: Hit, work: &mut Work) {
        self.events += 1;
        let (policy, rules) = (self.policy, self.rules);
        // An impact may make a deep pair slow, and another one push it on.
        let thickness = self.view.thickness_at(pair, hit.primitives);
        if hit.depth > policy.tuning.guarded() * thickness {
            self.deep.entry(pair).or_default();
        }
        let time = hit.time;
        let bodies = self.response.impact(self.view, &policy, &rules, pair, hit);
        self.ask_again(&bodies, time, work);
    }

    fn begin_piece(&mut self, time: Real, work: &mut Work) {
        let policy = self.policy;
        let bodies = self.response.begin_piece(self.view, &policy, time);
        self.ask_again(&bodies, time, work);
    }

    /// Asks from `time` on for all pairs of bodies that have another motion.
    fn ask_again(&mut self, bodies: &[usize], time: Real, work: &mut Work) {
        let free = |b: &&usize| self.view.bodies[**b].mobility == Mobility::Free;
        let parts = bodies.iter().filter(free).map(|b| &self.parts_of[*b]);
        let mut changed: Vec<usize> = parts.flatten().copied().collect();
        changed.sort_unstable();
        changed.dedup();
        for &k in &changed {
            let aabb = self.swept_box(k, time);
            self.leaves |= self.meets_bystander(&aabb);
            self.boxes.set(k, aabb);
            self.outlines.forget(k);
        }
        for (n, &i) in changed.iter().enumerate() {
            let meeting = self.boxes.meeting(i);
            for j in self.queue.partners(i) {
                if meeting.binary_search(&j).is_err() {
                    self.queue.remove(in_order(self.view, [i, j]));
                }
            }
            for j in meeting {
                if !changed[..n].contains(&j) && is_ccd_candidate(self.view, [i, j]) {
                    self.ask(in_order(self.view, [i, j]), time, None, work);
                }
            }
        }
    }

    /// Ends the step here for all bodies. Undoes the forces' velocity after the stop, since the next part of the step
    /// applies it again; a velocity that contacts of the solver made is taken for theirs from the start of the step on.
    fn stop(mut self, time: Real, narrow_phase: &NarrowPhase) -> Outcome {
        let left = 1.0 - time / self.policy.dt;
        let body_states = &mut self.response.body_states;
        let mut pushed: Vec<bool> = body_states.iter().map(|c| c.struck).collect();
        for part in &self.view.colliders {
            let mut contacts = narrow_phase.contact_pairs_with(part.handle);
            pushed[part.body] |= contacts.any(|c| c.total_impulse_magnitude() > 0.0);
        }
        for (b, body) in self.view.bodies.iter_mut().enumerate() {
            if body.mobility != Mobility::Fixed && body.awake {
                body_states[b].moved = true;
                if body.mobility == Mobility::Free && !pushed[b] {
                    body.undo_forces(left);
                    body_states[b].struck = true;
                }
            }
        }
        let dt = std::mem::replace(&mut self.policy.dt, time);
        let mut outcome = self.finish();
        outcome.stopped = (time < dt).then_some(time);
        outcome
    }

    fn finish(self) -> Outcome {
        let mut outcome = Outcome {
            jobs: self.jobs,
            events: self.events,
            ..Outcome::default()
        };
        for (b, course) in self.response.body_states.iter().enumerate() {
            if !course.moved {
                continue;
            }
            outcome.frozen += usize::from(course.frozen && !course.waits);
            outcome.waiting += usize::from(course.waits);
            outcome.changed.push((b, course.struck));
            self.view.bodies[b].advance(self.policy.dt);
        }
        outcome.impulses = self
            .response
            .impulses
            .iter()
            .map(|(pair, blows)| Impulse {
                colliders: pair.map(|k| self.view.colliders[k].handle),
                blows: blows.clone(),
            })
            .collect();
        outcome
    }
}
