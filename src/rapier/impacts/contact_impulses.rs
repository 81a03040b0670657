//! The two impulses of one contact within the step, by the law of [`crate::rapier::impacts::impulse`]. One changes
//! the velocities that the solver left, so that the next step begins right; the other changes the motions of this
//! step, so that the rest of it is right. They differ where a body was stopped after too many impacts: it takes
//! impulses for the next step, and keeps its motion. What joints tie to the two bodies takes part.

use crate::math::{Real, Vector};
use crate::pair::patch::with_room;
use crate::rapier::host::reported_impulse::ReportedImpulse;
use crate::rapier::impacts::center_of_pressure::center_of_pressure;
use crate::rapier::impacts::contact_point::ContactPoint;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::impact_history::touch;
use crate::rapier::impacts::impulse::Material;
use crate::rapier::impacts::lost_gains::lose_gains;
use crate::rapier::impacts::response::{Response, bodies};
use crate::rapier::impacts::toi_query::CcdPolicy;
use crate::rapier::impacts::way_out::way_out;
use crate::rapier::joints::jointed_bodies::{Joints, settle};
use crate::rapier::joints::rows::Twist;
use crate::rapier::joints::tied_system::System;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::inertia::Inertia;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;

/// Least ratio of the speed that an impulse gives two bodies in their joints to the speed that it would give the
/// heavier of them without joints. Below it joints and locked axes hold the contact, as between neighbours in a chain
/// or where a body is driven along a locked axis, and no impulse is given: it would have no bound.
const HELD_RATIO: Real = 0.02;

impl Response {
    /// Applies the two impulses of a contact, on velocities and on the motions of this step, to both bodies and,
    /// through joints, to the bodies tied to them. Returns the indices of all of these. `undisturbed`: as
    /// [`ImpactHistory::undisturbed`](crate::rapier::impacts::impact_history::ImpactHistory::undisturbed) says.
    pub(super) fn push(
        &mut self,
        view: &mut StepView,
        policy: &CcdPolicy,
        rules: &Rules,
        pair: [usize; 2],
        hit: &Hit,
        undisturbed: Option<Real>,
    ) -> Vec<usize> {
        let both = bodies(view, pair);
        let joints = self.joints(view, rules);
        for b in joints.tied_to(view, &both) {
            self.advance(view, b, hit.time);
        }
        let (system, moving, point) = self.at_contact(view, policy, &joints, pair, hit);
        let [c1, c2] = pair.map(|k| &rules.colliders[view.colliders[k].handle]);
        let [v1, v2] = [0, 1].map(|k| point.velocity(view.bodies[both[k]].velocity, k));
        let (approach, material) = policy.bounce(view, pair, hit, v2 - v1, Material::of(c1, c2));
        let is_guided = both.iter().any(|b| {
            is_movable(view, both, *b) && !view.bodies[*b].locked.is_empty()
                || joints.hangs_on_driven(view, *b)
        });
        let own = point.impact(&system, material, is_guided);
        let (mut moved, mut impact) = (system, own);
        let free = both.map(|b| unlocked(view, both, b));
        if own.resistance() >= HELD_RATIO * resistance_alone(free, &point, hit.normal) {
            if let Some(j) = own.impulse(approach, 0.0) {
                let poses = pair.map(|k| view.motion(k, hit.time).start);
                let contact = (point.position, hit.normal, -hit.depth);
                let blow = ReportedImpulse::new(poses, contact, j.dot(hit.normal));
                blow.add_to(self.impulses.entry(pair).or_default());
                self.change_velocities(view, &moved, &point, j);
            }
            let mut is_stopped = false;
            if let Some(moving) = moving {
                impact = point.impact(&moving, material, is_guided);
                moved = moving;
                is_stopped = true;
            }
            let motion = point.relative_motion();
            let approach = -motion.dot(hit.normal);
            let fastest = point.greatest_speed(both.map(|b| view.bodies[b].velocity));
            let out = way_out(view, policy, pair, hit, approach, fastest, undisturbed);
            let free = [0, 1].map(|k| match self.body_states[both[k]].frozen {
                true => Inertia::INFINITE,
                false => free[k],
            });
            let is_held =
                impact.resistance() < HELD_RATIO * resistance_alone(free, &point, hit.normal);
            if let Some(j) = impact.impulse(motion, out).filter(|_| !is_held) {
                change_motions(view, &moved, &point, j);
                if is_stopped {
                    let stands = both.map(|b| self.stands(view, b));
                    let share = 1.0 - hit.time / policy.dt;
                    let deflected = j.dot(hit.normal) * impact.resistance();
                    lose_gains(
                        view,
                        both,
                        stands,
                        &point,
                        (&moved, &impact),
                        (share, deflected),
                    );
                }
            }
        }
        let moved = moved.bodies;
        self.joints = Some(joints);
        moved
    }

