//! Points at which a line enters and leaves a medial primitive, in closed form. Source: own derivation from the
//! interpolated spheres of the paper's §3.
//!
//! # Derivation
//! The line is parallel to z and passes through `q` in the xy-plane. A sphere with centre
//! `(p, z)` and radius `r` covers the stretch `z ± √Q` with `Q = r² − |p − q|²`. The primitive is
//! the union over its interpolated spheres, and convex, so its stretch runs from the minimum of
//! `z − √Q` to the maximum of `z + √Q` over the weights. Both are attained on a sphere, on a cone
//! flank or on a slab plane; every hit on any of these lies in the primitive, so the stretch is
//! the span of all hits.
//!
//! **Cone flank.** Along an edge, weight `x ∈ [0, 1]`: `z = z0 + b x` and
//! `Q = A x² + 2 B x + C` with `A = dr² − |dp|²`, `B = r0 dr − (p0 − q)·dp`,
//! `C = r0² − |p0 − q|²`. The exit is stationary: `b √Q = −(A x + B)`. Squaring, and
//! `(A x + B)² = A Q + B² − A C`, gives `Q = (B² − A C)/D = s²` with `D = b² + |dp|² − dr²`;
//! then `x = −(B + b s)/A`. Where `A` is small (the line runs along a generator) that quotient
//! loses its digits; as `(B + b s)(b s − B) = A (B² − b² C)/D`, the same root is
//! `−(B² − b² C)/(D (b s − B))`. The entry swaps the sign of `s`. For `D ≤ 0` one end sphere
//! contains the other and there is no flank.
//!
//! **Slab plane.** A plane tangent to the three spheres with outward normal `n` touches sphere `k`
//! at `c_k + r_k n`; the line meets the triangle of these points where its barycentric
//! coordinates are not negative.

use super::exact::tangent_normals;
use crate::math::lane::Vec3;
use crate::math::sphere::Ball;

/// A primitive prepared for lines parallel to z.
#[derive(Clone, Debug)]
pub struct ChordSolver {
    balls: [Ball; 3],
    flanks: [Option<Flank>; 3],
    planes: [Option<Plane>; 2],
}

/// The flank of a cone; names as in the derivation.
#[derive(Clone, Copy, Debug)]
struct Flank {
    from: Ball,
    along: Vec3<f64>,
    dr: f64,
    a: f64,
    d_inverse: f64,
}

/// A tangent triangle as an affine map from the line's xy to weights and height.
#[derive(Clone, Copy, Debug)]
struct Plane {
    origin: Vec3<f64>,
    e1: Vec3<f64>,
    e2: Vec3<f64>,
    det_inverse: f64,
}

impl ChordSolver {
    /// Prepares a primitive given by its spheres, in a frame whose z-axis is the lines' direction.
    pub fn new(balls: [Ball; 3]) -> Self {
        let [a, b, c] = balls;
        let planes = match tangent_normals(&balls) {
            Some(normals) => normals.map(|n| Plane::new(balls.map(|s| s.center + n * s.radius))),
            None => [None; 2],
        };
        Self {
            balls,
            flanks: [Flank::new(a, b), Flank::new(b, c), Flank::new(c, a)],
            planes,
        }
    }

    /// Spheres of the primitive.
    pub fn balls(&self) -> &[Ball; 3] {
        &self.balls
    }

    /// First and last z of the line through `(x, y)` inside the primitive; `None` if it misses.
    pub fn chord(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        let mut hit = |lo: f64, hi: f64| span = [span[0].min(lo), span[1].max(hi)];
        for s in &self.balls {
            let (px, py) = (s.center.x - x, s.center.y - y);
            let q = s.radius * s.radius - px * px - py * py;
            if q >= 0.0 {
                hit(s.center.z - q.sqrt(), s.center.z + q.sqrt());
            }
        }
        for flank in self.flanks.iter().flatten() {
            let [entry, exit] = flank.hits(x, y);
            for z in [entry, exit].into_iter().flatten() {
                hit(z, z);
            }
        }
        for plane in self.planes.iter().flatten() {
            if let Some(z) = plane.hit(x, y) {
                hit(z, z);
            }
        }
        (span[0] < span[1]).then_some(span)
    }
}

impl Flank {
    fn new(from: Ball, to: Ball) -> Option<Self> {
        let along = to.center - from.center;
        let dr = to.radius - from.radius;
        let flat_sq = along.x * along.x + along.y * along.y;
        let d = along.z * along.z + flat_sq - dr * dr;
        (d > 0.0).then(|| Self {
            from,
            along,
            dr,
            a: dr * dr - flat_sq,
            d_inverse: 1.0 / d,
        })
    }

    fn hits(&self, x: f64, y: f64) -> [Option<f64>; 2] {
        let Self { from, along, .. } = self;
        let (px, py) = (from.center.x - x, from.center.y - y);
        let b_line = along.z;
        let b = from.radius * self.dr - px * along.x - py * along.y;
        let c = from.radius * from.radius - px * px - py * py;
        let s_sq = (b * b - self.a * c) * self.d_inverse;
        if s_sq < 0.0 {
            return [None; 2];
        }
        let s = s_sq.sqrt();
        let (sum, difference) = (b_line * s + b, b_line * s - b);
        let product = (b * b - b_line * b_line * c) * self.d_inverse;
        let sum_larger = sum.abs() >= difference.abs();
        let exit = if sum_larger {
            -sum / self.a
        } else {
            -product / difference
        };
        let entry = if sum_larger {
            product / sum
        } else {
            difference / self.a
        };
        let at = |weight: f64, s: f64| {
            (0.0..=1.0)
                .contains(&weight)
                .then_some(from.center.z + b_line * weight + s)
        };
        [at(entry, -s), at(exit, s)]
    }
}

impl Plane {
    fn new([origin, b, c]: [Vec3<f64>; 3]) -> Option<Self> {
        let (e1, e2) = (b - origin, c - origin);
        let det_inverse = 1.0 / (e1.x * e2.y - e1.y * e2.x);
        det_inverse.is_finite().then_some(Self {
            origin,
            e1,
            e2,
            det_inverse,
        })
    }

    fn hit(&self, x: f64, y: f64) -> Option<f64> {
        let (dx, dy) = (x - self.origin.x, y - self.origin.y);
        let alpha = (dx * self.e2.y - dy * self.e2.x) * self.det_inverse;
        let beta = (dy * self.e1.x - dx * self.e1.y) * self.det_inverse;
        (alpha >= 0.0 && beta >= 0.0 && alpha + beta <= 1.0)
            .then_some(self.origin.z + self.e1.z * alpha + self.e2.z * beta)
    }
}
