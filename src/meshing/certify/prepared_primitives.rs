//! A primitive prepared for the distances of many points.
//!
//! The signed distance `|w + α u + β v| − (r + α a + β b)`, with `w` from the point to the first ball,
//! is convex in the weights. So where its stationary point lies in the triangle `α, β ≥ 0`,
//! `α + β ≤ 1`, that is the minimum; else the minimum is on an edge that separates the two. All that
//! does not depend on the point is computed once. Formulas: `math/nearest.rs`, paper §4.2.

use crate::meshing::draft::{Ball, Corners, Signed};
use crate::meshing::geometry::bounds::{Point, direction};

/// Discriminants below this share are those of a ball that contains the other.
const CONTAINED: f64 = 2.0 * f64::EPSILON;

/// Slabs whose centres span a triangle flatter than this (sine of an angle, squared) are their edges.
const FLAT: f64 = 1e-24;

/// Far above the rounding of the heights of points over planes (longest side 1), far below what matters.
const ROUNDING: f64 = 1e-12;

/// Balls on a segment.
#[derive(Clone, Copy)]
struct Edge {
    start: Point,
    axis: Point,
    radius: f64,
    growth: f64,
    /// Inverse of the squared length, and of the squared length less the squared growth of the radius; 0 where one ball
    /// contains the other, which `end` names.
    inverse: f64,
    inverse_discriminant: f64,
    end: f64,
}

impl Edge {
    fn new(a: &Ball, b: &Ball) -> Self {
        let (axis, growth) = (b.center - a.center, b.radius - a.radius);
        let length_sq = axis.length_sq();
        let discriminant = length_sq - growth * growth;
        let contained = discriminant <= length_sq * CONTAINED;
        let unless = |x: f64| if contained { 0.0 } else { 1.0 / x };
        Self {
            start: a.center,
            axis,
            radius: a.radius,
            growth,
            inverse: unless(length_sq),
            inverse_discriminant: unless(discriminant),
            end: if contained && growth > 0.0 { 1.0 } else { 0.0 },
        }
    }

    /// Smallest signed distance, and where on the segment it is.
    #[inline]
    fn nearest(&self, p: Point) -> (f64, f64) {
        let to = self.start - p;
        let across = to.cross(self.axis).length_sq();
        let reach = self.growth * (across * self.inverse_discriminant).sqrt();
        let x = (reach - to.dot(self.axis)) * self.inverse + self.end;
        let x = x.clamp(0.0, 1.0);
        let distance = (to + self.axis * x).length() - self.radius - self.growth * x;
        (distance, x)
    }
}

/// Middle of a slab: what it has besides its edges.
#[derive(Clone, Copy)]
struct Middle {
    /// Rows that give the weights of the second and third ball.
    second: Point,
    third: Point,
    /// Gradient of the radius in the plane of the centres.
    slope: Point,
    /// Normal of that plane, over the cosine of the slope.
    normal: Point,
}

/// A ball, a cone or a slab.
#[derive(Clone, Copy)]
pub struct Prepared {
    /// Edges from the first ball to the second, the first to the third, the second to the third.
    edges: [Edge; 3],
    /// How many of them count: 1 for a cone or ball.
    count: usize,
    middle: Option<Middle>,
}

impl Prepared {
    /// Prepares the primitive spanned by `balls`; equal corners make it a cone or a ball.
    pub fn new(corners: Corners, [a, b, c]: [Ball; 3]) -> Self {
        let ab = Edge::new(&a, &b);
        if corners[1] == corners[2] {
            return Self {
                edges: [ab; 3],
                count: 1,
                middle: None,
            };
        }
        let ac = Edge::new(&a, &c);
        Self {
            middle: middle(&ab, &ac),
            edges: [ab, ac, Edge::new(&b, &c)],
            count: 3,
        }
    }

    /// Whether the signed distance of `p` is certainly above `limit`: proven by how far the balls reach along the unit
    /// vector `way`.
    #[inline]
    pub fn is_beyond(&self, p: Point, way: Point, limit: f64) -> bool {
        let [ab, ac, _] = &self.edges;
        let farther = |edge: &Edge| edge.axis.dot(way) + edge.growth;
        let reach = ab.radius + farther(ab).max(farther(ac)).max(0.0);
        (p - ab.start).dot(way) - reach > limit + ROUNDING
    }

    /// The direction in which `p` lies from the ball of these weights.
    pub fn direction_to(&self, p: Point, weights: [f64; 3]) -> Point {
        let [ab, ac, _] = &self.edges;
        direction(p - ab.start - ab.axis * weights[1] - ac.axis * weights[2])
    }

    /// Signed distance of `p`, and the weights of the balls that give it.
    #[inline]
    pub fn signed_distance(&self, p: Point) -> Signed {
        let [ab, ac, bc] = &self.edges;
        if self.count == 1 {
            return on_first(ab.nearest(p));
        }
        let Some(m) = &self.middle else {
            let least = nearer(on_first(ab.nearest(p)), on_second(ac.nearest(p)));
            return nearer(least, on_third(bc.nearest(p)));
        };
        let to = ab.start - p;
        let z = m.slope * to.dot(m.normal).abs() - to;
        let (x, y) = (z.dot(m.second), z.dot(m.third));
        if x >= 0.0 && y >= 0.0 && x + y <= 1.0 {
            let reached = to + ab.axis * x + ac.axis * y;
            let radius = ab.radius + ab.growth * x + ac.growth * y;
            return Signed {
                distance: reached.length() - radius,
                weights: [1.0 - x - y, x, y],
            };
        }
        let mut least = NONE;
        if y < 0.0 {
            least = on_first(ab.nearest(p));
        }
        if x < 0.0 {
            least = nearer(least, on_second(ac.nearest(p)));
        }
        if x + y > 1.0 {
            least = nearer(least, on_third(bc.nearest(p)));
        }
        least
    }
}

/// Start of a search for the least distance: farther than any point.
const NONE: Signed = Signed {
    distance: f64::INFINITY,
    weights: [1.0, 0.0, 0.0],
};

fn nearer(a: Signed, b: Signed) -> Signed {
    if b.distance < a.distance { b } else { a }
}

fn on_first((distance, x): (f64, f64)) -> Signed {
    let weights = [1.0 - x, x, 0.0];
    Signed { distance, weights }
}

fn on_second((distance, x): (f64, f64)) -> Signed {
    let weights = [1.0 - x, 0.0, x];
    Signed { distance, weights }
}

fn on_third((distance, x): (f64, f64)) -> Signed {
    let weights = [0.0, 1.0 - x, x];
    Signed { distance, weights }
}

/// `None` where the slab is no more than its edges: its centres lie on a line, or the radius grows
/// faster than one moves.
fn middle(ab: &Edge, ac: &Edge) -> Option<Middle> {
    let (u, v) = (ab.axis, ac.axis);
    let n = u.cross(v);
    let area_sq = n.length_sq();
    if area_sq <= FLAT * u.length_sq() * v.length_sq() {
        return None;
    }
    let second = v.cross(n) * (1.0 / area_sq);
    let third = n.cross(u) * (1.0 / area_sq);
    let slope = second * ab.growth + third * ac.growth;
    let cosine_sq = 1.0 - slope.length_sq();
    (cosine_sq > f64::EPSILON).then(|| Middle {
        second,
        third,
        slope,
        normal: n * (1.0 / (area_sq * cosine_sq).sqrt()),
    })
}
