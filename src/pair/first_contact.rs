//! First contact of two bodies made of primitives, in exact rigid motion: best-first over their
//! trees. The paper (§4.1) tests all pairs; this visits the few that can come first.
//!
//! A node's ball keeps its radius under any rotation; its centre stays within the sagitta
//! `A/8` of its chord ([`crate::math::motion`]), so two nodes cannot meet before the balls, grown by
//! both sagittas and moved along the chords, do: the smaller root of a quadratic. Node pairs are
//! expanded in the order of that time, and the search ends when the next one lies after the best
//! contact found. A fast turn is searched in pieces, so that sagittas stay small.

use super::apart::{Balls, free_until};
use super::queue::{Candidate, Entry, Open};
use super::swept::Side;
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
        sides: (Side::new(body1, motions[0]), Side::new(body2, motions[1])),
        motions,
        times: [0.0, 1.0],
        target,
        reach: match options.initial_contact {
            InitialContact::Stop => target.max(0.0),
            InitialContact::Deepen { .. } => target,
        },
        initial_contact: options.initial_contact,
        heap: BinaryHeap::new(),
        open: Vec::new(),
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
    sides: (Side<'a, A>, Side<'a, B>),
    motions: [RigidMotion<f64>; 2],
    /// Start and end of the piece searched.
    times: [f64; 2],
    target: f64,
    /// What culling goes by: no primitive pair has a larger target, raised or not.
    reach: f64,
    initial_contact: InitialContact,
    heap: BinaryHeap<Entry>,
    /// Elementary tests that are not settled.
    open: Vec<Open>,
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
        self.times = [start, end];
        self.sides.0.begin(start, end);
        self.sides.1.begin(start, end);
        self.heap.clear();
        self.open.clear();
        for i in 0..self.sides.0.body.roots() {
            for j in 0..self.sides.1.body.roots() {
                self.push([i, j]);
            }
        }
        while let Some(entry) = self.heap.pop() {
            if entry.time > self.earliest.upper.min(end) {
                break;
            }
            let open = match entry.candidate {
                Candidate::Nodes(nodes) => self.expand(nodes, entry.time),
                Candidate::Leaves(leaves) => self.list_tests(leaves, entry.time),
                Candidate::Test(index) => self.advance(index, entry.time),
            };
            if !open {
                return false;
            }
        }
        self.earliest.status == ToiStatus::Separated
    }

    /// Queues two swept nodes at the time at which their balls meet, if they do in this piece.
    fn push(&mut self, nodes: [u32; 2]) {
        self.counts.nodes += 1;
        let (a, b) = (self.sides.0.node(nodes[0]), self.sides.1.node(nodes[1]));
        let y = b.start - a.start;
        let rate = b.chord - a.chord;
        let radius = a.radius + b.radius + self.reach;
        // Rounding of positions, chords and the root: a few ulps of the numbers in play.
        let size = y.x.abs() + y.y.abs() + y.z.abs() + rate.x.abs() + rate.y.abs() + rate.z.abs();
        let radius = (radius + 64.0 * f64::EPSILON * (size + radius.abs())).max(0.0);
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
            self.heap.push(Entry {
                time,
                depth,
                candidate: Candidate::Nodes(nodes),
            });
        }
    }

    /// Replaces two nodes by what is below the larger; two primitives wait until directions no
    /// longer keep them apart. Returns whether an earlier contact is still possible.
    fn expand(&mut self, [i, j]: [u32; 2], time: f64) -> bool {
        let (a, b) = (self.sides.0.node(i), self.sides.1.node(j));
        if let (Below::Primitive(p), Below::Primitive(q)) = (a.below, b.below) {
            let places = [self.sides.0.sweep_leaf(i, p), self.sides.1.sweep_leaf(j, q)];
            let balls = [self.sides.0.balls(places[0]), self.sides.1.balls(places[1])];
            return match self.free_until(balls, time) {
                Some(free) if free == time => self.list_tests([i, j], time),
                Some(free) => {
                    let leaves = Candidate::Leaves([i, j]);
                    self.heap.push(Entry::at(free, leaves));
                    true
                }
                None => true,
            };
        }
        let first_larger = a.radius >= b.radius;
        let splits_second = matches!(b.below, Below::Nodes(..));
        let first = if first_larger || !splits_second {
            self.sides.0.split(i)
        } else {
            None
        };
        if let Some(children) = first {
            children.into_iter().for_each(|c| self.push([c, j]));
        } else if let Some(children) = self.sides.1.split(j) {
            children.into_iter().for_each(|c| self.push([i, c]));
        }
        true
    }

    fn spheres(&self, [i, j]: [u32; 2]) -> [(Spheres, Share); 2] {
        let local = |s: MedialSphere| (Vec3::from_vector(s.center), f64::from(s.radius));
        let (a, share_a) = self.sides.0.body.primitive(i);
        let (b, share_b) = self.sides.1.body.primitive(j);
        [(a.map(local), share_a), (b.map(local), share_b)]
    }

    /// Until when directions prove two primitives free from `time` on; `None` if as long as the
    /// search asks.
    fn free_until(&self, balls: [&Balls; 2], time: f64) -> Option<f64> {
        let [start, end] = self.times;
        let length = end - start;
        let until = (self.earliest.upper.min(end) - start) / length;
        let from = (time - start) / length;
        let free = free_until(balls, from, until, self.reach);
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
        let places = [self.sides.0.sweep_leaf(i, p), self.sides.1.sweep_leaf(j, q)];
        let balls = [self.sides.0.balls(places[0]), self.sides.1.balls(places[1])].map(|b| *b);
        for_each_test(shares[0], shares[1], |test| {
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
                self.heap.push(Entry::at(free, place));
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
        (self.heap).push(Entry::at(bracket.lower, Candidate::Test(place)));
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
