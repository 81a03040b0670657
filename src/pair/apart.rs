//! How long two primitives are certainly apart, because one direction after another separates them while they move
//! along the chords of their paths. This cheap bound decides which primitives are worth an elementary test.

use crate::math::lane::Vec3;

/// Centre at the start of the piece, chord, and radius grown by the sagitta.
type Ball = (Vec3<f64>, Vec3<f64>, f64);

/// Spheres of one primitive, or of one side of an elementary test, over a piece: position at the
/// start, chord, and radius grown by the sagitta; the last again where there are fewer than three.
#[derive(Clone, Copy)]
pub(super) struct Balls {
    spheres: [Ball; 3],
    len: usize,
    /// Bound of the coordinates in play.
    size: f64,
}

impl Balls {
    /// One to three of them; `terms`: sizes of the numbers that their positions are sums of, beyond those.
    pub(super) fn new(balls: impl ExactSizeIterator<Item = Ball>, terms: f64) -> Self {
        let len = balls.len();
        let mut spheres = [(Vec3::zero(), Vec3::zero(), 0.0); 3];
        let mut size = terms;
        for (k, ball) in balls.enumerate() {
            spheres[k..].fill(ball);
            size += ball.0.taxicab() + ball.1.taxicab() + ball.2;
        }
        Self { spheres, len, size }
    }

    /// The same with radii less these.
    pub(super) fn less(mut self, losses: [f64; 3]) -> Self {
        for (sphere, loss) in self.spheres.iter_mut().zip(losses) {
            sphere.2 -= loss;
        }
        self
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

    /// Where each ball ends along `n` at the start of the piece, and how fast that changes, in units of
    /// the length of `n`: on its far side where `length` is that, on its near side where it is the
    /// negative of that.
    fn along(&self, n: Vec3<f64>, length: f64) -> [(f64, f64); 3] {
        self.spheres
            .map(|(center, chord, radius)| (n.dot(center) + length * radius, n.dot(chord)))
    }

    fn middle(&self, t: f64) -> Vec3<f64> {
        let sum = (self.all().iter()).fold(Vec3::zero(), |m, s| m + s.0 + s.1 * t);
        sum * (1.0 / self.len as f64)
    }
}

/// Part of the time asked for that ends the search for a better direction: the primitives wait, and
/// most are never asked about again. At 0.1 fast queries take 3 % longer, at 1 approaches a tenth.
const ENOUGH: f64 = 0.02;

/// Fraction of the piece, from `from` on, up to which directions prove two primitives free; `None`: up to
/// `until`, or at that moment where there is no other.
/// Along chords a direction's bound is concave and piecewise linear in time
/// ([`crate::elementary::certificate`]): its first root follows from those of all sphere pairs.
/// The middles now and later give directions first, then edges and normals.
///
/// What comes within `tolerance` of the target and no nearer may be called free, but not for a while:
/// where primitives come within the tolerance, their tests begin, and say that they touch.
pub(super) fn free_until(
    balls: [&Balls; 2],
    span: [f64; 2],
    target: f64,
    tolerance: f64,
) -> Option<f64> {
    let ([a, b], [from, until]) = (balls, span);
    // Rounding: a few ulps of the numbers in play.
    let least = target + 64.0 * f64::EPSILON * (a.size + b.size);
    let mut free = Some(from);
    let enough = from + ENOUGH * (until - from);
    let mut attempt = |n: Vec3<f64>| {
        let held = holds(balls, n, span, least, least + tolerance);
        free = free.zip(held).map(|(a, b)| a.max(b));
        free.is_none_or(|free| free >= enough && free > from)
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

/// Until when all of the second primitive stays beyond all of the first along `n`, of any length:
/// `None`, for good, where it is further than `least` until the end of the span, else as long as it is
/// further than `contact`; `from` if it is not. In a span without length, where a contact is known already,
/// what is within `contact` may be the nearer one.
fn holds(
    [a, b]: [&Balls; 2],
    n: Vec3<f64>,
    span: [f64; 2],
    least: f64,
    contact: f64,
) -> Option<f64> {
    let [from, until] = span;
    let length = n.length();
    let (least, contact) = (least * length, contact * length);
    let (far, near) = (a.along(n, length), b.along(n, -length));
    // The least distance of two of them: concave in time.
    let gap = |t: f64| {
        let at = |s: &(f64, f64)| s.0 + s.1 * t;
        let highest = far.iter().map(at).fold(f64::MIN, f64::max);
        let lowest = near.iter().map(at).fold(f64::MAX, f64::min);
        lowest - highest
    };
    let now = gap(from);
    let enough = if from < until { least } else { contact };
    if now > enough && gap(until) > enough {
        return None;
    }
    if now <= contact {
        return Some(from);
    }
    let mut step = until - from;
    for (far, far_rate) in far {
        for (near, near_rate) in near {
            let closing = far_rate - near_rate;
            let room = near - far - closing * from - contact;
            if closing * step > room {
                step = room / closing;
            }
        }
    }
    // Rounding of the division and the sum.
    let free = from + step * (1.0 - 8.0 * f64::EPSILON);
    (free < until).then_some(free)
}
