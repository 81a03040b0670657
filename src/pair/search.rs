//! The search of [`super::first_contact`]: what may meet waits in a queue at the time until which it is
//! proven free, and is taken further only when it comes first.
//!
//! - A node's ball keeps its radius under any rotation; its centre stays within the sagitta `A/8` of
//!   its chord ([`crate::math::motion`]), so two nodes cannot meet before the balls, grown by both
//!   sagittas and moved along the chords, do: the smaller root of a quadratic.
//! - Two primitives cannot meet while a direction keeps them apart ([`super::apart`]), nor can the
//!   spheres of one of their elementary tests. All this until they come within the tolerance, so that
//!   what touches at the start is found there.
//! - An elementary test has its bracket's lower bound ([`crate::elementary::bracket`]).
//!
//! So the first test that is in contact when its turn comes is the first contact. A fast turn is
//! searched in pieces, so that sagittas stay small. And what comes first in the queue bounds the contact
//! from below at any moment: a search that has used up [`WORK`] ends there, unresolved, and says so.

use super::apart::{Balls, free_until};
use super::ending::{ROOT_PIECES, WORK, spheres};
use super::first_contact::Counts;
use super::queue::{Candidate, Entry, Open};
use super::swept::Side;
use super::volumes::Volumes;
use crate::elementary::bracket::Limits;
use crate::elementary::distance::{crossing, signed_distance, thinnest};
use crate::elementary::first_contact::{Earliest, options_limits};
use crate::elementary::resumed::bracket_until;
use crate::elementary::test_list::{Share, for_each_test};
use crate::elementary::{InitialContact, ToiOptions, ToiStatus};
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::medial::tree::Below;
use std::collections::BinaryHeap;

/// Angle in radians that a piece of the search turns at most: the sagitta is then below 3 % of the
/// lever arm. Larger pieces cull worse, smaller ones repeat the walk down the trees.
const PIECE_ANGLE: f64 = 0.5;

/// Fraction of a piece by which directions must put off two primitives for them to wait in the queue;
/// with less their elementary tests are listed. Smaller lets the last steps before a contact creep,
/// larger runs tests that directions would have spared.
const WORTH_WAITING: f64 = 1.0e-3;

/// Up to this ratio of their radii two nodes are split together. With 1 (one at a time) approaches take a
/// fifth longer, fast queries a tenth; 1.5 is nearly as good.
const SIMILAR: f64 = 3.0;

/// One query on its way.
pub(super) struct Search<'a, A, B> {
    pub(super) sides: (Side<'a, A>, Side<'a, B>),
    pub(super) motions: [RigidMotion<f64>; 2],
    /// Start and end of the piece searched.
    pub(super) times: [f64; 2],
    pub(super) target: f64,
    /// What culling goes by: no primitive pair has a larger target, raised or not.
    pub(super) reach: f64,
    pub(super) initial_contact: InitialContact,
    pub(super) heap: BinaryHeap<Entry>,
    /// One candidate that is not in the heap.
    pub(super) first: Option<Entry>,
    /// Elementary tests that are not settled.
    pub(super) open: Vec<Open>,
    /// Pieces begun.
    pub(super) pieces: u64,
    /// Times that directions were tried on two primitives.
    pub(super) proofs: u64,
    /// What [`Self::worked`] may reach.
    pub(super) budget: u64,
    pub(super) counts: Counts,
    pub(super) earliest: Earliest<f64>,
}

impl<'a, A: Volumes, B: Volumes> Search<'a, A, B> {
    pub(super) fn new(
        bodies: (&'a A, &'a B),
        motions: [RigidMotion<f64>; 2],
        options: &ToiOptions,
    ) -> Self {
        let target = f64::from(options.target_distance);
        Self {
            sides: (
                Side::new(bodies.0, motions[0]),
                Side::new(bodies.1, motions[1]),
            ),
            motions,
            times: [0.0, 1.0],
            target,
            reach: match options.initial_contact {
                InitialContact::Stop => target.max(0.0),
                InitialContact::Deepen { .. } => target,
            },
            initial_contact: options.initial_contact,
            heap: BinaryHeap::with_capacity(512),
            first: None,
            open: Vec::with_capacity(128),
            pieces: 0,
            proofs: 0,
            budget: WORK,
            counts: Counts::default(),
            earliest: Earliest::new(options_limits(options)),
        }
    }

