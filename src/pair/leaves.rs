//! The part of the search for a first contact ([`super::search`]) that deals with two primitives: it lists their
//! elementary tests, and takes one of them further.

use super::apart::Balls;
use super::deepening::Threshold;
use super::queue::{Candidate, Entry, Open, Tested};
use super::search::Search;
use super::tips::{Part, Parts};
use super::volumes::Volumes;
use crate::elementary::InitialContact;
use crate::elementary::bracket::{Bracket, Limits};
use crate::elementary::distance::{Ball, crossing, signed_distance, thinnest};
use crate::elementary::resumed::bracket_until;
use crate::elementary::test_list::{ElementaryTest, Share, for_each_test};
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
        let at_start = |side: usize, s: &[(Vec3<f64>, f64)]| {
            let turned = self.motions[side].sin_cos(0.0);
            let place = |c| self.motions[side].point(c).at(0.0, turned).position;
            s.iter().map(|s| (place(s.0), s.1)).collect::<Vec<_>>()
        };
        let tolerance = self.earliest.limits.tolerance;
        let whole = [share_a, share_b].map(|s| Part::whole(s.spheres));
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
                    return self.list_parts([i, j], pair, by.into(), time);
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
                    return false;
                }
            }
            InitialContact::Stop => {}
        }
        // A target of the pair's own leaves no test to a neighbour, whose target is another; where the two
        // targets may be far from each other, no neighbour leaves one to it either.
        let own = matches!(self.initial_contact, InitialContact::Approach { .. });
        let shares = if threshold.target == self.target && !own {
            [share_a, share_b]
        } else {
            [share_a, share_b].map(|s| Share::whole(s.spheres))
        };
        let balls = self.swept([i, j], pair);
        let tested = Tested {
            primitives: pair,
            parts: whole,
            threshold,
        };
        self.list(tested, shares, &balls, time);
        true
    }

    /// Lists the tests of two primitives that touch at the start and may sink in `by` deeper, without their tips: each
    /// part has a threshold of its own.
    fn list_parts(&mut self, nodes: [u32; 2], pair: [u32; 2], by: f64, time: f64) -> bool {
        let tolerance = self.earliest.limits.tolerance;
        let [(all_a, share_a), (all_b, share_b)] = self.spheres(pair);
        let (sa, sb) = (&all_a[..share_a.spheres], &all_b[..share_b.spheres]);
        let kept = self.cores.map_or([0.0; 2], |cores| {
            let (a, b) = (self.sides.0.body, self.sides.1.body);
            cores.kept([a.thickness(pair[0]), b.thickness(pair[1])])
        });
        let parts_a = Parts::without_tips(sa, kept[0]);
        let parts_b = Parts::without_tips(sb, kept[1]);
        let (start_a, start_b) = self.at_start(pair);
        let swept = self.swept(nodes, pair);
        for (a, b) in parts_a
            .iter()
            .flat_map(|a| parts_b.iter().map(move |b| (a, b)))
        {
            let (pa, pb) = (a.of(&start_a), b.of(&start_b));
            let (pa, pb) = (&pa[..a.spheres], &pb[..b.spheres]);
            // What is behind a tip may be farther off, and counts as touching as the tip does.
            let distance = signed_distance(pa, pb).min(self.target + tolerance);
            let axis = |s: &[Ball<f64>]| s.iter().map(|s| (s.0, 0.0)).collect::<Vec<_>>();
            let axes = || signed_distance(&axis(pa), &axis(pb));
            let thinnest = thinnest(pa, pb);
            let threshold = Threshold::deepened(distance, thinnest, by, tolerance, axes);
            // What their contact needs, not the search's: what touches already has a target of its own, and mostly
            // directions put it off for good.
            let mut balls = [a.of_swept(&swept[0]), b.of_swept(&swept[1])];
            if threshold.scale < 1.0 {
                let lost = |s: &Ball<f64>| (1.0 - threshold.scale) * s.1;
                let [lost_a, lost_b] = [a.of(&all_a), b.of(&all_b)].map(|s| s.each_ref().map(lost));
                balls = [balls[0].less(lost_a), balls[1].less(lost_b)];
            }
            // One proof for all tests, where there are many.
            let many = a.spheres.max(b.spheres) == 3;
            if many
                && self
                    .above_until(balls.each_ref(), &threshold, time)
                    .is_none()
            {
                continue;
            }
            let tested = Tested {
                primitives: pair,
                parts: [*a, *b],
                threshold,
            };
            let shares = tested.parts.map(|part| Share::whole(part.spheres));
            self.list(tested, shares, &balls, time);
        }
        true
    }

    /// Lists the elementary tests of a part of each of two primitives, as far as directions do not prove them free.
    fn list(&mut self, tested: Tested, shares: [Share; 2], balls: &[Balls; 2], time: f64) {
        let of = self.tested.len() as u32;
        let threshold = tested.threshold;
        self.tested.push(tested);
        for_each_test(shares[0], shares[1], |test| {
            self.proofs += 1;
            let some = [
                balls[0].only(test.corners.map(|c| c.0)),
                balls[1].only(test.corners.map(|c| c.1)),
            ];
            if let Some(free) = self.above_until([&some[0], &some[1]], &threshold, time) {
                let place = Candidate::Test(self.open.len() as u32);
                self.queue(Entry::at(free, place));
                self.open.push(Open { of, test, spent: 0 });
            }
            true
        });
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
        let tested = &self.tested[open.of as usize];
        let limits = self.earliest.limits;
        let limits = Limits {
            start: time,
            horizon: self.earliest.upper.min(limits.horizon),
            tolerance: tested.threshold.tolerance,
            max_iterations: limits.max_iterations - open.spent,
            ..limits
        };
        let until = (self.heap.peek()).map_or(limits.horizon, |next| next.time.max(time));
        let path = self.path(&open.test, tested);
        let bracket = bracket_until(&path, open.test.domain, &limits, until);
        self.earliest.tests += u32::from(open.spent == 0);
        open.spent += bracket.iterations;
        let settled = bracket.contact || bracket.separated || !bracket.slack.is_finite();
        // Without a bound that lies later it has used up its iterations, or none of them gains any more.
        if settled || bracket.lower <= until {
            let (test, primitives) = (open.test, tested.primitives);
            let goes_on = self.earliest.take(test, bracket, time, primitives);
            let is_found = |(of, found, by): (ElementaryTest, Bracket<f64>, [u32; 2])| {
                (of, by) == (test, primitives) && found.nearest.distance == bracket.nearest.distance
            };
            if self.earliest.found.is_some_and(is_found) {
                self.found = Some(self.tested[open.of as usize]);
            }
            return goes_on;
        }
        self.earliest.iterations += bracket.iterations;
        self.earliest.tolerance = self.earliest.tolerance.max(bracket.tolerance);
        self.open[place as usize] = open;
        self.queue(Entry::at(bracket.lower, Candidate::Test(place)));
        true
    }
}
