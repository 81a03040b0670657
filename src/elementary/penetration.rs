//! How deep two overlapping primitives are in each other, and along which normal.
//!
//! For a unit `n` from the first to the second, `s(n) = min over corners of n·(b_j − a_i) − r_i − r_j`
//! is the gap between the two bodies along `n`; the penetration depth is `−max s(n)`. While the
//! medial surfaces do not cross, the nearest spheres' direction attains it (strong duality: the
//! distance is convex in the parameters and `y ≠ 0`). Where they cross, `s` is piecewise linear in
//! the gradients of three corners and its maximum lies at a direction that is tangent to both
//! bodies along a facet: a tangent plane of either slab, or of an edge of each.
//!
//! Tangent to two edges `e1, e2` with radius slopes `d1, d2` means `n·e1 = d1`, `n·e2 = d2`:
//! `n = g ± h N/|N|` with `N = e1 × e2`, as in [`crate::math::nearest`].

use super::distance::{Ball, nearest_in_test};
use super::test_list::{OwnedFeatures, edges, for_each_test};
use crate::math::lane::{Scalar, Vec3};
use crate::math::tolerance::{ONE_DIRECTION, ROUNDING_ULPS};

/// Difference of two gaps that counts as none, in units of `EPSILON × gap`: a gap is a sum of 8
/// rounded terms, with a margin of 2. Less, and equal directions are told apart by rounding.
const TIE_ULPS: f64 = 32.0;

/// Distance of two centres, in units of the sum of their radii, below which it has no direction of its
/// own: `f32` poses leave no digit of it. Larger, and normals jump where surfaces begin to cross;
/// smaller, and they are those of rounding.
pub const LOST: f64 = 1.0e-6;

/// How much deeper than the least depth the normal of the step before may be, as a fraction of it,
/// before it is given up. Two bodies that lie in the middle of each other tremble by what the
/// solver corrects in a step; that must be less than half of this times the depth, or the normal
/// turns over at each tremble. Larger, and a body is pushed out the longer way: at most so much
/// longer.
pub const HYSTERESIS: f64 = 0.1;

/// Gap of two primitives along a unit direction from the first to the second; negative when they
/// overlap along it.
pub fn gap_along<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>], n: Vec3<S>) -> S {
    // min over b of n·b − r, less max over a of n·a + r: no need to visit all corners.
    let near = b.iter().map(|s| n.dot(s.0) - s.1).reduce(S::min);
    let far = a.iter().map(|s| n.dot(s.0) + s.1).reduce(S::max);
    match (near, far) {
        (Some(near), Some(far)) => near - far,
        _ => S::zero(),
    }
}

/// Largest gap over all directions that can attain it, and that direction.
///
/// The direction nearest to `preferred` is taken among those whose gap is less by at most `hysteresis` (a fraction of
/// the depth; 0: by rounding): with the normal of the step before, the normal of a deep contact follows the bodies and
/// turns over once, not at every tremble.
pub fn deepest<S: Scalar>(
    a: &[Ball<S>],
    b: &[Ball<S>],
    preferred: Vec3<S>,
    hysteresis: S,
) -> (S, Vec3<S>) {
    let preferred = unit(preferred).unwrap_or(Vec3::new(S::one(), S::zero(), S::zero()));
    let gap = |n: &Vec3<S>| (gap_along(a, b, *n), *n);
    let steady: Vec<_> = steady_directions(a, b).iter().map(gap).collect();
    let loose: Vec<_> = loose_directions(a, b, preferred).iter().map(gap).collect();
    let all = || steady.iter().chain(&loose);
    let most = all().map(|c| c.0).fold(-S::splat(f64::MAX), S::max);
    let least = most - most.abs() * (hysteresis + S::splat(TIE_ULPS * S::EPSILON));
    let closer = |x: (S, Vec3<S>), y: (S, Vec3<S>)| {
        if x.1.dot(preferred) < y.1.dot(preferred) {
            y
        } else {
            x
        }
    };
    let nearest = |found: &mut dyn Iterator<Item = &(S, Vec3<S>)>| {
        found.filter(|c| c.0 >= least).copied().reduce(closer)
    };
    // A loose direction is where `preferred` was and does not turn with the bodies: it only serves
    // where nothing else is there.
    nearest(&mut steady.iter())
        .filter(|c| c.1.dot(preferred) >= S::splat(ONE_DIRECTION))
        .or_else(|| nearest(&mut all()))
        .unwrap_or((most, preferred))
}