    /// Searches the whole step.
    pub(super) fn run(&mut self) {
        let fastest = self.motions[0].angle().max(self.motions[1].angle());
        let pieces = (fastest / PIECE_ANGLE).ceil().max(1.0);
        let roots = [self.sides.0.body.roots(), self.sides.1.body.roots()].map(u64::from);
        if roots.contains(&0) {
            return;
        }
        // Bodies of many roots, such as terrain, pay for them in each piece.
        self.budget = WORK + ROOT_PIECES * roots[0] * roots[1];
        loop {
            let start = self.pieces as f64 / pieces;
            self.pieces += 1;
            let end = self.pieces as f64 / pieces;
            if !self.piece(start, end) || end >= 1.0 {
                break;
            }
        }
        self.settle();
        self.counts.tests = self.earliest.tests;
    }

    /// Searches one piece of the step; returns whether the next one may still hold the answer.
    fn piece(&mut self, start: f64, end: f64) -> bool {
        self.earliest.limits = Limits {
            start,
            horizon: end,
            ..self.earliest.limits
        };
        self.times = [start, end];
        self.sides.0.begin(start, end);
        self.sides.1.begin(start, end);
        self.heap.clear();
        self.first = None;
        self.open.clear();
        for i in 0..self.sides.0.body.roots() {
            for j in 0..self.sides.1.body.roots() {
                self.push([i, j]);
            }
        }
        if self.worked() >= self.budget {
            self.give_up(start, None);
            return false;
        }
        while let Some(entry) = self.next() {
            if entry.time > self.earliest.upper.min(end) {
                break;
            }
            if self.worked() >= self.budget {
                self.give_up(entry.time, Some(entry.candidate));
                return false;
            }
            let open = match entry.candidate {
                Candidate::Nodes(nodes) => self.expand(nodes, entry.time),
                Candidate::Test(index) => self.advance(index, entry.time),
            };
            if !open {
                return false;
            }
        }
        self.earliest.status == ToiStatus::Separated
    }

    fn worked(&self) -> u64 {
        // Each takes about 0.3 µs, an iteration twice that.
        let iterations = 2 * u64::from(self.earliest.iterations);
        u64::from(self.counts.nodes) + iterations + self.pieces + self.proofs
    }

    /// The first candidate. Of two nodes just split one is often the first again: it waits in
    /// `self.first`, which spares it the way through the heap.
    fn next(&mut self) -> Option<Entry> {
        let Some(entry) = self.first.take() else {
            return self.heap.pop();
        };
        match self.heap.peek_mut() {
            Some(mut top) if *top > entry => Some(std::mem::replace(&mut *top, entry)),
            _ => Some(entry),
        }
    }

    fn queue(&mut self, entry: Entry) {
        match &mut self.first {
            None => self.first = Some(entry),
            Some(first) if *first < entry => {
                let later = std::mem::replace(first, entry);
                self.heap.push(later);
            }
            Some(_) => self.heap.push(entry),
        }
    }

