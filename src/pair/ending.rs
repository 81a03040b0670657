//! The part of the search for a first contact ([`super::search`]) that ends it: with an answer, its spheres and the
//! points that touch, or as "unresolved" when the limit of work is used up.

use super::apart::Balls;
use super::deepening::Threshold;
use super::primitive_tree::PrimitiveTree;
use super::queue::{Tested, WorkItem};
use super::search::FirstContactSearch;
use super::tips::SubPrimitive;
use crate::elementary::bracket::{Bracket, Limits, witness};
use crate::elementary::distance::{Ball, nearest_in_test, signed_distance};
use crate::elementary::path::RigidPath;
use crate::elementary::test_list::{ElementaryTest, OwnedFeatures, for_each_test};
use crate::elementary::{InitialContact, Loss, ToiStatus};
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::medial::MedialSphere;
use crate::medial::tree::NodeKind;

/// Three spheres, those of a primitive or a part of it.
type Spheres = [Ball<f64>; 3];

impl<A: PrimitiveTree, B: PrimitiveTree> FirstContactSearch<'_, A, B> {
    /// Ends unresolved: nothing meets before `time`, and nothing is known from there on. The witness is of
    /// primitives that may come first.
    pub(super) fn give_up(&mut self, time: f64, first: Option<WorkItem>) {
        let primitives = match first {
            Some(WorkItem::Test(place)) => {
                let open = &self.open[place as usize];
                self.tested[open.of as usize].primitives
            }
            Some(WorkItem::SubPrimitives(place)) => self.tested[place as usize].primitives,
            Some(WorkItem::Nodes([i, j])) => {
                let (a, b) = (self.sides.0.node(i).below, self.sides.1.node(j).below);
                [
                    some_leaf(self.sides.0.body, a),
                    some_leaf(self.sides.1.body, b),
                ]
            }
            None => [0, 0],
        };
        self.found = None;
        self.met = None;
        let limits = Limits {
            start: time,
            ..self.earliest.limits
        };
        let [(_, share_a), (_, share_b)] = self.spheres(primitives);
        let shares = [share_a, share_b].map(|s| OwnedFeatures::whole(s.spheres));
        for_each_test(shares[0], shares[1], |test| {
            let mut bracket = Bracket::free(&limits);
            bracket.lower = time;
            self.earliest.found = Some((test, bracket, primitives));
            false
        });
        self.earliest.status = ToiStatus::Unresolved;
        self.earliest.lower = self.earliest.lower.min(time);
    }

    pub(super) fn path(&self, test: &ElementaryTest, of: &Tested) -> RigidPath<f64> {
        let [(a, _), (b, _)] = self.spheres(of.primitives);
        let (a, b) = (of.parts[0].of(&a), of.parts[1].of(&b));
        let Threshold { scale, target, .. } = of.threshold;
        RigidPath::new(test, &self.motions, target, |second, k| {
            let (center, radius) = if second { b[k as usize] } else { a[k as usize] };
            (center, scale * radius)
        })
    }

    /// Losses of the spheres of two primitives where cores are asked for.
    pub(super) fn losses(&self, [i, j]: [u32; 2]) -> [Loss; 2] {
        let Some(cores) = &self.cores else {
            return [Loss::default(); 2];
        };
        let (a, b) = (self.sides.0.body, self.sides.1.body);
        cores.losses([a.thickness(i), b.thickness(j)])
    }

    /// Spheres of two primitives, or of their cores, in the bodies' frames, and what they test.
    pub(super) fn spheres(&self, [i, j]: [u32; 2]) -> [(Spheres, OwnedFeatures); 2] {
        let losses = self.losses([i, j]);
        let (a, mut share_a) = self.sides.0.body.primitive(i);
        let (b, mut share_b) = self.sides.1.body.primitive(j);
        if self.cores.is_some_and(|c| c.share > 0.0) {
            // The radius that a core loses depends on its partner, so none leaves a test to a neighbour.
            [share_a, share_b] = [share_a, share_b].map(|s| OwnedFeatures::whole(s.spheres));
        }
        let local = |s: MedialSphere, loss: Loss| {
            let radius = f64::from(s.radius);
            (Vec3::from_vector(s.center), radius - loss.of(radius))
        };
        [
            (a.map(|s| local(s, losses[0])), share_a),
            (b.map(|s| local(s, losses[1])), share_b),
        ]
    }

    /// Makes the [`Self::hulls`] of two nodes.
    pub(super) fn sweep_hulls(&mut self, [i, j]: [u32; 2]) {
        self.sides.0.sweep_hull(i);
        self.sides.1.sweep_hull(j);
    }

    /// Hulls of two nodes over the piece.
    pub(super) fn hulls(&self, [i, j]: [u32; 2]) -> [&Balls; 2] {
        [self.sides.0.hull(i), self.sides.1.hull(j)]
    }

    /// Spheres of two primitives over the piece, or of their cores.
    pub(super) fn swept(&self, nodes: [u32; 2], [p, q]: [u32; 2]) -> [Balls; 2] {
        let balls = self.hulls(nodes).map(|hull| *hull);
        if self.cores.is_none_or(|cores| cores.share <= 0.0) {
            return balls;
        }
        let [loss_a, loss_b] = self.losses([p, q]);
        let (a, b) = (
            self.sides.0.body.primitive(p).0,
            self.sides.1.body.primitive(q).0,
        );
        [
            balls[0].less(a.map(|s| loss_a.of(s.radius.into()))),
            balls[1].less(b.map(|s| loss_b.of(s.radius.into()))),
        ]
    }

    /// Spheres of two primitives at the start.
    pub(super) fn at_start(&self, pair: [u32; 2]) -> (Spheres, Spheres) {
        self.at_time(pair, 0.0)
    }

    /// Spheres of two primitives at a time.
    pub(super) fn at_time(&self, pair: [u32; 2], time: f64) -> (Spheres, Spheres) {
        let [(a, _), (b, _)] = self.spheres(pair);
        let [first, second] = &self.motions;
        (placed(first, a, time), placed(second, b, time))
    }

    /// Signed distance of two primitives at the start; of the convex parts that they bound, where it is
    /// these that approach.
    pub(super) fn distance_at_start(&self, [p, q]: [u32; 2]) -> f64 {
        let distance = |pair: [u32; 2]| {
            let [(_, share_a), (_, share_b)] = self.spheres(pair);
            let (a, b) = self.at_start(pair);
            signed_distance(&a[..share_a.spheres], &b[..share_b.spheres])
        };
        if !matches!(self.initial_contact, InitialContact::Approach { .. }) {
            return distance([p, q]);
        }
        let (of_a, of_b) = (
            self.sides.0.body.convex_part(p),
            self.sides.1.body.convex_part(q),
        );
        let pairs = of_a.flat_map(|p| of_b.clone().map(move |q| [p, q]));
        pairs.map(distance).fold(f64::INFINITY, f64::min)
    }

    /// Makes the nearest sphere pair of the reported primitives at `lower` the witness. If parts of them touched at the
    /// start, only the parts that remain count. A test that is proven free until `lower` may be nearer than the test
    /// that was found.
    pub(super) fn settle(&mut self) {
        self.join_pieces();
        let Some((.., pair)) = self.earliest.found else {
            return;
        };
        if matches!(self.initial_contact, InitialContact::Approach { .. })
            && self.met.is_none()
            && self.earliest.status == ToiStatus::Contact
            && self.distance_at_start(pair) <= self.target + self.earliest.limits.tolerance
        {
            (self.earliest.lower, self.earliest.upper) = (0.0, 0.0);
        }
        let [(a, share_a), (b, share_b)] = self.spheres(pair);
        let whole = [share_a, share_b].map(|s| SubPrimitive::whole(s.spheres));
        let found = self.found.map(|of| (of.parts, of.threshold.scale));
        let (parts, scale) = found.unwrap_or((whole, 1.0));
        let Some((test, bracket, _)) = &mut self.earliest.found else {
            return;
        };
        let lower = self.earliest.lower;
        let (a, b) = (parts[0].of(&a), parts[1].of(&b));
        let [a, b] = [a, b].map(|s| s.map(|(center, radius)| (center, scale * radius)));
        let then = |side: usize, spheres: Spheres| placed(&self.motions[side], spheres, lower);
        let (pa, pb) = (then(0, a), then(1, b));
        let shares = parts.map(|part| OwnedFeatures::whole(part.spheres));
        let mut least = f64::INFINITY;
        for_each_test(shares[0], shares[1], |other| {
            let distance = nearest_in_test(&other, &pa, &pb).1.distance;
            if distance < least {
                (*test, least) = (other, distance);
            }
            true
        });
        let path = RigidPath::new(test, &self.motions, self.target, |second, k| {
            if second { b[k as usize] } else { a[k as usize] }
        });
        bracket.lower = lower;
        (bracket.nearest, bracket.normal) = witness(&path, test.domain, lower);
    }
}

/// Spheres of a body at a time.
fn placed(motion: &RigidMotion<f64>, spheres: Spheres, time: f64) -> Spheres {
    let turned = motion.sin_cos(time);
    spheres.map(|(c, r)| (motion.point(c).at(time, turned).position, r))
}

/// A primitive below a node.
fn some_leaf(body: &impl PrimitiveTree, mut below: NodeKind) -> u32 {
    loop {
        match below {
            NodeKind::Primitive(primitive) => return primitive,
            NodeKind::Nodes(first, _) => below = body.kind(first),
        }
    }
}