/// Directions that the two bodies alone decide: those between the nearest spheres of each elementary test, and those
/// tangent to both bodies.
fn steady_directions<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> Vec<Vec3<S>> {
    let mut found = Vec::new();
    for_each_test(
        OwnedFeatures::whole(a.len()),
        OwnedFeatures::whole(b.len()),
        |test| {
            let s = nearest_in_test(&test, a, b).1;
            if s.length > S::splat(LOST) * (s.length - s.distance) {
                found.extend(unit(s.y));
            }
            true
        },
    );
    let (of_first, of_second) = slopes(a, b);
    let mut tangent = |e1, e2| found.extend(tangent_directions(e1, e2).into_iter().flatten());
    if let [e1, _, e3] = of_first[..] {
        tangent(e1, e3);
    }
    if let [e1, _, e3] = of_second[..] {
        tangent(e1, e3);
    }
    for e1 in &of_first {
        for e2 in &of_second {
            tangent(*e1, *e2);
        }
    }
    found.into_iter().filter_map(unit).collect()
}

/// Directions nearest to `preferred`: itself, and one tangent to each edge of either body. They matter where the bodies
/// leave a choice, as cones on one axis or spheres with one centre do.
fn loose_directions<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>], preferred: Vec3<S>) -> Vec<Vec3<S>> {
    let (of_first, of_second) = slopes(a, b);
    let on_circle = |(e, d): &(Vec3<S>, S)| {
        let along = unit(*e)?;
        let sine = *d / e.length();
        let cosine_sq = S::one() - sine * sine;
        // Where `preferred` leaves nothing but rounding, any direction across the edge serves.
        let wish = along.cross(preferred);
        let aside = if wish.length() > S::splat(ROUNDING_ULPS * S::EPSILON) {
            unit(wish)?
        } else {
            any_normal(along)?
        };
        let across = unit(aside.cross(along))?;
        (cosine_sq > S::zero()).then(|| across * cosine_sq.sqrt() + along * sine)
    };
    let circles = of_first.iter().chain(&of_second).filter_map(on_circle);
    std::iter::once(preferred)
        .chain(circles)
        .filter_map(unit)
        .collect()
}

/// Edges of both primitives, each with the slope `n·e` that a direction `n` tangent to it has. A tangent plane touches
/// both spheres of an edge `e = q − p`. On the first body the far side counts, `n·p + r`, so `n·e` is minus the change
/// of the radius; on the second the near side, `n·p − r`, so it is the change itself.
fn slopes<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> (Vec<Slope<S>>, Vec<Slope<S>>) {
    let of = |s: &[Ball<S>], sign: f64| {
        let slope = |e: &[u8; 2]| {
            let (p, q) = (s[e[0] as usize], s[e[1] as usize]);
            (q.0 - p.0, (q.1 - p.1) * S::splat(sign))
        };
        edges(s.len()).iter().map(slope).collect()
    };
    (of(a, -1.0), of(b, 1.0))
}

/// An edge `e`, and `d` in the condition `n·e = d` for directions `n` tangent to it.
type Slope<S> = (Vec3<S>, S);

/// A unit direction across a unit vector.
fn any_normal<S: Scalar>(v: Vec3<S>) -> Option<Vec3<S>> {
    let (x, y) = (S::one(), S::zero());
    let [by_x, by_y] = [Vec3::new(x, y, y), Vec3::new(y, x, y)].map(|axis| v.cross(axis));
    unit(if by_x.length_sq() < by_y.length_sq() {
        by_y
    } else {
        by_x
    })
}

fn unit<S: Scalar>(v: Vec3<S>) -> Option<Vec3<S>> {
    let length = v.length();
    (length > S::splat(S::TINY) && length.is_finite()).then(|| v * (S::one() / length))
}

/// The two unit directions with `n·e1 = d1` and `n·e2 = d2`, if they exist.
fn tangent_directions<S: Scalar>(
    (e1, d1): (Vec3<S>, S),
    (e2, d2): (Vec3<S>, S),
) -> Option<[Vec3<S>; 2]> {
    let normal = e1.cross(e2);
    let area = normal.length_sq();
    if area <= S::splat(64.0 * S::EPSILON * S::EPSILON) * e1.length_sq() * e2.length_sq() {
        return None;
    }
    let g = (e2.cross(normal) * d1 + normal.cross(e1) * d2) * (S::one() / area);
    let hh = S::one() - g.length_sq();
    if hh <= S::zero() {
        return None;
    }
    let up = normal * (hh / area).sqrt();
    Some([g + up, g - up])
}
