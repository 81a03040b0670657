//! Signed distance of two primitives at a fixed time: paper Eq. (2), minimised over all pairs of spheres. Where medial
//! surfaces cross it is minus the sum of the radii there, which the elementary tests alone do not find.

use super::test_list::{Domain, ElementaryTest, Share, edges, for_each_test};
use super::{certificate, cone_cone, slab_crossing, sphere_slab};
use crate::math::lane::{Scalar, Vec3};
use crate::math::nearest::{Family, Nearest};

/// A sphere in a common frame: centre and radius.
pub type Ball<S> = (Vec3<S>, S);

/// The family and the nearest spheres of one elementary test of two primitives.
pub fn nearest_in_test<S: Scalar>(
    test: &ElementaryTest,
    a: &[Ball<S>],
    b: &[Ball<S>],
) -> (Family<S>, Nearest<S>) {
    let f = family(test, a, b);
    (f, nearest_in_family(test.domain, &f))
}

/// The difference of both sides of an elementary test of two primitives.
#[inline]
pub fn family<S: Scalar>(test: &ElementaryTest, a: &[Ball<S>], b: &[Ball<S>]) -> Family<S> {
    let corner = |k: usize| {
        let (i, j) = test.corners[k];
        let (p, q) = (a[i as usize], b[j as usize]);
        (q.0 - p.0, p.1 + q.1)
    };
    let (p, q, r) = (corner(0), corner(1), corner(2));
    // The fourth follows from these.
    cone_cone::family(&[p.0, q.0, r.0, r.0], &[p.1, q.1, r.1, r.1])
}

/// The nearest spheres of a family.
pub fn nearest_in_family<S: Scalar>(domain: Domain, f: &Family<S>) -> Nearest<S> {
    match domain {
        Domain::Box => cone_cone::nearest_spheres(f),
        Domain::Triangle => sphere_slab::nearest_spheres(f),
    }
}

/// Whether the spheres of a cone–cone test are certainly further than `margin` from each other, in half
/// of the time of [`nearest_in_family`]: proven by the direction between the nearest points of the axes
/// ([`certificate::lower_bound`]), found by solving for one parameter after the other.
pub fn is_beyond<S: Scalar>(f: &Family<S>, margin: S) -> bool {
    let (uu, vv, uv) = (f.u.length_sq(), f.v.length_sq(), f.u.dot(f.v));
    let (uw, vw) = (f.u.dot(f.w), f.v.dot(f.w));
    let tiny = S::splat(S::TINY);
    let alpha = ((uv * vw - vv * uw) / (uu * vv - uv * uv).max(tiny)).clamp01();
    let beta = (-(vw + uv * alpha) / vv.max(tiny)).clamp01();
    let alpha = (-(uw + uv * beta) / uu.max(tiny)).clamp01();
    let y = f.w + f.u * alpha + f.v * beta;
    let n = y * (S::one() / y.length().max(tiny));
    // The rounding of a few sums of such lengths.
    let slack =
        S::splat(64.0 * S::EPSILON) * (f.w.taxicab() + f.u.taxicab() + f.v.taxicab() + f.r0);
    certificate::lower_bound(Domain::Box, f, n) > margin + slack
}

/// The deepest crossing of an edge of one primitive (of those in `mask`, as in [`Share::edges`]) with
/// the slab of the other. Two triangles cross along a segment, on which the radius sum is linear:
/// the deepest point is one of its ends, where an edge of either passes through the other.
pub fn crossing<S: Scalar>(
    a: &[Ball<S>],
    mask: u8,
    b: &[Ball<S>],
) -> Option<slab_crossing::Crossing<S>> {
    let &[b0, b1, b2] = b else { return None };
    edges(a.len())
        .iter()
        .enumerate()
        .filter(|(bit, _)| mask >> bit & 1 == 1)
        .filter_map(|(_, e)| {
            slab_crossing::crossing([a[e[0] as usize], a[e[1] as usize]], [b0, b1, b2])
        })
        .reduce(deeper)
}

/// The crossing with the larger radius sum.
pub fn deeper<S: Scalar>(
    a: slab_crossing::Crossing<S>,
    b: slab_crossing::Crossing<S>,
) -> slab_crossing::Crossing<S> {
    if a.radius < b.radius { b } else { a }
}

/// Smallest sum of radii of a sphere of each primitive. While the signed distance is above minus
/// this, medial surfaces cannot cross, and the elementary tests see all of the distance.
pub fn thinnest<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> S {
    let least = |s: &[Ball<S>]| s.iter().map(|s| s.1).reduce(S::min).unwrap_or(S::zero());
    least(a) + least(b)
}

/// Signed distance of two primitives of 1 to 3 spheres.
pub fn signed_distance<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> S {
    let mut least: Option<S> = None;
    let mut normal = None;
    for_each_test(Share::whole(a.len()), Share::whole(b.len()), |test| {
        let family = family(&test, a, b);
        // No sphere pair of a test is nearer than its corners along any one direction: mostly that of the nearest yet.
        let bound = normal.map(|n| certificate::lower_bound(test.domain, &family, n));
        if !least
            .zip(bound)
            .is_some_and(|(least, bound)| bound >= least)
        {
            let nearest = nearest_in_family(test.domain, &family);
            if least.is_none_or(|least| nearest.distance < least) {
                least = Some(nearest.distance);
                let length = nearest.length;
                normal = (length > S::zero()).then(|| nearest.y * (S::one() / length));
            }
        }
        true
    });
    let mut offer = |d: S| least = Some(least.map_or(d, |l| l.min(d)));
    for c in [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)]
        .into_iter()
        .flatten()
    {
        offer(-c.radius);
    }
    least.unwrap_or_else(S::zero)
}
