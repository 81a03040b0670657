//! The part of the search for a first contact ([`super::search`]) that deals with two primitives: it lists their
//! elementary tests, and takes one of them further.

use super::apart::{Balls, Reach};
use super::deepening::{Threshold, free_way};
use super::primitive_tree::PrimitiveTree;
use super::queue::{Entry, OpenTest, Tested, WorkItem};
use super::search::FirstContactSearch;
use super::tips::{SubPrimitive, SubPrimitives};
use crate::elementary::InitialContact;
use crate::elementary::bracket::{Bracket, Limits};
use crate::elementary::distance::{
    Ball, crossing, signed_distance, signed_distance_along, thinnest,
};
use crate::elementary::resumed::bracket_until;
use crate::elementary::test_list::{ElementaryTest, OwnedFeatures, for_each_test};
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::medial::tree::NodeKind;

impl<A: PrimitiveTree, B: PrimitiveTree> FirstContactSearch<'_, A, B> {
    /// Lists the elementary tests of two primitives that are free until `time`; returns whether an
    /// earlier contact is still possible.
    pub(super) fn list_tests(&mut self, [i, j]: [u32; 2], time: f64) -> bool {
        let (NodeKind::Primitive(p), NodeKind::Primitive(q)) =
            (self.sides.0.node(i).below, self.sides.1.node(j).below)
        else {
            return true;
        };
        let pair = [p, q];
        let [(all_a, share_a), (all_b, share_b)] = self.spheres(pair);
        let (sa, sb) = (&all_a[..share_a.spheres], &all_b[..share_b.spheres]);
        let tolerance = self.earliest.limits.tolerance;
        let whole = [share_a, share_b].map(|s| SubPrimitive::whole(s.spheres));
        let mut target = self.target;
        if self.initial_contact == InitialContact::Stop {
            target = target.max(-thinnest(sa, sb));
        }
        let mut threshold = Threshold::new(target, tolerance);
        let mut direction = None;
        match self.initial_contact {
            InitialContact::Deepen { by } if !self.is_known_apart(time) => {
                let (pa, pb) = self.at_start(pair);
                let (pa, pb) = (&pa[..share_a.spheres], &pb[..share_b.spheres]);
                let (distance, normal) = signed_distance_along(pa, pb);
                let touching = target + tolerance;
                if distance > touching {
                    direction = normal;
                } else if by == Real::INFINITY {
                    return true;
                } else {
                    let depth = (distance - touching - f64::from(by)) / self.thickness(pair);
                    let (a, b) = (self.sides.0.node(i).node, self.sides.1.node(j).node);
                    self.touching.push(([a, b], depth));
                    self.list_parts([i, j], pair, by.into(), time, (distance, normal));
                    return true;
                }
            }
            InitialContact::Deepen { .. } => {}
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
            [share_a, share_b].map(|s| OwnedFeatures::whole(s.spheres))
        };
        let tested = Tested {
            nodes: [i, j],
            primitives: pair,
            parts: whole,
            threshold,
        };
        self.list_whole(tested, shares, direction, time);
        true
    }

    /// Lists the tests of two primitives as they are, unless the direction between their nearest spheres puts them off;
    /// `at_start` is that direction at the start.
    fn list_whole(
        &mut self,
        tested: Tested,
        shares: [OwnedFeatures; 2],
        at_start: Option<Vec3<f64>>,
        time: f64,
    ) {
        let balls = self.swept(tested.nodes, tested.primitives);
        let deepens = matches!(self.initial_contact, InitialContact::Deepen { .. });
        let mut direction = None;
        if deepens && balls.iter().all(Balls::is_slab) {
            direction = if time > 0.0 {
                self.direction_at(&tested, time)
            } else {
                at_start
            };
            let held =
                direction.map(|n| self.held_until(balls.each_ref(), n, &tested.threshold, time));
            match held {
                Some(None) => return,
                Some(Some(free)) if !self.gains_too_little(free, time) => {
                    self.wait(tested.nodes, free);
                    return;
                }
                _ => {}
            }
        }
        self.list(tested, shares, &balls, direction, time);
    }

    /// Whether primitives that are free until `time` are known not to touch at the start of the motions.
    pub(super) fn is_known_apart(&self, time: f64) -> bool {
        self.pieces == 1 && time > 0.0
    }

    /// The direction between the nearest spheres of what is tested, at a time.
    fn direction_at(&self, tested: &Tested, time: f64) -> Option<Vec3<f64>> {
        let (a, b) = self.at_time(tested.primitives, time);
        let scale = tested.threshold.scale;
        let [a, b] = [(a, 0), (b, 1)].map(|(all, side)| {
            let spheres = tested.parts[side].of(&all);
            spheres.map(|(center, radius)| (center, scale * radius))
        });
        let [m, n] = tested.parts.map(|part| part.spheres);
        signed_distance_along(&a[..m], &b[..n]).1
    }

    /// Lists the tests of what has waited until `time`, or has it wait longer; returns whether an earlier contact is
    /// still possible.
    pub(super) fn list_later(&mut self, place: u32, time: f64) -> bool {
        let tested = self.tested[place as usize];
        let balls = self.swept_parts(&tested);
        let direction = self.direction_at(&tested, time);
        self.list_or_wait(place, &balls, direction, time);
        true
    }

    /// Lists the tests of parts with a threshold of their own, unless a direction puts them off.
    fn list_or_wait(
        &mut self,
        place: u32,
        balls: &[Balls; 2],
        direction: Option<Vec3<f64>>,
        time: f64,
    ) {
        let tested = self.tested[place as usize];
        self.proofs += 1;
        match direction.map(|n| self.held_until(balls.each_ref(), n, &tested.threshold, time)) {
            Some(None) => {}
            Some(Some(free)) if !self.gains_too_little(free, time) => {
                self.queue(Entry::at(free, WorkItem::SubPrimitives(place)));
            }
            _ => {
                let shares = tested.parts.map(|part| OwnedFeatures::whole(part.spheres));
                self.list_tests_of(place, shares, balls, direction, time);
            }
        }
    }

    /// Balls of parts over the piece, with the radii that their threshold is for.
    fn swept_parts(&self, tested: &Tested) -> [Balls; 2] {
        let swept = self.swept(tested.nodes, tested.primitives);
        let [a, b] = &tested.parts;
        let scale = tested.threshold.scale;
        let balls = [a.of_swept(&swept[0]), b.of_swept(&swept[1])];
        if scale >= 1.0 {
            return balls;
        }
        let [(all_a, _), (all_b, _)] = self.spheres(tested.primitives);
        let lost = |s: &Ball<f64>| (1.0 - scale) * s.1;
        let [lost_a, lost_b] = [a.of(&all_a), b.of(&all_b)].map(|s| s.each_ref().map(lost));
        [balls[0].less(lost_a), balls[1].less(lost_b)]
    }

    /// Lists the tests of two primitives that touch at the start and may sink in `by` deeper, without their tips: each
    /// part has a threshold of its own. `whole`: their signed distance at the start, and the direction between their
    /// nearest spheres.
    fn list_parts(
        &mut self,
        nodes: [u32; 2],
        pair: [u32; 2],
        by: f64,
        time: f64,
        whole: (f64, Option<Vec3<f64>>),
    ) {
        let tolerance = self.earliest.limits.tolerance;
        let [(all_a, share_a), (all_b, share_b)] = self.spheres(pair);
        let (sa, sb) = (&all_a[..share_a.spheres], &all_b[..share_b.spheres]);
        let kept = self.cores.map_or([0.0; 2], |cores| {
            let (a, b) = (self.sides.0.body, self.sides.1.body);
            cores.kept([a.thickness(pair[0]), b.thickness(pair[1])])
        });
        let parts_a = SubPrimitives::without_tips(sa, kept[0]);
        let parts_b = SubPrimitives::without_tips(sb, kept[1]);
        let start = self.at_start(pair);
        if self.stays_shallow(nodes, pair, by, whole.1) {
            return;
        }
        for (a, b) in parts_a
            .iter()
            .flat_map(|a| parts_b.iter().map(move |b| (a, b)))
        {
            let (pa, pb) = (a.of(&start.0), b.of(&start.1));
            let (pa, pb) = (&pa[..a.spheres], &pb[..b.spheres]);
            let (distance, direction) = if a.is_whole() && b.is_whole() {
                whole
            } else {
                signed_distance_along(pa, pb)
            };
            // The primitive behind a tip may be farther off, and counts as touching as the tip does.
            let distance = distance.min(self.target + tolerance);
            let axes = || {
                let axis = |s: [Ball<f64>; 3]| s.map(|(center, _)| (center, 0.0));
                let (axis_a, axis_b) = (axis(a.of(&start.0)), axis(b.of(&start.1)));
                signed_distance(&axis_a[..a.spheres], &axis_b[..b.spheres])
            };
            let thinnest = thinnest(pa, pb);
            let tested = Tested {
                nodes,
                primitives: pair,
                parts: [*a, *b],
                threshold: Threshold::deepened(distance, thinnest, by, tolerance, axes),
            };
            // The tests are those that the contact needs, of whole parts, not those of the search: primitives that
            // touch already have a target of their own, and mostly directions put them off for good.
            let balls = self.swept_parts(&tested);
            let shares = tested.parts.map(|part| OwnedFeatures::whole(part.spheres));
            if a.spheres.min(b.spheres) < 3 {
                // One proof for all tests, where there are many.
                let many = a.spheres.max(b.spheres) == 3;
                let is_free = || {
                    self.above_until(balls.each_ref(), &tested.threshold, time)
                        .is_none()
                };
                if !(many && is_free()) {
                    self.list(tested, shares, &balls, None, time);
                }
                continue;
            }
            let place = self.tested.len() as u32;
            self.tested.push(tested);
            self.list_or_wait(place, &balls, direction, time);
        }
    }

    /// Whether two primitives that touch at the start travel less in the step than any of their parts may sink in `by`,
    /// or as much less as their axes are near. `direction` is between their nearest spheres.
    fn stays_shallow(
        &self,
        nodes: [u32; 2],
        pair: [u32; 2],
        by: f64,
        direction: Option<Vec3<f64>>,
    ) -> bool {
        let Some(n) = direction.filter(|_| self.times == [0.0, 1.0]) else {
            return false;
        };
        let (start_a, start_b) = self.at_start(pair);
        let along = |s: &Ball<f64>| n.dot(s.0);
        let far = start_a.iter().map(along).fold(f64::MIN, f64::max);
        let near = start_b.iter().map(along).fold(f64::MAX, f64::min);
        if near <= far {
            return false;
        }
        let swept = self.swept(nodes, pair);
        let [(a, _), (b, _)] = self.spheres(pair);
        let sagittas = swept[0].sagitta(a.map(|s| s.1)) + swept[1].sagitta(b.map(|s| s.1));
        let way = free_way(by, near - far, self.earliest.limits.tolerance);
        swept[0].travel(&swept[1], sagittas) < way
    }

    /// Lists the elementary tests of a part of each of two primitives, as far as directions do not prove them free.
    fn list(
        &mut self,
        tested: Tested,
        shares: [OwnedFeatures; 2],
        balls: &[Balls; 2],
        direction: Option<Vec3<f64>>,
        time: f64,
    ) {
        let place = self.tested.len() as u32;
        self.tested.push(tested);
        self.list_tests_of(place, shares, balls, direction, time);
    }

    /// Lists the elementary tests of the pair at place `of` in the list; `direction` is tried on all of them first.
    fn list_tests_of(
        &mut self,
        of: u32,
        shares: [OwnedFeatures; 2],
        balls: &[Balls; 2],
        direction: Option<Vec3<f64>>,
        time: f64,
    ) {
        let threshold = self.tested[of as usize].threshold;
        let contact = threshold.target + threshold.tolerance;
        let reach = direction.map(|n| Reach::new(balls.each_ref(), n, contact));
        for_each_test(shares[0], shares[1], |test| {
            let span = self.span(time);
            if reach.as_ref().is_some_and(|r| r.is_apart(&test, span)) {
                return true;
            }
            self.proofs += 1;
            let some = [
                balls[0].only(test.corners.map(|c| c.0)),
                balls[1].only(test.corners.map(|c| c.1)),
            ];
            if let Some(free) = self.above_until([&some[0], &some[1]], &threshold, time) {
                let place = WorkItem::Test(self.open.len() as u32);
                self.queue(Entry::at(free, place));
                self.open.push(OpenTest { of, test, spent: 0 });
            }
            true
        });
    }

    /// Thickness of the thinner of two primitives, or the least number where it has none.
    fn thickness(&self, [p, q]: [u32; 2]) -> f64 {
        let (a, b) = (self.sides.0.body, self.sides.1.body);
        self.at_most(a.thickness(p).min(b.thickness(q)))
    }

    /// A thickness as far as that of the partner allows.
    pub(super) fn at_most(&self, thickness: Real) -> f64 {
        let thinner = (self.cores).map_or(thickness, |c| thickness.min(c.at_most));
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
            let continues = self.earliest.take(test, bracket, time, primitives);
            let is_found = |(of, found, by): (ElementaryTest, Bracket<f64>, [u32; 2])| {
                (of, by) == (test, primitives) && found.nearest.distance == bracket.nearest.distance
            };
            if self.earliest.found.is_some_and(is_found) {
                self.found = Some(self.tested[open.of as usize]);
                self.met = None;
            }
            return continues;
        }
        self.earliest.iterations += bracket.iterations;
        self.earliest.tolerance = self.earliest.tolerance.max(bracket.tolerance);
        self.open[place as usize] = open;
        self.queue(Entry::at(bracket.lower, WorkItem::Test(place)));
        true
    }
}
