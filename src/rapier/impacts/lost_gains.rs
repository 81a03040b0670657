//! Takes back what forces give a body in the rest of a step in which it gets nowhere, because it presses on one that
//! was stopped.
//!
//! A stopped body is in the way of the other's path as if its mass were infinite, but takes of its velocity only what its
//! own mass can. A heavy body on light ones that are stopped would so gain speed by its weight in each step without
//! getting lower. So the stopped body also holds its velocity, by an impulse that takes back no more than forces give the
//! other along the normal until the step ends.

use crate::math::{Real, Vector};
use crate::rapier::impacts::contact_point::ContactPoint;
use crate::rapier::impacts::impulse::Impact;
use crate::rapier::joints::tied_system::System;
use crate::rapier::view::step_view::StepView;

/// Takes back what forces give two bodies towards each other in the last `share` of the step, one of which `stands`, and
/// what joints tie to them. `system`: what moves of these; `impact`: of the two in it.
pub fn lose_gains(
    view: &mut StepView,
    bodies: [usize; 2],
    stands: [bool; 2],
    point: &ContactPoint,
    (system, impact): (&System, &Impact),
    share: Real,
) {
    let gain = |k: usize| {
        let gains = view.bodies[bodies[k]].gains(share);
        if stands[k] { Vector::ZERO } else { gains }
    };
    let velocity = |k: usize| {
        let velocity = point.velocity(view.bodies[bodies[k]].velocity, k);
        if stands[k] { point.motion(k) } else { velocity }
    };
    let approach = (velocity(0) - velocity(1)).dot(impact.normal);
    let lost = (gain(0) - gain(1)).dot(impact.normal).min(approach);
    if lost <= 0.0 || impact.resistance() <= Real::MIN_POSITIVE {
        return;
    }
    let impulse = impact.normal * (lost / impact.resistance());
    let change = system.change(&point.wrenches(impulse));
    for (&b, change) in system.bodies.iter().zip(change) {
        view.bodies[b].lose_gains(change);
    }
}
