//! What happens when the step's budget is spent ([`crate::MedialOptions::budget`]): bodies of which more would have to be
//! asked wait for the next step.
//!
//! Until the first time that a pair waits for, no pair meets, so there they stop. A body that stands is in the way of
//! others that were to pass behind it: these stop too, and so on. What goes on then was searched to the end, or is a
//! kinematic body and what it carries along, which nothing stops.

use super::events::Loop;
use super::first_contact::{Asker, Work};
use super::joints::Joints;
use super::motion::Kind;
use super::pairs::{Rules, concerned, in_order};
use super::response::Response;
use super::snapshot::Snapshot;
use crate::math::{Real, Vector};

impl Loop<'_> {
    /// Stops all bodies of which more would have to be asked, at the time until which nothing meets, and what would run
    /// into them then. What driven bodies push goes on: nothing stops those.
    pub(super) fn wait(&mut self, work: &mut Work) {
        self.is_spent = true;
        self.asker.budget = u64::MAX;
        let time = self.waiting.first_time();
        let Some(time) = time
            .into_iter()
            .chain(self.response.next_piece())
            .reduce(Real::min)
        else {
            return;
        };
        self.find_boxes();
        let (asker, rules) = (self.asker, self.rules);
        let is_driven = |snapshot: &Snapshot, part: usize| {
            snapshot.bodies[snapshot.parts[part].body].kind == Kind::Driven
        };
        let mut next: Vec<usize> = self.waiting.pairs().flatten().collect();
        let pairs = std::mem::take(&mut self.waiting);
        let driven = |pair: &[usize; 2]| pair.iter().any(|k| is_driven(self.snapshot, *k));
        let mut driven: Vec<[usize; 2]> = pairs.pairs().filter(driven).collect();
        while let Some(part) = next.pop() {
            let body = self.snapshot.parts[part].body;
            for b in self
                .response
                .wait(self.snapshot, &asker, &rules, body, time)
            {
                for k in self.parts_of[b].clone() {
                    self.outlines.forget(k);
                    let stands = self.snapshot.swept_aabb(k, time, time);
                    self.boxes.set(k, self.grown(k, stands));
                    for j in self.boxes.meeting(k) {
                        if !concerned(self.snapshot, [k, j]) {
                            continue;
                        }
                        match is_driven(self.snapshot, j) {
                            true => driven.push(in_order(self.snapshot, [k, j])),
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
    /// Stops a free body that moves at `time`, and all that joints tie to it, as if it had had too many impacts; returns
    /// those that it stops.
    pub fn wait(
        &mut self,
        snapshot: &mut Snapshot,
        asker: &Asker,
        rules: &Rules,
        body: usize,
        time: Real,
    ) -> Vec<usize> {
        let motion = &snapshot.bodies[body].motion;
        let stands = motion.linvel == Vector::ZERO && motion.angvel == Vector::ZERO;
        if snapshot.bodies[body].kind != Kind::Free || stands {
            return Vec::new();
        }
        let joints = self.joints(snapshot, rules);
        let mut stopped = joints.tied_to(snapshot, &[body]);
        self.joints = Some(joints);
        stopped.retain(|b| snapshot.bodies[*b].kind == Kind::Free && !self.courses[*b].waits);
        self.pieces.end(&stopped);
        for &b in &stopped {
            self.advance(snapshot, b, time);
            let course = &mut self.courses[b];
            let left = if course.frozen {
                0.0
            } else {
                1.0 - time / asker.dt
            };
            (course.frozen, course.waits, course.struck) = (true, true, true);
            course.driven = false;
            course.events = course.events.max(asker.tuning.max_events + 1);
            snapshot.bodies[b].hold(left);
        }
        stopped
    }

    /// Joints, which are looked for once.
    pub(super) fn joints(&mut self, snapshot: &Snapshot, rules: &Rules) -> Joints {
        let joints = self.joints.take();
        joints
            .unwrap_or_else(|| Joints::new(snapshot, rules.impulse_joints, rules.multibody_joints))
    }
}