    /// Queues two swept nodes at the time at which their balls meet, if they do in this piece.
    fn push(&mut self, nodes: [u32; 2]) {
        self.counts.nodes += 1;
        let (a, b) = (self.sides.0.node(nodes[0]), self.sides.1.node(nodes[1]));
        let y = b.start - a.start;
        let rate = b.chord - a.chord;
        // Within the tolerance they touch.
        let tolerance = self.earliest.limits.tolerance;
        let radius = a.radius + b.radius + self.reach + tolerance;
        let radius = (radius + 64.0 * f64::EPSILON * radius.abs()).max(0.0);
        let (yy, yr, rr) = (y.length_sq(), y.dot(rate), rate.length_sq());
        let c = yy - radius * radius;
        let (mut time, mut depth) = (self.times[0], 0.0);
        if c <= 0.0 {
            depth = (yy.sqrt() - radius) / radius.max(f64::MIN_POSITIVE);
        } else {
            let discriminant = yr * yr - rr * c;
            if yr >= 0.0 || discriminant < 0.0 {
                return;
            }
            let entry = c / (discriminant.sqrt() - yr);
            if entry > 1.0 {
                return;
            }
            time += entry * (self.times[1] - self.times[0]);
        }
        if time <= self.earliest.upper.min(self.times[1]) {
            self.queue(Entry {
                time,
                depth,
                candidate: Candidate::Nodes(nodes),
            });
        }
    }

    /// Replaces two nodes by what is below the larger; two primitives wait until directions no
    /// longer keep them apart. Returns whether an earlier contact is still possible.
    fn expand(&mut self, [i, j]: [u32; 2], time: f64) -> bool {
        let (a, b) = (*self.sides.0.node(i), *self.sides.1.node(j));
        if let (Below::Primitive(p), Below::Primitive(q)) = (a.below, b.below) {
            self.proofs += 1;
            let places = [self.sides.0.sweep_leaf(i, p), self.sides.1.sweep_leaf(j, q)];
            let balls = [self.sides.0.balls(places[0]), self.sides.1.balls(places[1])];
            return match self.free_until(balls, time) {
                None => true,
                Some(free) if self.soon(free, time) => self.list_tests([i, j], free),
                Some(free) => self.wait([i, j], free),
            };
        }
        // A ball round a large primitive, such as a triangle of the ground, holds all that is near it.
        // Directions tell how far the node's ball is from the primitive itself.
        let large = match (a.below, b.below) {
            (Below::Nodes(..), Below::Primitive(q)) if a.radius * SIMILAR < b.radius => {
                let ball = Balls::new([(a.start, a.chord, a.radius)].into_iter());
                let place = self.sides.1.sweep_leaf(j, q);
                Some([ball, *self.sides.1.balls(place)])
            }
            (Below::Primitive(p), Below::Nodes(..)) if b.radius * SIMILAR < a.radius => {
                let ball = Balls::new([(b.start, b.chord, b.radius)].into_iter());
                let place = self.sides.0.sweep_leaf(i, p);
                Some([*self.sides.0.balls(place), ball])
            }
            _ => None,
        };
        if let Some([first, second]) = large {
            self.proofs += 1;
            match self.free_until([&first, &second], time) {
                None => return true,
                Some(free) if !self.soon(free, time) => return self.wait([i, j], free),
                Some(_) => {}
            }
        }
        // Both at once where they are about as large: the pairs in between would be looked at only to
        // be split. Below that, the larger one.
        let (small, large) = (a.radius * SIMILAR < b.radius, b.radius * SIMILAR < a.radius);
        let inner = [a.below, b.below].map(|below| matches!(below, Below::Nodes(..)));
        let parts_of_a = self.sides.0.parts(i, !(small && inner[1]));
        let parts_of_b = self.sides.1.parts(j, !(large && inner[0]));
        for a in parts_of_a.clone() {
            for b in parts_of_b.clone() {
                self.push([a, b]);
            }
        }
        true
    }

    /// Whether directions gain too little for two candidates to wait.
    fn soon(&self, free: f64, time: f64) -> bool {
        free < time + WORTH_WAITING * (self.times[1] - self.times[0])
    }

    /// Has two nodes wait until `free`.
    fn wait(&mut self, nodes: [u32; 2], free: f64) -> bool {
        self.queue(Entry {
            time: free,
            depth: 0.0,
            candidate: Candidate::Nodes(nodes),
        });
        true
    }