    /// Whether nothing changes the motion of a body any more.
    fn stands(&self, view: &StepView, body: usize) -> bool {
        self.body_states[body].frozen || view.bodies[body].mobility != Mobility::Free
    }

    /// System that resists the impulse on the velocities and, where that differs, the one on the motions; and the point
    /// of the contact. Bodies that joints hold have the velocities and motions there that these let them have.
    fn at_contact<'j>(
        &self,
        view: &mut StepView,
        policy: &CcdPolicy,
        joints: &'j Joints,
        pair: [usize; 2],
        hit: &Hit,
    ) -> (System<'j>, Option<System<'j>>, ContactPoint) {
        let both = bodies(view, pair);
        let resists = |view: &StepView, b: usize| inertia(view, both, b);
        let mut system = joints.system(view, &both, hit.time, |b| resists(view, b));
        let free = system.bodies.iter().all(|b| !self.body_states[*b].frozen);
        let mut moving = (!free).then(|| {
            joints.system(view, &both, hit.time, |b| {
                match self.body_states[b].frozen {
                    true => Inertia::INFINITE,
                    false => resists(view, b),
                }
            })
        });
        settle(view, hit.time, &system, moving.as_ref(), |view| {
            let end = joints.system(view, &both, policy.dt, |b| resists(view, b));
            let twists = end.bodies.iter().map(|b| view.bodies[*b].twist(policy.dt));
            let mut twists: Vec<Twist> = twists.collect();
            end.hold(&mut twists);
            twists
        });
        let corners = hit
            .met
            .as_ref()
            .and_then(|met| touch(view, pair, met, hit.time)?.corners);
        let pressed = corners.and_then(|corners| {
            let corners = with_room(&corners, policy.dt);
            center_of_pressure(view, both, hit, &corners, &system)
        });
        let point = ContactPoint::new(view, both, hit, pressed.unwrap_or(hit.point));
        // A joint at its limit resists as the stop does.
        for system in [Some(&mut system), moving.as_mut()].into_iter().flatten() {
            let of = |b: &usize| view.bodies[*b].velocity;
            let twists: Vec<Twist> = system.bodies.iter().map(of).collect();
            system.stand_at_limits(&twists, |system| system.change(&point.wrenches(hit.normal)));
        }
        (system, moving, point)
    }

    /// Gives the velocities of a system an impulse at a contact.
    fn change_velocities(
        &mut self,
        view: &mut StepView,
        system: &System,
        point: &ContactPoint,
        impulse: Vector,
    ) {
        let change = system.change(&point.wrenches(impulse));
        for (&b, [dv, dw]) in system.bodies.iter().zip(change) {
            let body = &mut view.bodies[b];
            body.velocity[0] += dv;
            body.velocity[1] += dw;
            self.body_states[b].struck |= body.mobility == Mobility::Free;
        }
    }
}

/// Gives the motions of a system an impulse at a contact.
fn change_motions(view: &mut StepView, system: &System, point: &ContactPoint, impulse: Vector) {
    let change = system.change(&point.wrenches(impulse));
    for (&b, [dv, dw]) in system.bodies.iter().zip(change) {
        let motion = &mut view.bodies[b].motion;
        motion.linvel += dv;
        motion.angvel += dw;
    }
}

/// Whether an impulse moves a body, where the two bodies of a contact are `both`.
fn is_movable(view: &StepView, both: [usize; 2], body: usize) -> bool {
    let dominance = both.map(|b| view.bodies[b].dominance);
    let [first, second] = both.map(|b| b == body);
    let is_strong = first && dominance[0] > dominance[1] || second && dominance[1] > dominance[0];
    view.bodies[body].mobility == Mobility::Free && !is_strong
}

/// Inertia that resists an impulse on a body, where the two bodies of a contact are `both`.
fn inertia(view: &StepView, both: [usize; 2], body: usize) -> Inertia {
    match is_movable(view, both, body) {
        true => Inertia::of(&view.bodies[body]),
        false => Inertia::INFINITE,
    }
}

/// The same without locked axes.
fn unlocked(view: &StepView, both: [usize; 2], body: usize) -> Inertia {
    match is_movable(view, both, body) {
        true => Inertia::unlocked(&view.bodies[body]),
        false => Inertia::INFINITE,
    }
}

/// Speed along the normal that a unit impulse along it would give the heavier of two bodies of these inertias without
/// joints: of those that move at all. A heavy body is not held where a light one is.
fn resistance_alone(inertias: [Inertia; 2], point: &ContactPoint, normal: Vector) -> Real {
    let alone = [0, 1].map(|k| {
        let change = inertias[k].apply(point.wrench(k, normal));
        point.velocity(change, k).dot(normal)
    });
    let moved = alone.into_iter().filter(|speed| *speed > 0.0);
    moved.reduce(Real::min).unwrap_or(0.0)
}
