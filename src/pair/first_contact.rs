//! First contact of two bodies made of primitives, in exact rigid motion: best-first over their
//! trees. The paper (§4.1) tests all pairs; this visits the few that can come first.
//!
//! A node's ball keeps its radius under any rotation; its centre stays within the sagitta
//! `A/8` of its chord ([`crate::math::motion`]), so two nodes cannot meet before the balls, grown by
//! both sagittas and moved along the chords, do: the smaller root of a quadratic. Node pairs are
//! expanded in the order of that time, and the search ends when the next one lies after the best
//! contact found. A fast turn is searched in pieces, so that sagittas stay small.

use super::queue::{Candidate, Entry, Open};
use super::swept::{Balls, Piece, Swept, free_until};
use super::volumes::Volumes;
use crate::elementary::bracket::Limits;
use crate::elementary::distance::{crossing, signed_distance, thinnest};
use crate::elementary::first_contact::{Earliest, motion_is_finite, options_limits, to_toi};
use crate::elementary::path::RigidPath;
use crate::elementary::resumed::bracket_until;
use crate::elementary::test_list::{ElementaryTest, Share, for_each_test};
use crate::elementary::{InitialContact, Toi, ToiOptions, ToiStatus};
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::medial::MedialSphere;
use crate::medial::tree::Below;
use parry3d::query::NonlinearRigidMotion;
use std::collections::BinaryHeap;

/// Angle in radians that a piece of the search turns at most: the sagitta is then below 3 % of the
/// lever arm. Larger pieces cull worse, smaller ones repeat the walk down the trees.
const PIECE_ANGLE: f64 = 0.5;

/// Most pieces of one search; a body that turns further in one step is culled less well.
const MAX_PIECES: f64 = 64.0;

/// Work done by one query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Node pairs looked at.
    pub nodes: u32,
    /// Elementary tests executed.
    pub tests: u32,
}

