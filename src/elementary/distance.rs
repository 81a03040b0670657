//! Signed distance of two primitives at a fixed time: paper Eq. (2), minimised over all sphere
//! pairs. Where medial surfaces cross it is minus the radius sum there, which the elementary tests
//! alone do not see.

use super::penetration::Ball;
use super::test_list::{Domain, ElementaryTest, Share, edges, for_each_test};
use super::{cone_cone, slab_crossing, sphere_slab};
use crate::math::lane::Scalar;
use crate::math::nearest::{Family, Nearest};

/// The family and the nearest spheres of one elementary test of two primitives.
pub fn nearest_in_test<S: Scalar>(
    test: &ElementaryTest,
    a: &[Ball<S>],
    b: &[Ball<S>],
) -> (Family<S>, Nearest<S>) {
    let y = test.corners.map(|(i, j)| b[j as usize].0 - a[i as usize].0);
    let radius = test.corners.map(|(i, j)| a[i as usize].1 + b[j as usize].1);
    let f = cone_cone::family(&y, &radius);
    let s = match test.domain {
        Domain::Box => cone_cone::nearest_spheres(&f),
        Domain::Triangle => sphere_slab::nearest_spheres(&f),
    };
    (f, s)
}

/// A crossing of an edge of one primitive (of those in `mask`, as in [`Share::edges`]) with the slab
/// of the other.
pub fn crossing<S: Scalar>(
    a: &[Ball<S>],
    mask: u8,
    b: &[Ball<S>],
) -> Option<slab_crossing::Crossing<S>> {
    let &[b0, b1, b2] = b else { return None };
    edges(a.len()).iter().enumerate().find_map(|(bit, e)| {
        let owned = mask >> bit & 1 == 1;
        owned
            .then(|| slab_crossing::crossing([a[e[0] as usize], a[e[1] as usize]], [b0, b1, b2]))
            .flatten()
    })
}

/// Signed distance of two primitives of 1 to 3 spheres.
pub fn signed_distance<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> S {
    let mut least: Option<S> = None;
    let mut offer = |d: S| least = Some(least.map_or(d, |l| l.min(d)));
    for_each_test(Share::whole(a.len()), Share::whole(b.len()), |test| {
        offer(nearest_in_test(&test, a, b).1.distance);
        true
    });
    for c in [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)]
        .into_iter()
        .flatten()
    {
        offer(-c.radius);
    }
    least.unwrap_or_else(S::zero)
}
