//! Response of bodies to an impact: when a body stops after too many impacts, and how an impact is passed on to bodies
//! that touch already. The impulses of one contact are in [`crate::rapier::impacts::contact_impulses`].
//!
//! In a crowd an impact presses on contacts that earlier impacts of the step left. Found one by one, each a hair later
//! than the last, these would be three impacts of four, and freeze the bodies in the middle. So all that touches is
//! solved together at the time of the impact (paper, section 4.5), by sequential impulses, until nothing approaches
//! fast enough to meet again in this step. Fixed bodies take part: the links of a taut chain between a heavy load and
//! its hook would else hand the load's momentum to and fro, and be frozen. Driven bodies do not: the rounds between two
//! of them would not end, and their friction would hold what they press out. No contact is taken for granted
//! afterwards: all pairs of the bodies that changed are searched again.

use crate::math::fast_hash::FastSet;
use crate::math::{Real, Vector};
use crate::rapier::host::reported_impulse::ReportedImpulse;
use crate::rapier::impacts::body_state::BodyImpactState;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::impact_history::ImpactHistory;
use crate::rapier::impacts::toi_query::CcdPolicy;
use crate::rapier::joints::jointed_bodies::Joints;
use crate::rapier::joints::pieces::MotionPieces;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;
use std::collections::BTreeMap;

type Pair = [usize; 2];

/// Most rounds in which an impact is passed on. They converge slowly where a heavy body hangs on light ones: a load of
/// 2 t, or 3.2 t, draws a chain of ten rings of 21 kg out by 0.27 and 0.48 m with 8 rounds, by 0.18 and 0.27 m with 64.
/// Heaps of creatures are the same with 16, 32 and 64.
const ROUNDS: usize = 64;

/// Record of what the impacts of a step did so far.
pub struct Response {
    /// State of each body.
    pub body_states: Vec<BodyImpactState>,
    /// Between two colliders, those of one normal summed.
    pub impulses: BTreeMap<Pair, Vec<ReportedImpulse>>,
    history: ImpactHistory,
    /// Joints, once something was struck.
    pub(crate) joints: Option<Joints>,
    pub(crate) pieces: MotionPieces,
}

/// The bodies of two colliders.
pub(crate) fn bodies(view: &StepView, pair: Pair) -> [usize; 2] {
    pair.map(|k| view.colliders[k].body)
}

impl Response {
    /// Nothing has happened to so many bodies.
    pub fn new(bodies: usize) -> Self {
        Self {
            body_states: vec![BodyImpactState::default(); bodies],
            impulses: BTreeMap::new(),
            history: ImpactHistory::default(),
            joints: None,
            pieces: MotionPieces::default(),
        }
    }

    /// How often a pair met.
    pub fn impact_count(&self, pair: Pair) -> u32 {
        self.history.count(pair)
    }

    /// Whether an impact could still change the motion of either.
    pub fn is_movable(&self, view: &StepView, policy: &CcdPolicy, pair: Pair) -> bool {
        bodies(view, pair).iter().any(|&b| {
            view.bodies[b].mobility == Mobility::Free
                && self.body_states[b].events <= policy.tuning.max_carried()
        })
    }

    /// Lets two colliders meet; returns the bodies whose pairs are to be asked again.
    pub fn impact(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        rules: &Rules,
        pair: Pair,
        hit: Hit,
    ) -> Vec<usize> {
        let bodies = bodies(view, pair);
        let undisturbed = self.history.undisturbed(view, pair, hit.time);
        self.history.add(view, pair, &hit);
        let leads = [bodies, [bodies[1], bodies[0]]].map(|both| self.leads(view, policy, both));
        for (b, leads) in bodies.into_iter().zip(leads) {
            if self.advance(view, b, hit.time) && !leads {
                self.body_states[b].events += 1;
            }
        }
        let mut changed = bodies.to_vec();
        if hit.normal == Vector::ZERO {
            for b in bodies {
                let events = &mut self.body_states[b].events;
                *events = (*events).max(policy.tuning.max_events + 1);
            }
        } else {
            changed = self.push(view, policy, rules, pair, &hit, undisturbed);
        }
        for (both, leads) in [bodies, [bodies[1], bodies[0]]].into_iter().zip(leads) {
            if !leads {
                self.freeze(view, policy, both, hit.time);
            }
        }
        let curved = (pair, undisturbed);
        self.propagate_impulses(view, policy, rules, hit.time, curved, &mut changed);
        for b in self.close_joints(view, policy, hit.time, &changed, false) {
            if !changed.contains(&b) {
                changed.push(b);
            }
        }
        changed
    }

    /// Lets joints take bodies through the step from its start.
    pub fn lead(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        rules: &Rules,
        bodies: &[usize],
    ) {
        if bodies.is_empty() {
            return;
        }
        self.joints = Some(Joints::new(
            view,
            rules.impulse_joints,
            rules.multibody_joints,
        ));
        for &b in bodies {
            self.body_states[b].moved = true;
            self.body_states[b].struck = true;
        }
        self.close_joints(view, policy, 0.0, bodies, true);
    }

    /// Seconds into the step at which the first piece of a motion ends that joints give
    /// ([`crate::rapier::joints::jointed_bodies`]).
    pub fn next_piece(&self) -> Option<Real> {
        self.pieces.first_end()
    }

