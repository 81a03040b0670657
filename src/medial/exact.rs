//! A primitive's geometry in double precision: its spheres, tangent planes and distance.
//!
//! # Tangent planes
//! A plane `n·x = k` touches all three spheres from outside iff `n·c_i + r_i = k` for each. With
//! `u`, `v` the edges from the first centre and `da`, `db` the changes of radius along them,
//! that is `n·u = −da`, `n·v = −db`, `|n| = 1`: the system of the interior point in
//! `math::nearest`, so `n = −g ± √(1 − |g|²) N/|N|` with the same `g` and `N`.

use super::sphere::MedialSphere;
use crate::math::lane::Vec3;
use crate::math::nearest::{Family, Nearest, edge_minimum, nearest_in_triangle};
use crate::math::sphere::Ball;

/// sin² of the angle between two edges (a pure number) below which the direction of their cross
/// product is rounding: the squared `f64` rounding 2⁻⁵², and 3 digits to spare. A slab as narrow
/// as that is its longest cone, to rounding.
const COLLINEAR_SIN_SQ: f64 = 1e-26;

/// Share of a direction that is across an axis (a sine) up to which it counts as along the axis: its rounding in `f32`.
const ALONG_AXIS: f64 = 1e-6;

/// The three spheres of a primitive as [`as_slab`](super::MedialPrimitive::as_slab) gives them; exact.
pub fn balls(slab: [MedialSphere; 3]) -> [Ball; 3] {
    slab.map(|s| Ball {
        center: Vec3::from_vector(s.center),
        radius: s.radius.into(),
    })
}

/// The interpolated sphere nearest to a point; its signed distance is exact outside and a lower
/// bound of the depth inside. `y` is the sphere's centre less the point.
pub fn nearest_to_point(balls: &[Ball; 3], point: Vec3<f64>) -> Nearest<f64> {
    let [a, b, c] = *balls;
    let family = Family {
        w: a.center - point,
        u: b.center - a.center,
        v: c.center - a.center,
        r0: a.radius,
        da: b.radius - a.radius,
        db: c.radius - a.radius,
    };
    // A cone is a slab whose last two spheres are one: a single edge instead of three.
    if family.u == family.v && family.da == family.db {
        return family.at(edge_minimum(family.w, family.u, family.da), 0.0);
    }
    nearest_in_triangle(&family)
}

/// Outward unit normals of the two planes tangent to three spheres, if they exist: not when the
/// centres lie on a line, and not when the hull of the spheres has no flat part.
pub fn tangent_normals(balls: &[Ball; 3]) -> Option<[Vec3<f64>; 2]> {
    let [a, b, c] = balls.map(|ball| ball.center);
    let [u_sq, v_sq] = [b - a, c - a].map(|side| side.length_sq());
    tangent_normals_beyond(balls, COLLINEAR_SIN_SQ * u_sq * v_sq)
}

/// Does the same as [`tangent_normals`], with another limit: centres count as on a line if the square of the cross
/// product of the two edges from the first is at most `collinear_sq`.
pub fn tangent_normals_beyond(balls: &[Ball; 3], collinear_sq: f64) -> Option<[Vec3<f64>; 2]> {
    let [a, b, c] = *balls;
    let (u, v) = (b.center - a.center, c.center - a.center);
    let n = u.cross(v);
    let nn = n.length_sq();
    if nn <= collinear_sq {
        return None;
    }
    let (da, db) = (b.radius - a.radius, c.radius - a.radius);
    let g = (v.cross(n) * da + n.cross(u) * db) * (1.0 / nn);
    let height_sq = 1.0 - g.length_sq();
    if height_sq <= 0.0 {
        return None;
    }
    let up = n * (height_sq / nn).sqrt();
    Some([up - g, -up - g])
}

/// Outward unit normal of a plane that touches two spheres, of all around their axis the one that faces `along` most;
/// `None` if one sphere holds the other.
pub fn cone_normal([a, b]: [Ball; 2], along: Vec3<f64>) -> Option<Vec3<f64>> {
    let between = b.center - a.center;
    let length = between.length();
    let sine = (a.radius - b.radius) / length;
    // Not for spheres of one centre, where the sine is not a number.
    (sine.abs() < 1.0).then(|| {
        let axis = between * (1.0 / length);
        let across = |v: Vec3<f64>| v - axis * v.dot(axis);
        let aside = across(along);
        let aside = if aside.length() > ALONG_AXIS * along.length() {
            aside
        } else {
            across(Vec3::from_vector(axis.to_vector().any_orthonormal_vector()))
        };
        axis * sine + aside * ((1.0 - sine * sine).sqrt() / aside.length())
    })
}
