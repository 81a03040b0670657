//! Nodes and primitives swept over a piece of the step: chords of their centres with radii that cover
//! the sagitta, and how long one direction after another keeps two primitives apart.

use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::math::{Real, Vector};

/// Chord of a node's centre over a piece, and the radius around it that covers the node.
#[derive(Clone, Copy)]
pub(super) struct Swept {
    pub(super) node: u32,
    pub(super) start: Vec3<f64>,
    pub(super) chord: Vec3<f64>,
    pub(super) radius: f64,
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

/// Spheres of one primitive, or of one side of an elementary test, over a piece: position at the
/// start, chord, and radius grown by the sagitta. The unused rest has no meaning.
#[derive(Clone, Copy)]
pub(super) struct Balls {
    spheres: [(Vec3<f64>, Vec3<f64>, f64); 3],
    len: usize,
}

impl Balls {
    /// Those of the given spheres, each once.
    pub(super) fn only(&self, corners: [u8; 4]) -> Self {
        let mut some = Self { len: 0, ..*self };
        for (k, i) in corners.into_iter().enumerate() {
            if !corners[..k].contains(&i) {
                some.spheres[some.len] = self.spheres[i as usize];
                some.len += 1;
            }
        }
        some
    }

    fn spheres(&self) -> &[(Vec3<f64>, Vec3<f64>, f64)] {
        &self.spheres[..self.len]
    }

    fn middle(&self, t: f64) -> Vec3<f64> {
        let sum = (self.spheres().iter()).fold(Vec3::zero(), |m, s| m + s.0 + s.1 * t);
        sum * (1.0 / self.len as f64)
    }
}

/// Most directions that [`free_until`] tries one after another. More cost as much as they save.
const ROUNDS: usize = 3;

/// Fraction of the piece, from `from` to `until`, up to which directions prove two primitives free.
/// Along chords a direction's bound is concave and piecewise linear in time
/// ([`crate::elementary::certificate`]): its first root follows from those of all sphere pairs.
/// Where one direction ends the next begins. It spares most primitives their elementary tests.
pub(super) fn free_until(balls: &[Balls; 2], from: f64, until: f64, target: f64) -> f64 {
    let [a, b] = balls;
    // Rounding: a few ulps of the numbers in play.
    let size = |s: &Balls| {
        let (c, chord, r) = s.spheres[0];
        c.length() + chord.length() + r
    };
    let least = target + 64.0 * f64::EPSILON * (size(a) + size(b));
    let mut free = from;
    for _ in 0..ROUNDS {
        let mut next = free;
        for t in [free, 0.5 * (free + until), until] {
            let y = b.middle(t) - a.middle(t);
            let length = y.length();
            if length > 0.0 {
                next = next.max(holds(balls, y * (1.0 / length), free, least));
            }
            if next >= until {
                return until;
            }
        }
        if next <= free {
            break;
        }
        free = next;
    }
    free
}

/// Until when all of the second primitive stays further than `least` beyond all of the first along
/// `n`, if it does at `from`; else `from`.
fn holds([a, b]: &[Balls; 2], n: Vec3<f64>, from: f64, least: f64) -> f64 {
    let along = |s: &(Vec3<f64>, Vec3<f64>, f64)| {
        let rate = n.dot(s.1);
        (n.dot(s.0) + rate * from, rate)
    };
    let mut step = f64::MAX;
    for s in a.spheres() {
        let (far, far_rate) = along(s);
        for r in b.spheres() {
            let (near, near_rate) = along(r);
            let gap = near - r.2 - (far + s.2) - least;
            let rate = near_rate - far_rate;
            // Also where it is not a number.
            if !(gap > 0.0 && rate.is_finite()) {
                return from;
            }
            if rate < 0.0 {
                step = step.min(gap / -rate);
            }
        }
    }
    // Rounding of the division and the sum.
    from + step * (1.0 - 8.0 * f64::EPSILON)
}
