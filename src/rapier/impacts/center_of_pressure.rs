//! Where the impulse of an impact acts when flat faces lie on each other: at the centre of pressure of the impulses at
//! their corners that together leave none of these approaching. They take out as much energy as impulses there can
//! (maximum dissipation), so that what falls flat, but aside of the middle of the faces, is stopped below its centre of
//! mass and does not turn.

use crate::math::{Real, Vector};
use crate::pair::patch::{EXTREMES, FaceCorner};
use crate::rapier::impacts::contact_point::ContactPoint;
use crate::rapier::impacts::hit::Hit;
use crate::rapier::joints::rows::Twist;
use crate::rapier::joints::skyline::Skyline;
use crate::rapier::joints::tied_system::System;
use crate::rapier::view::step_view::StepView;

/// Relative addition to what impulses at a corner do there. The matrix is singular where locked axes keep a body from
/// turning: above the rounding of its entries in single precision.
const REGULAR: f64 = 1.0e-6;

/// Share of the speed of approach that impulses at the corners may leave.
const LEFT: f64 = 1.0e-3;

/// Most corners that join those at which impulses act, one after the other, some of them more than once.
const MOST_CHANGES: usize = 3 * EXTREMES;

/// The point at which an impulse acts on two bodies of which flat faces met, world frame: `corners`, with the speed of
/// approach that is left to each. `system` resists it. `None` where no impulses stop all corners.
pub fn center_of_pressure(
    view: &StepView,
    both: [usize; 2],
    hit: &Hit,
    corners: &[(FaceCorner, Real)],
    system: &System,
) -> Option<Vector> {
    let at = |(corner, _): &(FaceCorner, Real)| ContactPoint::new(view, both, hit, corner.point);
    let points: Vec<ContactPoint> = corners.iter().map(at).collect();
    let opening = |p: &ContactPoint, twists: [Twist; 2]| {
        (p.velocity(twists[1], 1) - p.velocity(twists[0], 0)).dot(hit.normal)
    };
    let velocities = both.map(|b| view.bodies[b].velocity);
    let of_velocities = |p: &ContactPoint| -opening(p, velocities);
    let of_motions = |p: &ContactPoint| -p.relative_motion().dot(hit.normal);
    let approaching = |speed: &dyn Fn(&ContactPoint) -> Real| -> Option<Vec<f64>> {
        let speeds = points.iter().zip(corners);
        let speeds = speeds.map(|(p, (_, room))| f64::from(speed(p) - room));
        let speeds: Vec<f64> = speeds.collect();
        speeds.iter().any(|speed| *speed > 0.0).then_some(speeds)
    };
    let approach = approaching(&of_velocities).or_else(|| approaching(&of_motions))?;
    let response = |p: &ContactPoint| -> Vec<f64> {
        let change = system.change(&p.wrenches(hit.normal));
        let twists = [change[0], change[1]];
        points
            .iter()
            .map(|q| f64::from(opening(q, twists)))
            .collect()
    };
    let response: Vec<Vec<f64>> = points.iter().map(response).collect();
    let impulses = strongest(&response, &approach)?;
    let sum: f64 = impulses.iter().map(|(_, impulse)| impulse).sum();
    let share = |(k, impulse): &(usize, f64)| corners[*k].0.point * (impulse / sum) as Real;
    Some(impulses.iter().map(share).fold(Vector::ZERO, |a, b| a + b))
}

/// The impulses at corners that stop what approaches there, none of which pulls, each with the number of its corner:
/// those that take out the most energy, found by the active set method (Lawson and Hanson, Solving Least Squares
/// Problems, 1974, ch. 23). `None` where some corner cannot be stopped, as of a body that moves along a locked axis.
fn strongest(response: &[Vec<f64>], approach: &[f64]) -> Option<Vec<(usize, f64)>> {
    let fastest = approach.iter().copied().fold(0.0, f64::max);
    let mut impulses: Vec<(usize, f64)> = Vec::new();
    for _ in 0..MOST_CHANGES {
        let left = |k: &usize| {
            let stopped = impulses.iter().map(|(i, j)| j * response[*i][*k]);
            approach[*k] - stopped.sum::<f64>()
        };
        let all = (0..approach.len()).map(|k| (k, left(&k)));
        let (worst, speed) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
        if speed <= LEFT * fastest {
            return Some(impulses);
        }
        if impulses.iter().any(|(i, _)| *i == worst) {
            return None;
        }
        impulses.push((worst, 0.0));
        loop {
            let after = stopping(response, approach, &impulses)?;
            let both = impulses.iter().zip(&after).enumerate();
            let pulling = both.filter(|(_, (_, after))| **after <= 0.0);
            let shares = pulling.map(|(at, ((_, now), after))| (at, now / (now - after)));
            let first = shares.min_by(|a, b| a.1.total_cmp(&b.1));
            let share = first.map_or(1.0, |(_, share)| share);
            for ((_, now), after) in impulses.iter_mut().zip(&after) {
                *now += share * (after - *now);
            }
            match first {
                Some((at, _)) => impulses.remove(at),
                None => break,
            };
        }
    }
    None
}

/// The impulses at some corners that leave these at rest.
fn stopping(response: &[Vec<f64>], approach: &[f64], at: &[(usize, f64)]) -> Option<Vec<f64>> {
    let mut matrix = Skyline::default();
    for (row, (i, _)) in at.iter().enumerate() {
        for (entry, (j, _)) in matrix.push_row(0).iter_mut().zip(&at[..=row]) {
            let regular = if i == j { 1.0 + REGULAR } else { 1.0 };
            *entry = 0.5 * (response[*i][*j] + response[*j][*i]) * regular;
        }
    }
    let mut impulses: Vec<f64> = at.iter().map(|(k, _)| approach[*k]).collect();
    matrix.factor()?.solve(&mut impulses);
    impulses.iter().all(|j| j.is_finite()).then_some(impulses)
}