/// First contact of two meshes whose bodies move rigidly over `seconds`.
///
/// Motions are in world space, velocities per second; times in the answer are fractions of the
/// step. The guarantee is that of [`crate::elementary`], for the union of all primitives. Computed
/// in double precision.
pub fn first_contact(
    mesh1: &crate::MedialMesh,
    motion1: &NonlinearRigidMotion,
    mesh2: &crate::MedialMesh,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> Toi {
    first_contact_counted(mesh1, motion1, mesh2, motion2, seconds, options).0
}

/// As [`first_contact`] for any two bodies, with the work it took.
pub fn first_contact_counted(
    body1: &impl Volumes,
    motion1: &NonlinearRigidMotion,
    body2: &impl Volumes,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> (Toi, Counts) {
    let finite = motion_is_finite(motion1) && motion_is_finite(motion2) && seconds.is_finite();
    let bounds_finite = options.tolerance.is_finite()
        && options.time_tolerance.is_finite()
        && options.target_distance.is_finite();
    if !finite || !bounds_finite {
        return (Toi::bad_input(options), Counts::default());
    }
    let motions = RigidMotion::<f64>::pair(motion1, motion2, seconds.into());
    let target = f64::from(options.target_distance);
    let mut search = Search {
        bodies: (body1, body2),
        motions,
        target,
        reach: match options.initial_contact {
            InitialContact::Stop => target.max(0.0),
            InitialContact::Deepen { .. } => target,
        },
        initial_contact: options.initial_contact,
        heap: BinaryHeap::new(),
        counts: Counts::default(),
        earliest: Earliest::new(options_limits(options)),
    };
    let fastest = motions[0].angle().max(motions[1].angle());
    let pieces = (fastest / PIECE_ANGLE).ceil().clamp(1.0, MAX_PIECES);
    for piece in 0..pieces as u32 {
        let end = f64::from(piece + 1) / pieces;
        if !search.piece(f64::from(piece) / pieces, end) {
            break;
        }
    }
    search.settle();
    search.counts.tests = search.earliest.tests;
    let found = search.earliest.found;
    let pose = |side: usize, i: u8, t: Real| {
        let Some((_, _, primitives)) = found else {
            return MedialSphere::default();
        };
        let spheres = match side {
            0 => body1.primitive(primitives[0]).0,
            _ => body2.primitive(primitives[1]).0,
        };
        let s = spheres[i as usize];
        let at = [motion1, motion2][side].position_at_time(t * seconds);
        MedialSphere::new(at * s.center, s.radius)
    };
    (to_toi(&search.earliest, options, pose), search.counts)
}

type Spheres = [(Vec3<f64>, f64); 3];

struct Search<'a, A, B> {
    bodies: (&'a A, &'a B),
    motions: [RigidMotion<f64>; 2],
    target: f64,
    /// What culling goes by: no primitive pair has a larger target, raised or not.
    reach: f64,
    initial_contact: InitialContact,
    heap: BinaryHeap<Entry>,
    counts: Counts,
    earliest: Earliest<f64>,
}

impl<A: Volumes, B: Volumes> Search<'_, A, B> {
    /// Searches one piece of the step; returns whether the next one may still hold the answer.
    fn piece(&mut self, start: f64, end: f64) -> bool {
        self.earliest.limits = Limits {
            start,
            horizon: end,
            ..self.earliest.limits
        };
        let sides = [0, 1].map(|side| Piece::new(self.motions[side], start, end));
        self.heap.clear();
        for i in 0..self.bodies.0.roots() {
            let a = sides[0].sweep(i, self.bodies.0.bound(i));
            for j in 0..self.bodies.1.roots() {
                let b = sides[1].sweep(j, self.bodies.1.bound(j));
                self.push([a, b], start, end);
            }
        }
        while let Some(entry) = self.heap.pop() {
            if entry.time > self.earliest.upper.min(end) {
                break;
            }
            let open = match entry.candidate {
                Candidate::Nodes(nodes) => self.expand(nodes, entry.time, &sides),
                Candidate::Primitives(pair) => self.list_tests(pair, entry.time, &sides),
                Candidate::Test(open) => self.advance(open, entry.time),
            };
            if !open {
                return false;
            }
        }
        self.earliest.status == ToiStatus::Separated
    }

    fn push(&mut self, nodes: [Swept; 2], start: f64, end: f64) {
        self.counts.nodes += 1;
        let y = nodes[1].start - nodes[0].start;
        let rate = nodes[1].chord - nodes[0].chord;
        let radius = nodes[0].radius + nodes[1].radius + self.reach;
        // Rounding of positions, chords and the root: a few ulps of the numbers in play.
        let size = y.length() + rate.length() + radius.abs();
        let radius = (radius + 64.0 * f64::EPSILON * size).max(0.0);
        let (yy, yr, rr) = (y.length_sq(), y.dot(rate), rate.length_sq());
        let c = yy - radius * radius;
        let entry = if c <= 0.0 {
            0.0
        } else {
            let discriminant = yr * yr - rr * c;
            if yr >= 0.0 || discriminant < 0.0 {
                return;
            }
            c / (discriminant.sqrt() - yr)
        };
        let time = start + entry * (end - start);
        if entry > 1.0 || time > self.earliest.upper.min(end) {
            return;
        }
        let depth = (yy.sqrt() - radius) / radius.max(f64::MIN_POSITIVE);
        self.heap.push(Entry::nodes(time, depth, nodes));
    }

    /// Replaces two nodes by what is below the larger; two primitives wait until directions no
    /// longer keep them apart. Returns whether an earlier contact is still possible.
    fn expand(&mut self, [a, b]: [Swept; 2], time: f64, sides: &[Piece; 2]) -> bool {
        let [start, end] = sides[0].times;
        match (self.bodies.0.below(a.node), self.bodies.1.below(b.node)) {
            (Below::Primitive(i), Below::Primitive(j)) => {
                let balls = self.balls([i, j], sides);
                let free = self.free_until(&balls, time, sides);
                return match free {
                    Some(free) if free == time => self.list_tests([i, j], time, sides),
                    Some(free) => {
                        self.heap.push(Entry::primitives(free, [i, j]));
                        true
                    }
                    None => true,
                };
            }
            (Below::Nodes(i, j), other) if a.radius >= b.radius || !splits(other) => {
                for child in [i, j] {
                    let swept = sides[0].sweep(child, self.bodies.0.bound(child));
                    self.push([swept, b], start, end);
                }
            }
            (_, Below::Nodes(i, j)) => {
                for child in [i, j] {
                    let swept = sides[1].sweep(child, self.bodies.1.bound(child));
                    self.push([a, swept], start, end);
                }
            }
            // The guard above takes every pair with nodes on the left and none on the right.
            (Below::Nodes(..), Below::Primitive(_)) => {}
        }
        true
    }

    fn spheres(&self, [i, j]: [u32; 2]) -> [(Spheres, Share); 2] {
        let local = |s: MedialSphere| (Vec3::from_vector(s.center), f64::from(s.radius));
        let (a, share_a) = self.bodies.0.primitive(i);
        let (b, share_b) = self.bodies.1.primitive(j);
        [(a.map(local), share_a), (b.map(local), share_b)]
    }

    fn balls(&self, pair: [u32; 2], sides: &[Piece; 2]) -> [Balls; 2] {
        let [(a, share_a), (b, share_b)] = self.spheres(pair);
        [
            sides[0].balls(&a[..share_a.spheres]),
            sides[1].balls(&b[..share_b.spheres]),
        ]
    }

    /// Until when directions prove two primitives free from `time` on; `None` if as long as the
    /// search asks.
    fn free_until(&self, balls: &[Balls; 2], time: f64, sides: &[Piece; 2]) -> Option<f64> {
        let [start, end] = sides[0].times;
        let length = end - start;
        let until = (self.earliest.upper.min(end) - start) / length;
        let from = (time - start) / length;
        let free = free_until(balls, from, until, self.reach);
        if free <= from {
            return Some(time);
        }
        (free < until).then(|| (start + free * length * (1.0 - 4.0 * f64::EPSILON)).max(time))
    }

    /// Lists the elementary tests of two primitives that are free until `time`; returns whether an
    /// earlier contact is still possible.
    fn list_tests(&mut self, pair: [u32; 2], time: f64, sides: &[Piece; 2]) -> bool {
        let [(sa, share_a), (sb, share_b)] = self.spheres(pair);
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
        let balls = self.balls(pair, sides);
        for_each_test(shares[0], shares[1], |test| {
            let some = [
                balls[0].only(test.corners.map(|c| c.0)),
                balls[1].only(test.corners.map(|c| c.1)),
            ];
            if let Some(free) = self.free_until(&some, time, sides) {
                let open = Open {
                    primitives: pair,
                    test,
                    target,
                    spent: 0,
                };
                self.heap.push(Entry::test(free, open));
            }
            true
        });
        true
    }

    /// Takes one test further, until it is settled or another candidate may come first; returns
    /// whether an earlier contact is still possible.
    fn advance(&mut self, mut open: Open, time: f64) -> bool {
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
        self.heap.push(Entry::test(bracket.lower, open));
        true
    }

    fn path(&self, test: &ElementaryTest, pair: [u32; 2], target: f64) -> RigidPath<f64> {
        let [(a, _), (b, _)] = self.spheres(pair);
        RigidPath::new(test, &self.motions, target, |second, k| {
            if second { b[k as usize] } else { a[k as usize] }
        })
    }

    /// Finds the nearest sphere pair of the primitives that meet first.
    fn settle(&mut self) {
        let Some((_, _, pair)) = self.earliest.found else {
            return;
        };
        let counts = self.spheres(pair).map(|(_, share)| share.spheres);
        let mut earliest = self.earliest;
        earliest.settle(counts, |test| self.path(test, pair, self.target));
        self.earliest = earliest;
    }
}

fn splits(below: Below) -> bool {
    matches!(below, Below::Nodes(..))
}
