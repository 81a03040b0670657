//! Proofs that two primitives, or the hulls of two nodes, are apart up to some time while they move along the chords
//! of their paths: one direction after another separates them. This cheap bound decides which primitives are worth an
//! elementary test. Its maths is that of the fixed direction in [`crate::elementary::certificate`]: along a direction
//! the least gap of two sets of spheres is a concave function of time.
//!
//! On a device `stays_free` in `shaders/swept.wgsl` proves the same, with directions found in another way.

use crate::elementary::distance::face;
use crate::elementary::test_list::ElementaryTest;
use crate::math::lane::Vec3;
use crate::math::tolerance::F64_ROUNDING;

/// A ball on its way over a piece of the step: centre at the start, chord, and radius grown by the sagitta.
pub(super) type SweptBall = (Vec3<f64>, Vec3<f64>, f64);

/// Spheres of one primitive, or of one side of an elementary test, over a piece: position at the
/// start, chord, and radius grown by the sagitta; the last again where there are fewer than four.
#[derive(Clone, Copy)]
pub(super) struct Balls {
    spheres: [SweptBall; 4],
    len: usize,
    /// Bound of the coordinates in play.
    pub(super) size: f64,
}

impl Balls {
    /// One to four of them; `terms`: sizes of the numbers that their positions are sums of, beyond those.
    pub(super) fn new(balls: impl ExactSizeIterator<Item = SweptBall>, terms: f64) -> Self {
        let len = balls.len();
        let mut spheres = [(Vec3::zero(), Vec3::zero(), 0.0); 4];
        let mut size = terms;
        for (k, ball) in balls.enumerate() {
            spheres[k..].fill(ball);
            size += ball.0.taxicab() + ball.1.taxicab() + ball.2;
        }
        Self { spheres, len, size }
    }

    /// Balls with radii less these.
    pub(super) fn less(mut self, losses: [f64; 3]) -> Self {
        for (sphere, loss) in self.spheres[..self.len].iter_mut().zip(losses) {
            sphere.2 -= loss;
        }
        self
    }

    /// The balls of the given spheres, each once.
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

    /// How far any sphere of these and any of another primitive may travel against each other in the piece at most, if
    /// `sagitta` is how far both may be off their chords together.
    pub(super) fn travel(&self, other: &Self, sagitta: f64) -> f64 {
        let ways =
            (self.all().iter()).flat_map(|a| other.all().iter().map(|b| (b.1 - a.1).length_sq()));
        ways.fold(0.0, f64::max).sqrt() + sagitta
    }

    /// The largest radius beyond the given ones: how far centres may be off their chords.
    pub(super) fn sagitta(&self, radii: [f64; 3]) -> f64 {
        let beyond = self.all().iter().zip(radii).map(|(s, radius)| s.2 - radius);
        beyond.fold(0.0, f64::max)
    }

    /// Whether they are those of a slab.
    pub(super) fn is_slab(&self) -> bool {
        self.len == 3
    }

    /// Means of them, with the shares that each has.
    pub(super) fn mixed(&self, means: &[[f64; 3]]) -> Self {
        let mut mixed = *self;
        mixed.len = means.len();
        for (k, shares) in means.iter().enumerate() {
            let none = (Vec3::zero(), Vec3::zero(), 0.0);
            let sum = |sum: SweptBall, (s, share): (&SweptBall, &f64)| {
                (
                    sum.0 + s.0 * *share,
                    sum.1 + s.1 * *share,
                    sum.2 + s.2 * share,
                )
            };
            mixed.spheres[k..].fill(self.spheres.iter().zip(shares).fold(none, sum));
        }
        mixed
    }