    /// Until when directions prove two primitives free from `time` on; `None` if as long as the
    /// search asks.
    fn free_until(&self, balls: [&Balls; 2], time: f64) -> Option<f64> {
        let [start, end] = self.times;
        let length = end - start;
        let until = (self.earliest.upper.min(end) - start) / length;
        let from = (time - start) / length;
        let free = free_until(
            balls,
            [from, until],
            self.reach,
            self.earliest.limits.tolerance,
        );
        if free <= from {
            return Some(time);
        }
        // Rounding of the way to the piece's fractions and back.
        (free < until).then(|| (start + free * length).next_down().next_down().max(time))
    }

    /// Lists the elementary tests of two primitives that are free until `time`; returns whether an
    /// earlier contact is still possible.
    fn list_tests(&mut self, [i, j]: [u32; 2], time: f64) -> bool {
        let (Below::Primitive(p), Below::Primitive(q)) =
            (self.sides.0.node(i).below, self.sides.1.node(j).below)
        else {
            return true;
        };
        let pair = [p, q];
        let [(sa, share_a), (sb, share_b)] = spheres(&self.sides, pair);
        let (sa, sb) = (&sa[..share_a.spheres], &sb[..share_b.spheres]);
        let at_start = |side: usize, s: &[(Vec3<f64>, f64)]| {
            let turned = self.motions[side].sin_cos(0.0);
            let place = |c| self.motions[side].point(c).at(0.0, turned).position;
            s.iter().map(|s| (place(s.0), s.1)).collect::<Vec<_>>()
        };
        let mut target = self.target;
        if self.initial_contact == InitialContact::Stop {
            target = target.max(-thinnest(sa, sb));
        }
        match self.initial_contact {
            InitialContact::Deepen { by } => {
                let (pa, pb) = (at_start(0, sa), at_start(1, sb));
                let distance = signed_distance(&pa, &pb);
                let tolerance = self.earliest.limits.tolerance;
                if distance <= target + tolerance {
                    target = distance - f64::from(by) - tolerance;
                }
            }
            // Proven free until later, they cannot cross at the start.
            InitialContact::Stop if time == 0.0 => {
                let (pa, pb) = (at_start(0, sa), at_start(1, sb));
                let crossings = [
                    crossing(&pa, share_a.edges, &pb),
                    crossing(&pb, share_b.edges, &pa),
                ];
                if crossings.iter().flatten().any(|c| -c.radius <= target) {
                    self.earliest.overlap_at_start();
                    self.earliest.found = None;
                    return false;
                }
            }
            InitialContact::Stop => {}
        }
        // A target of the pair's own leaves no test to a neighbour, whose target is another.
        let shares = if target == self.target {
            [share_a, share_b]
        } else {
            [share_a, share_b].map(|s| Share::whole(s.spheres))
        };
        let places = [self.sides.0.sweep_leaf(i, p), self.sides.1.sweep_leaf(j, q)];
        let balls = [self.sides.0.balls(places[0]), self.sides.1.balls(places[1])].map(|b| *b);
        for_each_test(shares[0], shares[1], |test| {
            self.proofs += 1;
            let some = [
                balls[0].only(test.corners.map(|c| c.0)),
                balls[1].only(test.corners.map(|c| c.1)),
            ];
            if let Some(free) = self.free_until([&some[0], &some[1]], time) {
                let open = Open {
                    primitives: pair,
                    test,
                    target,
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

    /// Takes one test further, until it is settled or another candidate may come first; returns
    /// whether an earlier contact is still possible.
    fn advance(&mut self, place: u32, time: f64) -> bool {
        let mut open = self.open[place as usize];
        let limits = self.earliest.limits;
        let limits = Limits {
            start: time,
            horizon: self.earliest.upper.min(limits.horizon),
            max_iterations: limits.max_iterations - open.spent,
            ..limits
        };
        let until = (self.heap.peek()).map_or(limits.horizon, |next| next.time.max(time));
        let path = self.path(&open.test, open.primitives, open.target);
        let bracket = bracket_until(&path, open.test.domain, &limits, until);
        self.earliest.tests += u32::from(open.spent == 0);
        open.spent += bracket.iterations;
        let settled = bracket.contact || bracket.separated || !bracket.slack.is_finite();
        if settled || bracket.iterations >= limits.max_iterations {
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
