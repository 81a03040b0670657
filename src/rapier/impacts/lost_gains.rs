//! Removes the speed that gravity and the user's forces give a body along a path that a stopped body blocks or turns
//! aside.
//!
//! A stopped body is in the way of the other's path as if its mass were infinite, but takes of its velocity only what
//! its own mass can. A heavy body on light ones that are stopped would so gain speed by its weight in each step without
//! getting lower, or rise against it for nothing. So the stopped body also holds its velocity.
//!
//! Let the path be turned aside by the speed `u` along the normal, for the rest `τ` of the step, and let forces pull
//! with the acceleration `g` against the normal: on that way they do the work `g u τ` per mass less. An impulse that
//! takes `δ` of the approach `v` of the velocities takes the energy `δ v` per mass, to first order, so `δ = g τ u / v`,
//! and no more than `v`. Where the path approached as fast as the velocities, `u = v`, this is the speed that forces
//! add in that time.

use crate::math::{Real, Vector};
use crate::rapier::impacts::contact_point::ContactPoint;
use crate::rapier::impacts::impulse::Impact;
use crate::rapier::joints::tied_system::System;
use crate::rapier::view::step_view::StepView;

/// Takes back what forces give two bodies towards each other in the last `share` of the step, one of which `stands`,
/// and what joints tie to them, where the paths were `deflected` by so much speed along the normal. `system`: what
/// moves of these; `impact`: of the two in it.
pub fn lose_gains(
    view: &mut StepView,
    bodies: [usize; 2],
    stands: [bool; 2],
    point: &ContactPoint,
    (system, impact): (&System, &Impact),
    (share, deflected): (Real, Real),
) {
    let gain = |k: usize| {
        let gains = view.bodies[bodies[k]].pull() * share;
        if stands[k] { Vector::ZERO } else { gains }
    };
    let velocity = |k: usize| {
        let velocity = point.velocity(view.bodies[bodies[k]].velocity, k);
        if stands[k] { point.motion(k) } else { velocity }
    };
    let approach = (velocity(0) - velocity(1)).dot(impact.normal);
    let gained = (gain(0) - gain(1)).dot(impact.normal);
    let lost = (gained * deflected / approach).min(approach);
    if approach <= 0.0 || lost <= 0.0 || impact.resistance() <= Real::MIN_POSITIVE {
        return;
    }
    let impulse = impact.normal * (lost / impact.resistance());
    let change = system.change(&point.wrenches(impulse));
    for (&b, change) in system.bodies.iter().zip(change) {
        view.bodies[b].lose_gains(change);
    }
}
