//! Penetration depth against a search over all directions.

use crate::ccd::distance::Corners;
use crate::ccd::rng::Rng;
use nalgebra::Vector3;
use rapier3d_medial::elementary::penetration::{Ball, deepest};
use rapier3d_medial::math::lane::{Scalar, Vec3};

/// Directions of a first look: neighbours are 0.07 apart.
const DIRECTIONS: usize = 2500;

/// Best directions of the first look that are followed up.
const FOLLOWED: usize = 20;

/// Evenly spread unit vectors: a Fibonacci lattice.
fn lattice(k: usize) -> Vector3<f64> {
    let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
    let angle = k as f64 * std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let across = (1.0 - z * z).sqrt();
    Vector3::new(across * angle.cos(), across * angle.sin(), z)
}

/// A lower bound of the largest gap over all unit directions, sharp unless a narrow peak hides
/// between the directions looked at.
fn largest_gap(corners: &Corners, rng: &mut Rng) -> f64 {
    let mut found: Vec<_> = (0..DIRECTIONS)
        .map(|k| (corners.support(&lattice(k)), lattice(k)))
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let follow = |&(mut gap, mut n): &(f64, Vector3<f64>)| {
        let mut step = 0.07;
        let mut failures = 0;
        while step > 1.0e-10 {
            let trial = (n + rng.in_ball() * step).normalize();
            let trial_gap = corners.support(&trial);
            if trial_gap > gap {
                (gap, n, failures) = (trial_gap, trial, 0);
            } else {
                failures += 1;
            }
            if failures == 12 {
                (step, failures) = (0.5 * step, 0);
            }
        }
        gap
    };
    found[..FOLLOWED]
        .iter()
        .map(follow)
        .fold(f64::NEG_INFINITY, f64::max)
}

type Spheres = Vec<(Vector3<f64>, f64)>;

fn convert<S: Scalar>(spheres: &Spheres) -> Vec<Ball<S>> {
    let convert = |(c, r): &(Vector3<f64>, f64)| {
        let [x, y, z] = [c.x, c.y, c.z].map(S::splat);
        (Vec3::new(x, y, z), S::splat(*r))
    };
    spheres.iter().map(convert).collect()
}

/// The reported direction has the reported gap, and none found by search has more.
fn check<S: Scalar>(a: &Spheres, b: &Spheres, rng: &mut Rng) {
    let mut corners = Corners::new();
    for (c1, r1) in a {
        for (c2, r2) in b {
            corners.push(c2 - c1, r1 + r2);
        }
    }
    // A gap is a sum of 8 rounded terms at most; a direction given by N/|N| and the slopes loses
    // digits as the edges become parallel, which the bodies drawn are not.
    let close = 1.0e3 * S::EPSILON * corners.scale();
    let preferred = Vec3::new(S::one(), S::zero(), S::zero());
    let (gap, n) = deepest(&convert::<S>(a), &convert::<S>(b), preferred);
    let n = Vector3::new(n.x.to_f64(), n.y.to_f64(), n.z.to_f64());
    assert!((n.norm() - 1.0).abs() < 16.0 * S::EPSILON, "{n:?}");
    let along = corners.support(&n);
    assert!(
        (along - gap.to_f64()).abs() < close,
        "{along} {}",
        gap.to_f64()
    );
    let best = largest_gap(&corners, rng);
    assert!(
        along >= best - close,
        "{along} but {best} is possible: {a:?} {b:?}"
    );
}

/// Primitives whose medial surfaces cross at the origin, in every combination that can: an edge
/// crosses a triangle, two triangles cross; and two edges, which meet in a point.
#[test]
fn crossing_surfaces() {
    let mut rng = Rng::new(1);
    for k in 0..600 {
        let counts = [[3, 3], [3, 2], [2, 3], [2, 2]][k % 4];
        let mut around = |count: usize| -> Spheres {
            let (u, v) = (rng.direction(), rng.direction());
            let (x, y) = (rng.range(0.2, 1.0), rng.range(0.2, 1.0));
            let centers = if count == 2 {
                vec![u, -u * x]
            } else {
                vec![u, v, -u * x - v * y]
            };
            let sphere = |c| (c, rng.log_range(1.0e-3, 0.4));
            centers.into_iter().map(sphere).collect()
        };
        let (a, b) = (around(counts[0]), around(counts[1]));
        check::<f64>(&a, &b, &mut rng);
        check::<f32>(&a, &b, &mut rng);
    }
}
