//! How long one direction after another keeps two primitives apart, on chords of their paths: the
//! cheap bound that decides which primitives are worth an elementary test.

use crate::math::lane::Vec3;

/// Centre at the start of the piece, chord, and radius grown by the sagitta.
type Ball = (Vec3<f64>, Vec3<f64>, f64);

/// Spheres of one primitive, or of one side of an elementary test, over a piece: position at the
/// start, chord, and radius grown by the sagitta; the last again where there are fewer than three.
#[derive(Clone, Copy)]
pub(super) struct Balls {
    spheres: [Ball; 3],
    len: usize,
}

impl Balls {
    /// One to three of them.
    pub(super) fn new(balls: impl ExactSizeIterator<Item = Ball>) -> Self {
        let len = balls.len();
        let mut spheres = [(Vec3::zero(), Vec3::zero(), 0.0); 3];
        for (k, ball) in balls.enumerate() {
            spheres[k..].fill(ball);
        }
        Self { spheres, len }
    }

    /// Those of the given spheres, each once.
    pub(super) fn only(&self, corners: [u8; 4]) -> Self {
        let mut some = *self;
        some.len = 0;
        for (k, i) in corners.into_iter().enumerate() {
            if !corners[..k].contains(&i) {
                some.spheres[some.len..].fill(self.spheres[i as usize]);
                some.len += 1;
            }
        }
        some
    }

    fn all(&self) -> &[Ball] {
        &self.spheres[..self.len]
    }

    /// Two edges at a time; of no length where there are none.
    fn edges(&self, t: f64) -> [Vec3<f64>; 2] {
        let at = |k: usize| {
            let s = &self.spheres[k];
            s.0 + s.1 * t
        };
        [at(1) - at(0), at(2) - at(0)]
    }

    /// Where each ball ends along `n` at `t`, on its far side (`sign` 1) or its near side (−1), and
    /// how fast that changes.
    fn along(&self, n: Vec3<f64>, t: f64, sign: f64) -> [(f64, f64); 3] {
        self.spheres.map(|(center, chord, radius)| {
            let rate = n.dot(chord);
            (n.dot(center) + rate * t + sign * radius, rate)
        })
    }

    /// Bound of the coordinates in play.
    fn size(&self) -> f64 {
        let reach = |v: Vec3<f64>| v.x.abs() + v.y.abs() + v.z.abs();
        let one = |(center, chord, radius): &Ball| reach(*center) + reach(*chord) + radius;
        self.all().iter().map(one).sum()
    }

    fn middle(&self, t: f64) -> Vec3<f64> {
        let sum = (self.all().iter()).fold(Vec3::zero(), |m, s| m + s.0 + s.1 * t);
        sum * (1.0 / self.len as f64)
    }
}

/// Part of the time asked for that ends the search for a better direction: the primitives wait, and
/// most are never asked about again. At 1 approaches take a tenth longer, fast queries the same.
const ENOUGH: f64 = 0.1;

/// Fraction of the piece, from `from` to `until`, up to which directions prove two primitives free.
/// Along chords a direction's bound is concave and piecewise linear in time
/// ([`crate::elementary::certificate`]): its first root follows from those of all sphere pairs.
/// The middles now and later give directions first, then edges and normals.
///
/// What comes within `tolerance` of the target and no nearer may be called free, but not for a while:
/// where primitives come within the tolerance, their tests begin, and say that they touch.
pub(super) fn free_until(balls: [&Balls; 2], span: [f64; 2], target: f64, tolerance: f64) -> f64 {
    let ([a, b], [from, until]) = (balls, span);
    // Rounding: a few ulps of the numbers in play.
    let least = target + 64.0 * f64::EPSILON * (a.size() + b.size());
    let mut free = from;
    let enough = from + ENOUGH * (until - from);
    let mut attempt = |n: Vec3<f64>| {
        let length = n.length();
        if length > 0.0 {
            free = free.max(holds(
                balls,
                n * (1.0 / length),
                span,
                least,
                least + tolerance,
            ));
        }
        free >= enough
    };
    let toward = |t: f64| b.middle(t) - a.middle(t);
    let y = toward(from);
    let _ = attempt(y)
        || attempt(toward(0.5 * (from + until)))
        || attempt(toward(until))
        || across(a.edges(from), b.edges(from), y)
            .into_iter()
            .flatten()
            .any(attempt);
    free.min(until)
}

/// Directions near `y` that the shapes themselves suggest: across the edges of either, across one
/// edge of both, and the normals of slabs.
fn across(a: [Vec3<f64>; 2], b: [Vec3<f64>; 2], y: Vec3<f64>) -> [Option<Vec3<f64>>; 5] {
    let beside = |e: Vec3<f64>| {
        let ee = e.length_sq();
        (ee > 0.0).then(|| y - e * (e.dot(y) / ee))
    };
    let normal = |e: Vec3<f64>, f: Vec3<f64>| {
        let n = e.cross(f);
        (n.length_sq() > 0.0).then(|| if n.dot(y) < 0.0 { -n } else { n })
    };
    [
        beside(a[0]),
        beside(b[0]),
        normal(a[0], b[0]),
        normal(a[0], a[1]),
        normal(b[0], b[1]),
    ]
}

/// Until when all of the second primitive stays beyond all of the first along `n`: `until` where it
/// is further than `least` for so long, else as long as it is further than `contact`; `from` if it
/// is not.
fn holds([a, b]: [&Balls; 2], n: Vec3<f64>, span: [f64; 2], least: f64, contact: f64) -> f64 {
    let [from, until] = span;
    let far = a.along(n, from, 1.0);
    let near = b.along(n, from, -1.0);
    let highest = far.iter().fold(f64::MIN, |m, s| m.max(s.0));
    let lowest = near.iter().fold(f64::MAX, |m, s| m.min(s.0));
    let end = |least: f64| {
        if lowest - highest <= least {
            return from;
        }
        let mut step = f64::MAX;
        for (far, far_rate) in far {
            for (near, near_rate) in near {
                let closing = far_rate - near_rate;
                if closing > 0.0 {
                    step = step.min((near - far - least) / closing);
                }
            }
        }
        // Rounding of the division and the sum.
        from + step * (1.0 - 8.0 * f64::EPSILON)
    };
    if end(least) >= until {
        until
    } else {
        end(contact)
    }
}