    pub(super) fn all(&self) -> &[SweptBall] {
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

    /// The outer normal, of any length, of that face of a slab that looks along `y` at a time; `None` if there is none.
    pub(super) fn face(&self, t: f64, y: Vec3<f64>) -> Option<Vec3<f64>> {
        let [a, b, c, _] = &self.spheres;
        (self.len == 3)
            .then(|| face(self.edges(t), [b.2 - a.2, c.2 - a.2], y))
            .flatten()
    }

    /// The plane of the first three centres at a time.
    pub(super) fn plane(&self, t: f64) -> Plane {
        let edges = self.edges(t);
        let used = [self.len > 1, self.len > 2];
        let inverse = [0, 1].map(|k| match (used[k], edges[k].length_sq()) {
            (true, square) if square > 0.0 => 1.0 / square,
            _ => 0.0,
        });
        let share = [0.0, 0.5, 1.0 / 3.0, 0.5][self.len - 1];
        Plane {
            edges,
            inverse,
            place: used.map(|used| if used { share } else { 0.0 }),
            is_triangle: self.len == 3,
        }
    }

    /// Position at which each ball ends along `n` at the start of the piece, and how fast that changes, in units of the
    /// length of `n`: on its far side where `length` is that, on its near side where it is the negative of that.
    fn along(&self, n: Vec3<f64>, length: f64) -> [(f64, f64); 4] {
        let mut ends = [(0.0, 0.0); 4];
        for (end, ball) in ends.iter_mut().zip(self.all()) {
            *end = end_along(ball, n, length);
        }
        ends
    }

    pub(super) fn middle(&self, t: f64) -> Vec3<f64> {
        let sum = (self.all().iter()).fold(Vec3::zero(), |m, s| m + s.0 + s.1 * t);
        sum * (1.0 / self.len as f64)
    }

    /// Radius of a ball round the middle that is within the hull.
    pub(super) fn core(&self) -> f64 {
        self.all().iter().map(|s| s.2).sum::<f64>() / self.len as f64
    }
}

/// End of a ball along a direction of this length at the start of the piece, and how fast it moves.
pub(super) fn end_along(
    (center, chord, radius): &SweptBall,
    n: Vec3<f64>,
    length: f64,
) -> (f64, f64) {
    (n.dot(*center) + length * radius, n.dot(*chord))
}

/// Part of the time asked for that ends the search for a better direction: the primitives wait, and
/// most are never asked about again. At 0.1 fast queries take 3 % longer, at 1 approaches a tenth.
const ENOUGH: f64 = 0.02;

/// Fraction of the piece, from `from` on, up to which directions prove two primitives free; `None`: up to
/// `until`. If `from` and `until` are one moment: whether they are apart then.
/// Along chords a direction's bound is concave and piecewise linear in time
/// ([`crate::elementary::certificate`]): its first root follows from those of all sphere pairs.
/// The middles now and later give directions first, then edges and normals. Nodes have one direction.
///
/// Nodes that come within `tolerance` of the target and no nearer may be called free, but not for a while: where
/// primitives come within the tolerance, their tests begin, and say that they touch.
pub(super) fn free_until(
    balls: [&Balls; 2],
    span: [f64; 2],
    target: f64,
    tolerance: f64,
) -> Option<f64> {
    let ([a, b], [from, until]) = (balls, span);
    // Rounding: a few ulps of the numbers in play.
    let least = target + F64_ROUNDING * (a.size + b.size);
    // Nodes are split instead of tried along more directions. What is below them may touch, and is told only by
    // tests, so within the tolerance they are not free for good.
    let is_node = a.len > 3 || b.len > 3;
    let free_for_good = if is_node { least + tolerance } else { least };
    let mut free = Some(from);
    let enough = from + ENOUGH * (until - from);
    let mut attempt = |n: Vec3<f64>| {
        let held = holds(balls, n, span, free_for_good, least + tolerance);
        free = free.zip(held).map(|(a, b)| a.max(b));
        free.is_none_or(|free| free >= enough && free > from)
    };
    let y = b.middle(from) - a.middle(from);
    let overlap = a.core() + b.core() + least;
    if overlap > 0.0 && y.length_sq() <= overlap * overlap {
        return free;
    }
    if is_node {
        attempt(between(balls, from, y));
        return free;
    }
    let toward = |t: f64| b.middle(t) - a.middle(t);
    let faces = || [a.face(from, y), b.face(from, -y).map(|n| -n)];
    let _ = attempt(y)
        || faces().into_iter().flatten().any(&mut attempt)
        || attempt(toward(0.5 * (from + until)))
        || attempt(toward(until))
        || across(a.edges(from), b.edges(from), y)
            .into_iter()
            .flatten()
            .any(attempt);
    free
}

/// Fraction of the piece, from `from` on, up to which one direction keeps the hulls of two primitives apart by more
/// than `contact`; `None`: up to `until`.
pub(super) fn held_until(
    balls: [&Balls; 2],
    n: Vec3<f64>,
    span: [f64; 2],
    contact: f64,
) -> Option<f64> {
    let contact = contact + F64_ROUNDING * (balls[0].size + balls[1].size);
    holds(balls, n, span, contact, contact)
}

/// How far the spheres of two primitives reach towards each other along one direction.
pub(super) struct Reach {
    far: [(f64, f64); 4],
    near: [(f64, f64); 4],
    contact: f64,
}

impl Reach {
    /// Along `n`; what comes within `contact` counts as near.
    pub(super) fn new([a, b]: [&Balls; 2], n: Vec3<f64>, contact: f64) -> Self {
        let length = n.length();
        let contact = contact + F64_ROUNDING * (a.size + b.size);
        Self {
            far: a.along(n, length),
            near: b.along(n, -length),
            contact: contact * length,
        }
    }

