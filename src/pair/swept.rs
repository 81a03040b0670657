//! Nodes and primitives swept over a piece of the step: chords of their centres with radii that cover
//! the sagitta, and the order in which the search of [`super::first_contact`] takes them.

use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::math::{Real, Vector};
use std::cmp::Ordering;

/// Chord of a node's centre over a piece, and the radius around it that covers the node.
#[derive(Clone, Copy)]
pub(super) struct Swept {
    pub(super) node: u32,
    pub(super) start: Vec3<f64>,
    pub(super) chord: Vec3<f64>,
    pub(super) radius: f64,
}

/// A node pair, ordered by the time at which it may first meet; of several that overlap already,
/// the one that overlaps deepest for its size comes first.
pub(super) struct Entry {
    pub(super) time: f64,
    /// Signed distance of the two balls at the start of the piece, in units of their radii.
    pub(super) depth: f64,
    pub(super) nodes: [Swept; 2],
}

impl Entry {
    pub(super) fn key(&self) -> (f64, f64, u32, u32) {
        (
            self.time,
            self.depth,
            self.nodes[0].node,
            self.nodes[1].node,
        )
    }
}
impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Entry {}
impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Entry {
    /// Reversed: `BinaryHeap` pops the largest.
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b) = (self.key(), other.key());
        b.0.total_cmp(&a.0)
            .then(b.1.total_cmp(&a.1))
            .then((b.2, b.3).cmp(&(a.2, a.3)))
    }
}

/// One side's motion over a piece of the step.
pub(super) struct Piece {
    motion: RigidMotion<f64>,
    pub(super) times: [f64; 2],
    turned: [(f64, f64); 2],
}

impl Piece {
    pub(super) fn new(motion: RigidMotion<f64>, start: f64, end: f64) -> Self {
        Self {
            motion,
            times: [start, end],
            turned: [motion.sin_cos(start), motion.sin_cos(end)],
        }
    }

    pub(super) fn balls(&self, spheres: &[(Vec3<f64>, f64)]) -> Balls {
        let mut balls = Balls {
            spheres: [(Vec3::zero(), Vec3::zero(), 0.0); 3],
            len: spheres.len(),
        };
        for (ball, (center, radius)) in balls.spheres.iter_mut().zip(spheres) {
            let (from, chord, sagitta) = self.chord(*center);
            *ball = (from, chord, radius + sagitta);
        }
        balls
    }

    /// Position of a point at the start of the piece, the chord of its path, and the sagitta.
    fn chord(&self, local: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, f64) {
        let path = self.motion.point(local);
        let [from, to] = [0, 1].map(|k| path.at(self.times[k], self.turned[k]).position);
        let length = self.times[1] - self.times[0];
        (from, to - from, path.acceleration * (length * length) / 8.0)
    }

    pub(super) fn sweep(&self, node: u32, (center, radius): (Vector, Real)) -> Swept {
        let (start, chord, sagitta) = self.chord(Vec3::from_vector(center));
        Swept {
            node,
            start,
            chord,
            radius: f64::from(radius) + sagitta,
        }
    }
}

/// Spheres of one primitive over a piece: position at the start, chord, and radius grown by the
/// sagitta. The unused rest has no meaning.
#[derive(Clone, Copy)]
pub(super) struct Balls {
    spheres: [(Vec3<f64>, Vec3<f64>, f64); 3],
    len: usize,
}

/// Whether one direction proves two primitives free up to the fraction `until` of the piece: along
/// chords its bound is concave and piecewise linear in time ([`crate::elementary::certificate`]),
/// so both ends suffice. It spares most leaf pairs their elementary tests.
pub(super) fn apart_until(balls: &[Balls; 2], until: f64, target: f64) -> bool {
    let [a, b] = balls.each_ref().map(|side| &side.spheres[..side.len]);
    let middle = |side: &[(Vec3<f64>, Vec3<f64>, f64)], t: f64| {
        let sum = side.iter().fold(Vec3::zero(), |m, s| m + s.0 + s.1 * t);
        sum * (1.0 / side.len() as f64)
    };
    let gap = |n: Vec3<f64>, t: f64| {
        let near = b.iter().map(|s| n.dot(s.0 + s.1 * t) - s.2);
        let far = a.iter().map(|s| n.dot(s.0 + s.1 * t) + s.2);
        near.fold(f64::MAX, f64::min) - far.fold(f64::MIN, f64::max)
    };
    [0.0, 0.5 * until, until].into_iter().any(|t| {
        let y = middle(b, t) - middle(a, t);
        let length = y.length();
        if length <= 0.0 {
            return false;
        }
        let n = y * (1.0 / length);
        // Rounding: a few ulps of the numbers in play.
        let size = length + (b[0].1 - a[0].1).length() + a[0].2 + b[0].2;
        let least = target + 64.0 * f64::EPSILON * size;
        gap(n, 0.0) > least && gap(n, until) > least
    })
}
