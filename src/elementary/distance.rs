//! Signed distance of two primitives at a fixed time: paper Eq. (2), minimised over all pairs of spheres. Where medial
//! surfaces cross it is minus the sum of the radii there, which the elementary tests alone do not find.

use super::test_list::{Domain, ElementaryTest, OwnedFeatures, edges, for_each_test};
use super::{certificate, cone_cone, slab_crossing, sphere_slab};
use crate::math::lane::{Scalar, Vec3};
use crate::math::nearest::{Family, Nearest};
use crate::math::tolerance::ROUNDING_ULPS;

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
/// (`certificate::lower_bound`), found by solving for one parameter after the other.
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
    let slack = S::splat(ROUNDING_ULPS * S::EPSILON)
        * (f.w.taxicab() + f.u.taxicab() + f.v.taxicab() + f.r0);
    certificate::lower_bound(Domain::Box, f, n) > margin + slack
}

/// The deepest crossing of an edge of one primitive (of those in `mask`, as in [`OwnedFeatures::edges`]) with
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
    signed_distance_along(a, b).0
}

/// Signed distance of two primitives of 1 to 3 spheres, and the unit direction from the nearest sphere of the first to
/// that of the second. Where medial surfaces cross there is no such direction.
pub fn signed_distance_along<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> (S, Option<Vec3<S>>) {
    if a.len() == 3 && b.len() == 3 {
        nearest_first(a, b)
    } else {
        in_order(a, b)
    }
}

/// Signed distance of two primitives with few elementary tests.
fn in_order<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> (S, Option<Vec3<S>>) {
    let mut least: Option<S> = None;
    let mut normal = None;
    for_each_test(
        OwnedFeatures::whole(a.len()),
        OwnedFeatures::whole(b.len()),
        |test| {
            let family = family(&test, a, b);
            // No sphere pair of a test is nearer than its corners along any one direction: mostly that of the nearest
            // yet.
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
        },
    );
    for c in [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)]
        .into_iter()
        .flatten()
    {
        least = Some(least.map_or(-c.radius, |least| least.min(-c.radius)));
        normal = None;
    }
    (least.unwrap_or_else(S::zero), normal)
}

/// Signed distance of two slabs, which have many elementary tests: first that one which may have the nearest spheres.
fn nearest_first<S: Scalar>(a: &[Ball<S>], b: &[Ball<S>]) -> (S, Option<Vec3<S>>) {
    let mut waiting =
        [PendingTest::new(ElementaryTest::cone_cone([0, 0], [0, 0]), a, b); MOST_TESTS];
    let mut count = 0;
    for_each_test(
        OwnedFeatures::whole(a.len()),
        OwnedFeatures::whole(b.len()),
        |test| {
            waiting[count] = PendingTest::new(test, a, b);
            count += 1;
            count < MOST_TESTS
        },
    );
    let middle = |s: &[Ball<S>]| {
        let sum = s.iter().fold(Vec3::zero(), |sum, s| sum + s.0);
        sum * (S::one() / S::splat(s.len() as f64))
    };
    let mut ends = Ends::new(a, b, unit(middle(b) - middle(a)));
    let mut waiting = &mut waiting[..count];
    let mut least: Option<S> = None;
    let mut normal = None;
    let mut is_crossing_known = false;
    waiting.iter_mut().for_each(|w| w.look_along(&ends));
    loop {
        let of = |k: usize| waiting[k].bound;
        let first = (0..waiting.len()).reduce(|k, l| if of(l) < of(k) { l } else { k });
        let Some(first) = first.filter(|k| least.is_none_or(|least| of(*k) < least)) else {
            break;
        };
        let (_, nearest) = nearest_in_test(&waiting[first].test, a, b);
        let last = waiting.len() - 1;
        waiting.swap(first, last);
        waiting = &mut waiting[..last];
        if least.is_none_or(|least| nearest.distance < least) {
            least = Some(nearest.distance);
            normal = (nearest.length > S::zero()).then(|| unit(nearest.y));
            if let Some(n) = normal {
                ends = Ends::new(a, b, n);
                waiting.iter_mut().for_each(|w| w.look_along(&ends));
            }
        }
        // Known before most tests are computed: where medial surfaces cross no direction spares them.
        if !is_crossing_known && !ends.keeps_axes_apart(a, b) {
            is_crossing_known = true;
            let crossings = [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)];
            for c in crossings.into_iter().flatten() {
                if least.is_none_or(|least| -c.radius <= least) {
                    (least, normal) = (Some(-c.radius), None);
                }
            }
        }
    }
    (least.unwrap_or_else(S::zero), normal)
}