    /// Whether the spheres of a test are apart between two times.
    pub(super) fn is_apart(&self, test: &ElementaryTest, span: [f64; 2]) -> bool {
        let corners = &test.corners;
        span.iter().all(|t| {
            let at = |s: (f64, f64)| s.0 + s.1 * t;
            let gap = |near: usize, far: usize| at(self.near[near]) - at(self.far[far]);
            (corners.iter()).all(|c| gap(c.1.into(), c.0.into()) > self.contact)
        })
    }
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

/// A point in the plane of a hull's centres, by its shares of two edges.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    edges: [Vec3<f64>; 2],
    /// 1 over the squared lengths; 0 where there is none.
    inverse: [f64; 2],
    place: [f64; 2],
    is_triangle: bool,
}

impl Plane {
    /// Moves the point nearer to another, `y` away, along one edge after the other; returns what is left.
    fn approach(&mut self, mut y: Vec3<f64>) -> Vec3<f64> {
        for k in 0..2 {
            let most = if self.is_triangle {
                1.0 - self.place[1 - k]
            } else {
                1.0
            };
            let step = y.dot(self.edges[k]) * self.inverse[k];
            let place = (self.place[k] + step).min(most).max(0.0);
            y = y - self.edges[k] * (place - self.place[k]);
            self.place[k] = place;
        }
        y
    }
}

/// Times that each side of [`between`] approaches the other.
const ROUNDS: usize = 2;

/// Direction from one of two hulls to the other at a time, about as between the nearest points of the polygons of their
/// centres, found by solving for one parameter after the other. `y`: from middle to middle.
fn between([a, b]: [&Balls; 2], t: f64, y: Vec3<f64>) -> Vec3<f64> {
    approached(a.plane(t), b.plane(t), y)
}

/// Direction between the two, of their planes.
pub(super) fn approached(mut first: Plane, mut second: Plane, mut y: Vec3<f64>) -> Vec3<f64> {
    for _ in 0..ROUNDS {
        y = first.approach(y);
        y = -second.approach(-y);
    }
    y
}

/// Time until which all of the second primitive stays beyond all of the first along `n`, of any length: `None`, for
/// good, where it is further than `least` until the end of the span, else as long as it is further than `contact`;
/// `from` if it is not. In a span without length, where a contact is known already, what is within `contact` may be the
/// nearer one.
fn holds(
    [a, b]: [&Balls; 2],
    n: Vec3<f64>,
    span: [f64; 2],
    least: f64,
    contact: f64,
) -> Option<f64> {
    let length = n.length();
    let (far, near) = (a.along(n, length), b.along(n, -length));
    let ends = [&far[..a.len], &near[..b.len]];
    ends_hold(ends, span, least * length, contact * length)
}

/// Does the same as [`holds`], given the end of each sphere along the direction and its rate. `least` and `contact` are
/// in units of the length of the direction.
pub(super) fn ends_hold(
    [far, near]: [&[(f64, f64)]; 2],
    [from, until]: [f64; 2],
    least: f64,
    contact: f64,
) -> Option<f64> {
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
    for &(far, far_rate) in far {
        for &(near, near_rate) in near {
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
