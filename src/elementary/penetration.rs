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

use super::distance::nearest_in_test;
use super::test_list::{Share, edges, for_each_test};
use crate::math::lane::{Scalar, Vec3};

/// A sphere in a common frame: centre and radius.
pub type Ball<S> = (Vec3<S>, S);

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

/// Largest gap over all directions that can attain it, and that direction. Ties go to the
/// direction nearest to `preferred`.
pub fn deepest<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>], preferred: Vec3<S>) -> (S, Vec3<S>) {
    let mut best: Option<(S, Vec3<S>)> = None;
    let tie = S::splat(16.0 * S::EPSILON);
    let mut offer = |n: Vec3<S>| {
        let length = n.length();
        if length <= S::splat(S::TINY) || !length.is_finite() {
            return;
        }
        let n = n * (S::one() / length);
        let gap = gap_along(a, b, n);
        best = Some(match best {
            None => (gap, n),
            Some(old) => {
                let band = tie * (old.0.abs() + gap.abs());
                let close = (gap - old.0).abs() <= band;
                let better = if close {
                    old.1.dot(preferred) < n.dot(preferred)
                } else {
                    old.0 < gap
                };
                if better { (gap, n) } else { old }
            }
        });
    };
    for_each_test(Share::whole(a.len()), Share::whole(b.len()), |test| {
        offer(nearest_in_test(&test, a, b).1.y);
        true
    });
    let edge = |s: &[Ball<S>], e: &[u8; 2]| {
        let (p, q) = (s[e[0] as usize], s[e[1] as usize]);
        (q.0 - p.0, q.1 - p.1)
    };
    // On the first body the far side counts (n·p + r), on the second the near one (n·p − r): the
    // slope of an edge of the first is the negative of its radius change.
    let mut tangent = |e1: (Vec3<S>, S), e2: (Vec3<S>, S)| {
        if let Some([n1, n2]) = tangent_directions(e1, e2) {
            offer(n1);
            offer(n2);
        }
    };
    let first = |e: (Vec3<S>, S)| (e.0, -e.1);
    if a.len() == 3 {
        tangent(first(edge(a, &[0, 1])), first(edge(a, &[0, 2])));
    }
    if b.len() == 3 {
        tangent(edge(b, &[0, 1]), edge(b, &[0, 2]));
    }
    for ea in edges(a.len()) {
        for eb in edges(b.len()) {
            tangent(first(edge(a, ea)), edge(b, eb));
        }
    }
    offer(preferred);
    best.unwrap_or((S::zero(), preferred))
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
