//! Stops: limits of joints at which a system of tied bodies ([`System`]) stands, or which it would pass as it moves on.

use crate::math::{Pose, Real};
use crate::rapier::joints::limits::Limit;
use crate::rapier::joints::rows::{JointRow, Twist};
use crate::rapier::joints::tied_system::System;

/// Times that joints are asked whether they pass a limit, as a stop of one may have another pass.
const STOPPING_ROUNDS: usize = 4;

impl System<'_> {
    /// Makes joints that stand at a limit hold it where a push by some changes of velocity would take them past it;
    /// once for a system.
    pub fn stand_at_limits(&mut self, twists: &[Twist], push: impl Fn(&Self) -> Vec<Twist>) {
        let limits = self.limits(&self.poses);
        let unit = self.unit;
        let stands =
            |(_, limit, row): &(usize, Limit, JointRow)| limit.is_reached(row.opening, unit);
        let mut standing: Vec<_> = limits.filter(stands).collect();
        for _ in 0..STOPPING_ROUNDS {
            if standing.is_empty() {
                break;
            }
            let pushed = push(self);
            let known = self.stops.len();
            standing.retain(|(j, limit, row)| {
                let [rate, push] = [twists, &pushed].map(|t| row.along(t) as Real);
                let holds = limit.holds(row.opening, rate, push, self.unit);
                if holds {
                    self.stops.push((*j, *limit));
                }
                !holds
            });
            if self.stops.len() == known {
                break;
            }
            self.factor();
        }
    }

    /// Limits of joints that may move, with the places of these joints, and their rows at some poses.
    fn limits<'b>(
        &'b self,
        poses: &'b [Pose],
    ) -> impl Iterator<Item = (usize, Limit, JointRow)> + 'b {
        let joints = self.joints.iter().enumerate();
        let limited = joints.filter(|(_, (joint, bodies))| {
            !joint.limits.is_empty() && !bodies.iter().all(|k| self.is_infinite(*k))
        });
        limited.flat_map(|(j, (joint, _))| {
            let ends = self.ends(j, poses);
            let limits = joint.limits.iter();
            limits.map(move |limit| (j, *limit, ends.limited(limit)))
        })
    }

    /// Makes joints stop at the limits that they would pass in some seconds at some velocities, and returns where.
    pub fn stop_at_limits(&mut self, twists: &[Twist], seconds: Real) -> Vec<f64> {
        let mut targets = Vec::new();
        for _ in 0..STOPPING_ROUNDS {
            let mut held = twists.to_vec();
            self.hold(&mut held);
            let start = (self.poses.clone(), self.moved.clone());
            self.displace(&held, seconds);
            let end = std::mem::replace(&mut self.poses, start.0);
            self.moved = start.1;
            let known = self.stops.len();
            let both = self.limits(&self.poses).zip(self.limits(&end));
            let stops = both.filter_map(|((j, limit, now), (_, _, next))| {
                let target = limit.stop(now.opening, next.opening)?;
                let is_known = self.stops.contains(&(j, limit));
                (!is_known).then_some(((j, limit), f64::from(target)))
            });
            let (stops, more): (Vec<_>, Vec<f64>) = stops.unzip();
            self.stops.extend(stops);
            targets.extend(more);
            if self.stops.len() == known {
                break;
            }
            self.factor();
        }
        targets
    }
}
