//! End of a step whose budget is spent ([`crate::MedialOptions::budget`]): bodies of which more would have to be asked
//! wait for the next step.
//!
//! Until the first time that a pair waits for, no pair meets, so there they stop. A body that stands is in the way of
//! others that were to pass behind it: these stop too, and so on. What goes on then was searched to the end, or is a
//! kinematic body and what it carries along, which nothing stops.

use crate::math::{Real, Vector};
use crate::rapier::impacts::event_loop::Loop;
use crate::rapier::impacts::response::Response;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::joints::jointed_bodies::Joints;
use crate::rapier::view::eligible_pairs::{Rules, in_order, is_ccd_candidate};
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;

impl Loop<'_> {
    /// Stops all bodies of which more would have to be asked, at the time until which nothing meets, and what would run
    /// into them then. What driven bodies push goes on: nothing stops those.
    pub(crate) fn wait(&mut self, work: &mut Work) {
        self.is_spent = true;
        self.policy.budget = u64::MAX;
        let time = self.queue.first_time();
        let Some(time) = time
            .into_iter()
            .chain(self.response.next_piece())
            .reduce(Real::min)
        else {
            return;
        };
        self.find_boxes();
        let (policy, rules) = (self.policy, self.rules);
        let is_driven = |view: &StepView, part: usize| {
            view.bodies[view.colliders[part].body].mobility == Mobility::Driven
        };
        let mut next: Vec<usize> = self.queue.pairs().flatten().collect();
        let pairs = std::mem::take(&mut self.queue);
        let driven = |pair: &[usize; 2]| pair.iter().any(|k| is_driven(self.view, *k));
        let mut driven: Vec<[usize; 2]> = pairs.pairs().filter(driven).collect();
        while let Some(part) = next.pop() {
            let body = self.view.colliders[part].body;
            for b in self.response.wait(self.view, &policy, &rules, body, time) {
                for k in self.parts_of[b].clone() {
                    self.outlines.forget(k);
                    let stands = self.view.swept_aabb(k, time, time);
                    self.boxes.set(k, self.grown(k, stands));
                    for j in self.boxes.meeting(k) {
                        if !is_ccd_candidate(self.view, [k, j]) {
                            continue;
                        }
                        match is_driven(self.view, j) {
                            true => driven.push(in_order(self.view, [k, j])),
                            false => next.push(j),
                        }
                    }
                }
            }
        }
        for pair in driven {
            self.ask(pair, time, None, work);
        }
    }
}

impl Response {
    /// Stops a free body that moves at `time`, and all that joints tie to it, as if it had had too many impacts;
    /// returns those that it stops.
    pub fn wait(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        rules: &Rules,
        body: usize,
        time: Real,
    ) -> Vec<usize> {
        let motion = &view.bodies[body].motion;
        let stands = motion.linvel == Vector::ZERO && motion.angvel == Vector::ZERO;
        if view.bodies[body].mobility != Mobility::Free || stands {
            return Vec::new();
        }
        let joints = self.joints(view, rules);
        let mut stopped = joints.tied_to(view, &[body]);
        self.joints = Some(joints);
        stopped
            .retain(|b| view.bodies[*b].mobility == Mobility::Free && !self.body_states[*b].waits);
        self.pieces.end(&stopped);
        for &b in &stopped {
            self.advance(view, b, time);
            let course = &mut self.body_states[b];
            (course.frozen, course.waits, course.struck) = (true, true, true);
            course.driven = false;
            course.events = course.events.max(policy.tuning.max_events + 1);
            view.bodies[b].hold(1.0 - time / policy.dt);
        }
        stopped
    }

    /// Joints, which are looked for once.
    pub(crate) fn joints(&mut self, view: &StepView, rules: &Rules) -> Joints {
        let joints = self.joints.take();
        joints.unwrap_or_else(|| Joints::new(view, rules.impulse_joints, rules.multibody_joints))
    }
}