    /// Gives bodies whose piece ends at `time` the next one; returns them.
    pub fn begin_piece(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        time: Real,
    ) -> Vec<usize> {
        let Some(bodies) = self.pieces.take_ended(time) else {
            return Vec::new();
        };
        self.close_joints(view, policy, time, &bodies, true)
    }

    /// Moves a free body to where it is at `time`; returns whether it is one.
    pub(crate) fn advance(&mut self, view: &mut StepView, body: usize, time: Real) -> bool {
        let free = view.bodies[body].mobility == Mobility::Free;
        if free {
            view.bodies[body].advance(time);
            view.bodies[body].awake = true;
            self.body_states[body].moved = true;
        }
        free
    }

    /// Passes an impact of a pair at `time` on through the contacts of `changed`, to which it adds the bodies whose
    /// motion it changes. `undisturbed`: as [`ImpactHistory::undisturbed`] says, of the pair that was struck. Its other
    /// contacts are pushed apart by the same rule as the impact, and in the first round only: else they would cancel
    /// its impulse.
    fn propagate_impulses(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        rules: &Rules,
        time: Real,
        (struck, undisturbed): (Pair, Option<Real>),
        changed: &mut Vec<usize>,
    ) {
        let mut last = changed.clone();
        for round in 0..ROUNDS {
            let mut next = Vec::new();
            let pairs = self.history.of(view, &last).into_iter();
            let all = pairs.flat_map(|pair| (0..self.history.places(pair)).map(move |k| (pair, k)));
            for (pair, place) in all.collect::<Vec<_>>() {
                let own = undisturbed.filter(|_| pair == struck);
                if own.is_some() && round > 0 {
                    continue;
                }
                let frozen = |b: usize| self.body_states[b].frozen;
                let closing = self
                    .history
                    .closing(view, policy, frozen, (pair, place), time);
                let Some(hit) = closing else {
                    continue;
                };
                for b in self.push(view, policy, rules, pair, &hit, own) {
                    if self.body_states[b].frozen {
                        continue;
                    }
                    for list in [&mut next, &mut *changed] {
                        if !list.contains(&b) {
                            list.push(b);
                        }
                    }
                }
            }
            if next.is_empty() {
                break;
            }
            last = next;
        }
    }

    /// Lets bodies go on from `time` as their joints let them, and what is tied to them; returns those whose motion
    /// that changes.
    fn close_joints(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        time: Real,
        from: &[usize],
        is_next_piece: bool,
    ) -> Vec<usize> {
        let Some(joints) = self.joints.take() else {
            return Vec::new();
        };
        let body_states = &self.body_states;
        let frozen = |b: usize| body_states[b].frozen;
        let mut moved: Vec<usize> = Vec::new();
        for &body in from {
            if moved.contains(&body) {
                continue;
            }
            let piece = joints.close(view, body, [time, policy.dt], is_next_piece, frozen);
            moved.extend(&piece.moved);
            self.pieces.begin(piece);
        }
        for &b in &moved {
            self.body_states[b].moved = true;
            view.bodies[b].awake = true;
        }
        // Joints take from some bodies what they give to others: the velocities of all bodies of a system are written
        // back, or of none.
        let mut seen = FastSet::default();
        for &body in from {
            if seen.contains(&body) {
                continue;
            }
            let tied = joints.tied_to(view, &[body]);
            seen.extend(tied.iter().copied());
            if tied.iter().any(|b| self.body_states[*b].struck) {
                for b in tied {
                    self.body_states[b].struck |= view.bodies[b].mobility == Mobility::Free;
                }
            }
        }
        self.joints = Some(joints);
        moved
    }

    /// Whether `body`, which a driven body carries along, keeps its motion at this contact, and counts no impact: where
    /// the other body is free, not carried yet, and has had no more than
    /// [`Tuning::max_carried`](crate::rapier::tuning::Tuning::max_carried) impacts. It will be carried too, once it has
    /// had more than `max_events`.
    fn leads(&self, view: &StepView, policy: &CcdPolicy, [body, other]: [usize; 2]) -> bool {
        let [leader, led] = [self.body_states[body], self.body_states[other]];
        let free = view.bodies[other].mobility == Mobility::Free;
        leader.driven && free && !led.driven && led.events <= policy.tuning.max_carried()
    }

    /// Stops a body that had too many impacts, or lets what pushes it carry it along.
    fn freeze(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        [body, other]: [usize; 2],
        time: Real,
    ) {
        let (tuning, state) = (&policy.tuning, self.body_states[body]);
        if state.events <= tuning.max_events || view.bodies[body].mobility != Mobility::Free {
            return;
        }
        let carrier = &view.bodies[other];
        let carries = carrier.mobility == Mobility::Driven || self.body_states[other].driven;
        let carried = carries && state.events <= tuning.max_carried();
        let carrying = carrier.motion_from(time);
        self.body_states[body].frozen = true;
        self.body_states[body].driven = carried;
        let held = &mut view.bodies[body];
        if carried {
            held.follow(&carrying);
        } else {
            held.hold(1.0 - time / policy.dt);
            self.body_states[body].struck = true;
        }
    }
}
