//! Whether a primitive hides a point of a sheet of the envelope.
//!
//! # Rise
//! Let `p` be a point of a sheet with outward normal `n`. A primitive rises over the tangent plane
//! at `p` by `max_k (n·c_k + r_k) − n·p`. If that is not positive the plane separates, and `p`
//! is not inside. If the sheet bounds the primitive, `p` belongs to it, and is on its boundary
//! iff `n` is a normal of the primitive there, that is, iff the rise is 0. So three inner products
//! decide for the sheet's own primitives and for most others; the depth is needed for the rest.

use super::exact::{balls, nearest_to_point};
use super::mesh::MedialMesh;
use super::sheet::{Sheet, Spot};
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::sphere::Ball;

/// A primitive that may hide points, with its box.
pub(super) struct Cover {
    /// Whether the sheet at hand bounds the primitive.
    pub owner: bool,
    balls: [Ball; 3],
    lo: Vec3<f64>,
    hi: Vec3<f64>,
    /// Index of the primitive.
    pub index: u32,
}

impl Cover {
    /// A primitive beside a sheet that rests on some spheres; its box is widened by `margin`.
    pub fn new(mesh: &MedialMesh, index: u32, rests_on: [u32; 3], margin: Vec3<f64>) -> Self {
        let spheres = mesh.simplices()[index as usize].vertices;
        let balls = balls(mesh.primitive(index as usize).as_slab());
        let [a, b, c] = balls.map(|b| Sheet::Ball(b).bounds());
        let least =
            |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
        let most = |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z));
        Self {
            owner: rests_on.iter().all(|s| spheres.contains(s)),
            balls,
            lo: least(least(a[0], b[0]), c[0]) - margin,
            hi: most(most(a[1], b[1]), c[1]) + margin,
            index,
        }
    }

    /// Order in which primitives are asked: the sheet's own first, then the nearer to its middle.
    pub fn rank(&self, middle: Vec3<f64>) -> (bool, i64) {
        let distance = nearest_to_point(&self.balls, middle).distance;
        // The bits of a float, made to sort as the float does.
        let bits = distance.to_bits() as i64;
        (!self.owner, bits ^ (((bits >> 63) as u64) >> 1) as i64)
    }

    /// How far the primitive rises over the tangent plane at a point.
    pub fn rise(&self, at: Spot) -> f64 {
        let [a, b, c] = self
            .balls
            .map(|ball| at.normal.dot(ball.center) + ball.radius);
        a.max(b).max(c) - at.normal.dot(at.point)
    }

    /// Depth of a point in the primitive, with the outward normal there; `None` far outside.
    pub fn depth(&self, p: Vec3<f64>) -> Option<(f64, Vec3<f64>)> {
        let (lo, hi) = (self.lo, self.hi);
        let within = (lo.x <= p.x && p.x <= hi.x)
            && (lo.y <= p.y && p.y <= hi.y)
            && (lo.z <= p.z && p.z <= hi.z);
        within.then(|| {
            let nearest = nearest_to_point(&self.balls, p);
            (-nearest.distance, nearest.y * (-1.0 / nearest.length))
        })
    }

    /// Function that is positive where the primitive hides a point, 0 on its boundary, negative elsewhere.
    pub fn excess(&self, at: Spot) -> f64 {
        if self.owner {
            return self.rise(at);
        }
        self.depth(at.point)
            .map_or(f64::NEG_INFINITY, |(depth, _)| depth)
    }

    /// Whether the primitive hides a point: it lies deeper than `rounding`, or on a surface that
    /// both share, if this one has it `first`.
    pub fn hides(&self, at: Spot, rounding: f64, first: bool) -> bool {
        let rise = self.rise(at);
        if self.owner || rise < -rounding || (rise <= rounding && !first) {
            return self.owner && rise > rounding;
        }
        self.depth(at.point).is_some_and(|(depth, outward)| {
            let same = outward.dot(at.normal) > 1.0 - f64::from(Real::EPSILON);
            depth > rounding || (first && same && depth >= -rounding)
        })
    }
}
