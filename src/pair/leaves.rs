//! The part of the search for a first contact ([`super::search`]) that deals with two primitives: it lists their
//! elementary tests, and takes one of them further.

use super::deepening::Threshold;
use super::queue::{Candidate, Entry, Open};
use super::search::Search;
use super::volumes::Volumes;
use crate::elementary::InitialContact;
use crate::elementary::bracket::Limits;
use crate::elementary::distance::{Ball, crossing, signed_distance, thinnest};
use crate::elementary::resumed::bracket_until;
use crate::elementary::test_list::{Share, for_each_test};
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::medial::tree::Below;

impl<A: Volumes, B: Volumes> Search<'_, A, B> {
    /// Lists the elementary tests of two primitives that are free until `time`; returns whether an
    /// earlier contact is still possible.
    pub(super) fn list_tests(&mut self, [i, j]: [u32; 2], time: f64) -> bool {
        let (Below::Primitive(p), Below::Primitive(q)) =
            (self.sides.0.node(i).below, self.sides.1.node(j).below)
        else {
            return true;
        };
        let pair = [p, q];
        let [(all_a, share_a), (all_b, share_b)] = self.spheres(pair);
        let (sa, sb) = (&all_a[..share_a.spheres], &all_b[..share_b.spheres]);
        let balls_and_shares = ([sa, sb], [share_a, share_b]);
        let Some(threshold) = self.threshold(pair, balls_and_shares, time) else {
            return false;
        };
        // A target of the pair's own leaves no test to a neighbour, whose target is another; where the two
        // targets may be far from each other, no neighbour leaves one to it either.
        let own = matches!(self.initial_contact, InitialContact::Approach { .. });
        let shares = if threshold.target == self.target && !own {
            [share_a, share_b]
        } else {
            [share_a, share_b].map(|s| Share::whole(s.spheres))
        };
        // What their contact needs, not the search's: what touches already has a target of its own, and mostly
        // directions put it off for good.
        let mut balls = self.swept([i, j], pair);
        if threshold.scale < 1.0 {
            let lost = |s: &Ball<f64>| (1.0 - threshold.scale) * s.1;
            let [a, b] = [all_a, all_b].map(|s| s.each_ref().map(lost));
            balls = [balls[0].less(a), balls[1].less(b)];
        }
        for_each_test(shares[0], shares[1], |test| {
            self.proofs += 1;
            let some = [
                balls[0].only(test.corners.map(|c| c.0)),
                balls[1].only(test.corners.map(|c| c.1)),
            ];
            if let Some(free) = self.above_until([&some[0], &some[1]], &threshold, time) {
                let open = Open {
                    primitives: pair,
                    test,
                    threshold,
                    spent: 0,
                };
                let place = Candidate::Test(self.open.len() as u32);
                self.queue(Entry::at(free, place));
                self.open.push(open);
            }
            true
        });
        true
    }

    /// The distance up to which two primitives, given as spheres in their bodies' frames and what they test, have to be
    /// followed, from `time` on; `None` if they overlap at the start, where the search is to stop.
    fn threshold(
        &mut self,
        pair: [u32; 2],
        ([sa, sb], [share_a, share_b]): ([&[Ball<f64>]; 2], [Share; 2]),
        time: f64,
    ) -> Option<Threshold> {
        let at_start = |side: usize, s: &[(Vec3<f64>, f64)]| {
            let turned = self.motions[side].sin_cos(0.0);
            let place = |c| self.motions[side].point(c).at(0.0, turned).position;
            s.iter().map(|s| (place(s.0), s.1)).collect::<Vec<_>>()
        };
        let tolerance = self.earliest.limits.tolerance;
        let mut target = self.target;
        if self.initial_contact == InitialContact::Stop {
            target = target.max(-thinnest(sa, sb));
        }
        let mut threshold = Threshold::new(target, tolerance);
        match self.initial_contact {
            InitialContact::Deepen { by } => {
                let (pa, pb) = (at_start(0, sa), at_start(1, sb));
                let distance = signed_distance(&pa, &pb);
                let touching = target + tolerance;
                if distance <= touching {
                    let depth = (distance - touching) / self.thickness(pair);
                    self.deepest = self.deepest.min(depth);
                    let axis = |s: &[Ball<f64>]| s.iter().map(|s| (s.0, 0.0)).collect::<Vec<_>>();
                    let axes = || signed_distance(&axis(&pa), &axis(&pb));
                    let thinnest = thinnest(sa, sb);
                    threshold = Threshold::deepened(distance, thinnest, by.into(), tolerance, axes);
                }
            }
            InitialContact::Approach { by } => {
                let distance = self.distance_at_start(pair);
                if distance <= target + tolerance {
                    threshold = Threshold::new(distance - f64::from(by) - tolerance, tolerance);
                }
            }
            // Proven free until later, they cannot cross at the start.
            InitialContact::Stop if time == 0.0 => {
                let (pa, pb) = self.at_start(pair);
                let (pa, pb) = (&pa[..share_a.spheres], &pb[..share_b.spheres]);
                let crossings = [
                    crossing(pa, share_a.edges, pb),
                    crossing(pb, share_b.edges, pa),
                ];
                if crossings.iter().flatten().any(|c| -c.radius <= target) {
                    self.earliest.overlap_at_start();
                    self.earliest.found = None;
                    return None;
                }
            }
            InitialContact::Stop => {}
        }
        Some(threshold)
    }

    /// Thickness of the thinner of two primitives, or the least number where it has none.
    fn thickness(&self, [p, q]: [u32; 2]) -> f64 {
        let (a, b) = (self.sides.0.body, self.sides.1.body);
        let thinner = a.thickness(p).min(b.thickness(q));
        let thinner = self.cores.map_or(thinner, |c| thinner.min(c.at_most));
        f64::from(thinner.max(Real::MIN_POSITIVE))
    }

    /// Takes one test further, until it is settled or another candidate may come first; returns
    /// whether an earlier contact is still possible.
    pub(super) fn advance(&mut self, place: u32, time: f64) -> bool {
        let mut open = self.open[place as usize];
        let limits = self.earliest.limits;
        let limits = Limits {
            start: time,
            horizon: self.earliest.upper.min(limits.horizon),
            tolerance: open.threshold.tolerance,
            max_iterations: limits.max_iterations - open.spent,
            ..limits
        };
        let until = (self.heap.peek()).map_or(limits.horizon, |next| next.time.max(time));
        let path = self.path(&open.test, open.primitives, &open.threshold);
        let bracket = bracket_until(&path, open.test.domain, &limits, until);
        self.earliest.tests += u32::from(open.spent == 0);
        open.spent += bracket.iterations;
        let settled = bracket.contact || bracket.separated || !bracket.slack.is_finite();
        // Without a bound that lies later it has used up its iterations, or none of them gains any more.
        if settled || bracket.lower <= until {
            let Open {
                test, primitives, ..
            } = open;
            return self.earliest.take(test, bracket, time, primitives);
        }
        self.earliest.iterations += bracket.iterations;
        self.earliest.tolerance = self.earliest.tolerance.max(bracket.tolerance);
        self.open[place as usize] = open;
        self.queue(Entry::at(bracket.lower, Candidate::Test(place)));
        true
    }
}
