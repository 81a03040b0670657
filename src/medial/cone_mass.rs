//! Mass, centre and inertia of a single ball or medial cone, in closed form. Along its axis it is part of a ball, a
//! frustum, and part of the other ball, with polynomials of degree 4 at most in all integrals, which Gauss's rule with
//! three points sums exactly.

use super::mass::Moments;
use crate::math::lane::Vec3;
use crate::math::sphere::Ball;

/// Nodes and weights of Gauss's rule on the stretch from −1 to 1: exact up to degree 5.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Moments of the hull of the first two of three balls about the centre of the first, or of the larger ball if it
/// holds the other; `None` if the third is not the second, as in a slab.
pub(super) fn moments(balls: &[Ball; 3]) -> Option<Moments> {
    let [a, b, c] = balls;
    if b.center != c.center || b.radius != c.radius {
        return None;
    }
    let between = b.center - a.center;
    let length = between.length();
    // A plane that touches both balls is turned against the axis by this sine.
    let sine = (a.radius - b.radius) / length;
    if length.is_nan() || length <= 0.0 || sine.abs() >= 1.0 {
        let ball = if b.radius > a.radius { b } else { a };
        let mut moments = Moments::zero(ball.center);
        let inner = |z: f64| ball.radius * ball.radius - z * z;
        add(&mut moments, [-ball.radius, ball.radius], inner);
        return Some(moments);
    }
    let along = between * (1.0 / length);
    let across = Vec3::from_vector(along.to_vector().any_orthonormal_vector());
    let across = across - along * across.dot(along);
    let across = across * (1.0 / across.length());
    let mut moments = Moments::in_axes(a.center, [across, along.cross(across), along]);
    let [from, to] = [a.radius * sine, length + b.radius * sine];
    let first = |z: f64| a.radius * a.radius - z * z;
    let frustum = |z: f64| (a.radius - sine * z).powi(2) / (1.0 - sine * sine);
    let second = |z: f64| b.radius * b.radius - (z - length) * (z - length);
    add(&mut moments, [-a.radius, from], first);
    add(&mut moments, [from, to], frustum);
    add(&mut moments, [to, length + b.radius], second);
    Some(moments)
}

/// Adds a stretch of a solid of revolution about the third axis, with its squared radius at each place.
fn add(moments: &mut Moments, [from, to]: [f64; 2], radius_sq: impl Fn(f64) -> f64) {
    let half = 0.5 * (to - from);
    for (node, weight) in GAUSS {
        let z = from + half * (1.0 + node);
        moments.add_disc(z, radius_sq(z), weight * half);
    }
}