/// A test of two primitives that is not computed yet.
#[derive(Clone, Copy)]
struct PendingTest<S> {
    test: ElementaryTest,
    /// A lower bound of the distance of its spheres.
    bound: S,
}

impl<S: Scalar> PendingTest<S> {
    /// A test with the lowest bound there can be: no two spheres are deeper in each other than the sum of their radii.
    fn new(test: ElementaryTest, a: &[Ball<S>], b: &[Ball<S>]) -> Self {
        let [p, q, r, s] = test.corners;
        let of_a = |k: u8| a[usize::from(k)].1;
        let of_b = |k: u8| b[usize::from(k)].1;
        // Each sphere of a side is among these corners.
        let most_a = of_a(p.0).max(of_a(q.0)).max(of_a(r.0));
        let most_b = of_b(p.1).max(of_b(r.1)).max(of_b(s.1)).max(of_b(q.1));
        let bound = -(most_a + most_b);
        Self { test, bound }
    }

    /// Raises the bound by a direction: no sphere pair of a test is nearer than its corners are along any.
    fn look_along(&mut self, ends: &Ends<S>) {
        self.bound = self.bound.max(ends.gap(&self.test));
    }
}

/// Elementary tests of two slabs: no two primitives have more.
const MOST_TESTS: usize = 15;

fn unit<S: Scalar>(y: Vec3<S>) -> Vec3<S> {
    y * (S::one() / y.length().max(S::splat(S::TINY)))
}

/// Square of the sine of the angle between a face and the medial plane below which they count as one.
const TILTED: f64 = 0.01;

/// The outer normal, of any length, of that face of a slab that looks along `y`: of the plane that touches its three
/// spheres, given by two edges and how much the radius grows along each; `None` if no plane does, or if it hardly
/// differs from the medial plane.
pub(crate) fn face<S: Scalar>(edges: [Vec3<S>; 2], slopes: [S; 2], y: Vec3<S>) -> Option<Vec3<S>> {
    let ([u, v], [du, dv]) = (edges, slopes);
    let normal = u.cross(v);
    let square = normal.length_sq();
    // In the slab's plane the vector whose products with both edges are the negative slopes; then what makes it a unit
    // vector; both times the square.
    let tilt = (u * dv - v * du).cross(normal);
    let share = tilt.length_sq() / square;
    let rest = square - share;
    // Neither of a slab without area, of which it is not a number.
    (rest > S::zero() && share > square * S::splat(TILTED)).then(|| {
        let up = rest.sqrt();
        let is_behind = normal.dot(y) < S::zero();
        tilt + normal * if is_behind { -up } else { up }
    })
}

/// How far the spheres of two primitives reach towards each other along a direction.
pub(crate) struct Ends<S> {
    n: Vec3<S>,
    far: [S; 3],
    near: [S; 3],
}

impl<S: Scalar> Ends<S> {
    /// Along `n`, a unit vector or zero.
    pub(crate) fn new(a: &[Ball<S>], b: &[Ball<S>], n: Vec3<S>) -> Self {
        let mut ends = Self {
            n,
            far: [S::zero(); 3],
            near: [S::zero(); 3],
        };
        for (far, s) in ends.far.iter_mut().zip(a) {
            *far = n.dot(s.0) + s.1;
        }
        for (near, s) in ends.near.iter_mut().zip(b) {
            *near = n.dot(s.0) - s.1;
        }
        ends
    }

    /// A lower bound of the distance of the spheres of a test, but for rounding.
    pub(crate) fn gap(&self, test: &ElementaryTest) -> S {
        let [p, q, r, s] = test.corners;
        let far = |k: u8| self.far[usize::from(k)];
        let near = |k: u8| self.near[usize::from(k)];
        // Each sphere of a side is among these corners.
        let far = far(p.0).max(far(q.0)).max(far(r.0));
        near(p.1).min(near(q.1)).min(near(r.1)).min(near(s.1)) - far
    }

    /// Whether the direction keeps all centres apart, by more than rounding.
    fn keeps_axes_apart(&self, a: &[Ball<S>], b: &[Ball<S>]) -> bool {
        let size = |s: &[Ball<S>]| s.iter().fold(S::zero(), |sum, s| sum + s.0.taxicab());
        let far = a.iter().map(|s| self.n.dot(s.0)).reduce(S::max);
        let near = b.iter().map(|s| self.n.dot(s.0)).reduce(S::min);
        let rounding = S::splat(ROUNDING_ULPS * S::EPSILON) * (size(a) + size(b));
        far.zip(near)
            .is_some_and(|(far, near)| near - far > rounding)
    }
}
