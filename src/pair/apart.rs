//! How long one direction after another keeps two primitives apart, on chords of their paths: the
//! cheap bound that decides which primitives are worth an elementary test.

use crate::math::lane::Vec3;

/// Spheres of one primitive, or of one side of an elementary test, over a piece: position at the
/// start, chord, and radius grown by the sagitta. The unused rest has no meaning.
#[derive(Clone, Copy)]
pub(super) struct Balls {
    pub(super) spheres: [(Vec3<f64>, Vec3<f64>, f64); 3],
    pub(super) len: usize,
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

    fn all(&self) -> &[(Vec3<f64>, Vec3<f64>, f64)] {
        &self.spheres[..self.len]
    }

    /// Two edges at a time; of no length where there are none.
    fn edges(&self, t: f64) -> [Vec3<f64>; 2] {
        let at = |k: usize| {
            let s = &self.spheres[k.min(self.len - 1)];
            s.0 + s.1 * t
        };
        [at(1) - at(0), at(2) - at(0)]
    }

    /// Where each ball ends along `n` at `t`, on its far side (`sign` 1) or its near side (−1), and
    /// how fast that changes; the last ball again where there are fewer than three.
    fn along(&self, n: Vec3<f64>, t: f64, sign: f64) -> [(f64, f64); 3] {
        std::array::from_fn(|k| {
            let (center, chord, radius) = &self.spheres[k.min(self.len - 1)];
            let rate = n.dot(*chord);
            (n.dot(*center) + rate * t + sign * radius, rate)
        })
    }

    fn middle(&self, t: f64) -> Vec3<f64> {
        let sum = (self.all().iter()).fold(Vec3::zero(), |m, s| m + s.0 + s.1 * t);
        sum * (1.0 / self.len as f64)
    }
}

/// Most directions that [`free_until`] tries one after another. More cost as much as they save.
const ROUNDS: usize = 3;

/// Fraction of the piece, from `from` to `until`, up to which directions prove two primitives free.
/// Along chords a direction's bound is concave and piecewise linear in time
/// ([`crate::elementary::certificate`]): its first root follows from those of all sphere pairs.
/// Where one direction ends the next begins. It spares most primitives their elementary tests.
pub(super) fn free_until(balls: [&Balls; 2], from: f64, until: f64, target: f64) -> f64 {
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
        let mut attempt = |n: Vec3<f64>| {
            let length = n.length();
            if length > 0.0 {
                next = next.max(holds(balls, n * (1.0 / length), free, least));
            }
            next >= until
        };
        let y = b.middle(free) - a.middle(free);
        let later = |t: f64| b.middle(t) - a.middle(t);
        if attempt(y)
            || attempt(later(0.5 * (free + until)))
            || attempt(later(until))
            || across(a.edges(free), b.edges(free), y)
                .into_iter()
                .flatten()
                .any(&mut attempt)
        {
            return until;
        }
        if next <= free {
            break;
        }
        free = next;
    }
    free
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

/// Until when all of the second primitive stays further than `least` beyond all of the first along
/// `n`, if it does at `from`; else `from`.
fn holds([a, b]: [&Balls; 2], n: Vec3<f64>, from: f64, least: f64) -> f64 {
    let far = a.along(n, from, 1.0);
    let near = b.along(n, from, -1.0);
    let highest = far.iter().fold(f64::MIN, |m, s| m.max(s.0));
    let lowest = near.iter().fold(f64::MAX, |m, s| m.min(s.0));
    // Also where it is not a number.
    if !(lowest - highest > least) {
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
}
