//! When bodies without any thickness have surely met.
//!
//! Their distance is never below 0, which rounding cannot tell from a little above. But on which side of each other
//! they are it can tell, by the sign of a product of three differences of corners:
//!
//! - An edge whose ends are on the two sides of a triangle, and whose line has all its sides on one side, is in it.
//! - Two edges whose lines, seen along the normal of both, cross inside of both are on one side of each other or
//!   the other, and so are a corner and a triangle inside of which it is, seen along its normal. If that side
//!   changes while they stay inside, they met in between.

use super::motion::Paths;
use nalgebra::Vector3;

/// Edges of a body of so many corners.
const EDGES: [&[[usize; 2]]; 4] = [&[], &[], &[[0, 1]], &[[0, 1], [1, 2], [2, 0]]];

/// Shortest time before and after a moment in which a change is looked for, as a fraction of the step; then twice
/// that, and so on.
const SHORTEST: f64 = 1.0e-13;

/// Rounding of a difference of corners, in units of [`Paths::rounding`], with a margin.
const DOUBT: f64 = 8.0;

/// A moment by which two bodies without thickness have surely met, where they first come as near as rounding
/// can tell at the time `near`: as soon after the meeting as can be proven, and `None` where nothing can.
pub fn met_by(paths: &Paths, near: f64) -> Option<f64> {
    let moment = |time: f64| Moment::new(paths, time);
    let pierced = soonest(near, |time| moment(time).is_pierced());
    let changed = features(paths.counts()).filter_map(|features| {
        let side = |time: f64| moment(time).side(features);
        let before = spans().find_map(|span| side((near - span).max(0.0)))?;
        let other = |time: f64| side(time).filter(|s| s.positive != before.positive);
        let after = soonest(near, |time| other(time).is_some())?;
        let inside = other(after)?.stayed_inside(&before);
        inside.then_some(after)
    });
    changed.chain(pierced).reduce(f64::min)
}

fn spans() -> impl Iterator<Item = f64> {
    let twice = |span: &f64| Some(2.0 * span).filter(|span| *span < 2.0);
    std::iter::successors(Some(SHORTEST), twice)
}

/// A moment at or after `near` at which something is sure that is not before, as far as halving tells.
fn soonest(near: f64, sure: impl Fn(f64) -> bool) -> Option<f64> {
    if sure(near) {
        return Some(near);
    }
    let (mut low, mut high) = (
        near,
        spans()
            .map(|span| (near + span).min(1.0))
            .find(|t| sure(*t))?,
    );
    while low.max(f64::MIN_POSITIVE).next_up() < high {
        let middle = low + 0.5 * (high - low);
        if sure(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(high)
}

/// What may pass each other.
#[derive(Clone, Copy, Debug)]
enum Features {
    /// An edge of each body.
    Edges([[usize; 2]; 2]),
    /// A corner of one and the triangle of the other body.
    Corner { of: usize, corner: usize },
}

fn features(counts: [usize; 2]) -> impl Iterator<Item = Features> {
    let [a, b] = counts.map(|count| EDGES[count]);
    let edges = a
        .iter()
        .flat_map(move |&a| b.iter().map(move |&b| Features::Edges([a, b])));
    let facing = [0, 1].into_iter().filter(move |of| counts[1 - of] == 3);
    let corner = |of, corner| Features::Corner { of, corner };
    edges.chain(facing.flat_map(move |of| (0..counts[of]).map(move |k| corner(of, k))))
}

/// On which side two features are of each other.
#[derive(Clone, Copy, Debug)]
struct Side {
    positive: bool,
    /// Shares of the corners in the place where they cross, seen along the normal: all are positive inside.
    shares: [f64; 4],
}

impl Side {
    /// Whether the place where they cross was inside all the time, by a margin of twice the way that it made.
    fn stayed_inside(&self, before: &Self) -> bool {
        let pairs = before.shares.iter().zip(self.shares);
        pairs
            .into_iter()
            .all(|(a, b)| a.min(b) > 2.0 * (a - b).abs() + f64::EPSILON.sqrt())
    }
}

/// All corners at a time.
struct Moment {
    counts: [usize; 2],
    /// Corners of the first body less those of the second.
    differences: Vec<Vector3<f64>>,
    rounding: f64,
}

impl Moment {
    fn new(paths: &Paths, time: f64) -> Self {
        Self {
            counts: paths.counts(),
            differences: paths.at(time).centers().to_vec(),
            rounding: DOUBT * paths.rounding(),
        }
    }

    /// A corner of body `of` less one of the other.
    fn between(&self, of: usize, own: usize, others: usize) -> Vector3<f64> {
        match of {
            0 => self.differences[own * self.counts[1] + others],
            _ => -self.differences[others * self.counts[1] + own],
        }
    }

    /// Whether `x·(y × z)` is positive, where rounding leaves no doubt.
    fn is_positive(&self, x: Vector3<f64>, y: Vector3<f64>, z: Vector3<f64>) -> Option<bool> {
        let normal = y.cross(&z);
        let product = x.dot(&normal);
        let doubt = self.rounding * (normal.norm() + x.norm() * (y.norm() + z.norm()));
        (product.abs() > doubt).then_some(product > 0.0)
    }

    /// Whether an edge of one body is in the triangle of the other.
    fn is_pierced(&self) -> bool {
        let facing = [0, 1].into_iter().filter(|of| self.counts[1 - of] == 3);
        let mut edges = facing.flat_map(|of| EDGES[self.counts[of]].iter().map(move |e| (of, *e)));
        edges.any(|(of, [a, b])| {
            let [a, b] = [a, b].map(|own| [0, 1, 2].map(|k| self.between(of, own, k)));
            let (u, v, along) = (a[0] - a[1], a[0] - a[2], b[0] - a[0]);
            let ends = [a[0], b[0]].map(|end| self.is_positive(end, u, v));
            let sides = [[0, 1], [1, 2], [2, 0]].map(|[j, k]| self.is_positive(along, a[j], a[k]));
            let opposite = matches!(ends, [Some(a), Some(b)] if a != b);
            opposite && sides[0].is_some() && sides.iter().all(|s| *s == sides[0])
        })
    }

    /// On which side two features are, where rounding leaves no doubt.
    fn side(&self, features: Features) -> Option<Side> {
        // Two spans from a common corner, and `w` from there to the other feature, less what lies in their plane.
        let (u, v, w, shares) = match features {
            Features::Edges([[a, b], [c, d]]) => {
                let w = self.between(0, a, c);
                let (u, v) = (self.between(0, b, c) - w, w - self.between(0, a, d));
                let [t, s] = in_plane(w, u, v);
                (u, v, w - u * s - v * t, [-s, 1.0 + s, t, 1.0 - t])
            }
            Features::Corner { of, corner } => {
                let at = [0, 1, 2].map(|k| self.between(of, corner, k));
                let (u, v) = (at[0] - at[1], at[0] - at[2]);
                let [t, s] = in_plane(at[0], u, v);
                (u, v, at[0] - u * s - v * t, [s, t, 1.0 - s - t, 1.0])
            }
        };
        let positive = self.is_positive(w, u, v)?;
        Some(Side { positive, shares })
    }
}

/// The shares of `v` and `u` in `w`, seen along their normal.
fn in_plane(w: Vector3<f64>, u: Vector3<f64>, v: Vector3<f64>) -> [f64; 2] {
    let normal = u.cross(&v);
    let square = normal.norm_squared();
    [
        u.cross(&w).dot(&normal) / square,
        w.cross(&v).dot(&normal) / square,
    ]
}
