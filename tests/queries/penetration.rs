//! Penetration depth against a search over all directions.

use crate::ccd::distance::{Corners, Goal, distance};
use crate::ccd::rng::Rng;
use nalgebra::Vector3;
use rapier3d_medial::elementary::distance::Ball;
use rapier3d_medial::elementary::penetration::deepest;
use rapier3d_medial::elementary::{MovingSphere, first_contact};
use rapier3d_medial::math::lane::{Scalar, Vec3};
use rapier3d_medial::math::{Pose, Vector};
use rapier3d_medial::pair::{PrimitiveList, SpherePair, contacts};
use rapier3d_medial::{MedialSphere, ToiOptions};

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
/// between the directions looked at. `finest`: the change of direction, in radians, at which the
/// search ends.
pub fn largest_gap(corners: &Corners, finest: f64, rng: &mut Rng) -> f64 {
    let mut found: Vec<_> = (0..DIRECTIONS)
        .map(|k| (corners.support(&lattice(k)), lattice(k)))
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let follow = |&(mut gap, mut n): &(f64, Vector3<f64>)| {
        let mut step = 0.07;
        let mut failures = 0;
        while step > finest {
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

fn differences(a: &Spheres, b: &Spheres) -> Corners {
    let mut corners = Corners::new();
    for (c1, r1) in a {
        for (c2, r2) in b {
            corners.push(c2 - c1, r1 + r2);
        }
    }
    corners
}

/// The reported direction has the reported gap, and none found by search has more.
fn check<S: Scalar>(a: &Spheres, b: &Spheres, rng: &mut Rng) {
    let corners = differences(a, b);
    // A gap is a sum of 8 rounded terms at most; a direction given by N/|N| and the slopes loses
    // digits as the edges become parallel, which the bodies drawn are not.
    let close = 1.0e3 * S::EPSILON * corners.scale();
    let preferred = Vec3::new(S::one(), S::zero(), S::zero());
    let (gap, n) = deepest(&convert::<S>(a), &convert::<S>(b), preferred, S::zero());
    let n = Vector3::new(n.x.to_f64(), n.y.to_f64(), n.z.to_f64());
    assert!((n.norm() - 1.0).abs() < 16.0 * S::EPSILON, "{n:?}");
    let along = corners.support(&n);
    assert!(
        (along - gap.to_f64()).abs() < close,
        "{along} {}",
        gap.to_f64()
    );
    let best = largest_gap(&corners, 1.0e-10, rng);
    assert!(
        along >= best - close,
        "{along} but {best} is possible: {a:?} {b:?}"
    );
}

/// Primitives whose medial surfaces cross at the origin, in every combination that can: an edge
/// crosses a triangle, two triangles cross; and two edges, which meet in a point.
#[test]
fn crossing_surfaces_are_as_deep_as_a_search_finds() {
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

/// How two slabs of [`slab_pair`] lie.
const LIES: [&str; 8] = [
    "crossing",
    "overlapping",
    "thin",
    "in one plane",
    "nearly parallel",
    "disparate",
    "edges parallel",
    "the same",
];

/// Two slabs of size 1 near each other, in numbers that `f32` holds.
fn slab_pair(lie: &str, rng: &mut Rng) -> [Spheres; 2] {
    let mut triangle = |flat: f64| -> Vec<Vector3<f64>> {
        let mut corner = || {
            let mut c = rng.direction() * rng.range(0.3, 1.0);
            c.z *= flat;
            c
        };
        let corners = [corner(), corner(), corner()];
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        corners.map(|c| c - middle).to_vec()
    };
    let flat = match lie {
        "in one plane" => 0.0,
        "nearly parallel" => 0.01,
        _ => 1.0,
    };
    let (a, mut b) = (triangle(flat), triangle(flat));
    let shift = match lie {
        "crossing" => Vector3::zeros(),
        "in one plane" => Vector3::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3), 0.0),
        _ => rng.in_ball() * 0.5,
    };
    match lie {
        "edges parallel" => b[1] = b[0] + (a[1] - a[0]) * rng.range(0.5, 1.5),
        "the same" => b = a.clone(),
        _ => b.iter_mut().for_each(|c| *c += shift),
    }
    let mut thick = |centers: Vec<Vector3<f64>>| -> Spheres {
        let even = rng.log_range(0.02, 0.3);
        let radius = |rng: &mut Rng| match lie {
            "thin" => rng.log_range(1.0e-4, 1.0e-2),
            "disparate" => rng.log_range(1.0e-3, 1.5),
            "in one plane" | "the same" if even < 0.1 => even,
            _ => rng.log_range(0.01, 0.4),
        };
        let ball = |c: Vector3<f64>| {
            (
                c.map(|x| f64::from(x as f32)),
                f64::from(radius(rng) as f32),
            )
        };
        centers.into_iter().map(ball).collect()
    };
    [thick(a), thick(b)]
}

/// Ten thousand overlapping pairs of slabs, however they lie: none is called apart, and no search
/// over all directions finds a smaller depth by more than 1e-4 of their size.
#[test]
fn ten_thousand_overlapping_slabs_are_as_deep_as_a_search_finds() {
    const PAIRS: usize = 10_000;
    const CLOSE: f64 = 1.0e-4;
    let mut rng = Rng::new(3);
    let (mut pairs, mut blunt, mut failures) = (0, 0, Vec::new());
    let (mut crossed, mut worst) = (0, 0.0_f64);
    for k in 0.. {
        if pairs == PAIRS {
            break;
        }
        let lie = LIES[k % LIES.len()];
        let [a, b] = slab_pair(lie, &mut rng);
        let corners = differences(&a, &b);
        if distance(&corners, Goal::Side(0.0)).upper >= 0.0 {
            continue;
        }
        pairs += 1;
        let best = largest_gap(&corners, 1.0e-6, &mut rng) / corners.scale();
        let preferred = Vec3::new(1.0, 0.0, 0.0);
        let (gap, n) = deepest(&convert::<f64>(&a), &convert::<f64>(&b), preferred, 0.0);
        let n = Vector3::new(n.x, n.y, n.z);
        let along = corners.support(&n) / corners.scale();
        let gap = gap / corners.scale();
        worst = worst.max(best - along);
        if !(gap < 0.0 && (gap - along).abs() < CLOSE && along > best - CLOSE) {
            failures.push(format!(
                "{lie}: {gap}, {along} along {n:?}, {best}: {a:?} {b:?}"
            ));
        }
        // The search found less than a direction that is there.
        blunt += usize::from(along > best + CLOSE);
        let toi = first_contact(&at_rest(&a), &at_rest(&b), &ToiOptions::default());
        if toi.upper > 0.0 {
            failures.push(format!("{lie}: {:?} at the start: {a:?} {b:?}", toi.status));
        }
        let found = contacts_of(&a, &b);
        crossed += usize::from(found.iter().any(|c| c.feature == 1 << 17));
        let least = found.iter().map(|c| c.distance).fold(f32::MAX, f32::min);
        let apart = f64::from(least) / corners.scale() - best;
        if !(apart.abs() < CLOSE || apart > 0.0 && along > best + CLOSE) {
            failures.push(format!(
                "{lie}: contact {least}, off by {apart}: {a:?} {b:?}"
            ));
        }
    }
    println!("{crossed} of {pairs} cross; {worst:.1e} less than the search; {blunt} times more");
    assert!(
        failures.is_empty(),
        "{}: {:#?}",
        failures.len(),
        &failures[..failures.len().min(10)]
    );
    assert!(
        (PAIRS * 3 / 10..PAIRS * 7 / 10).contains(&crossed),
        "{crossed} cross"
    );
    assert!(blunt <= PAIRS / 100, "the search missed {blunt}");
}

fn sphere((c, r): &(Vector3<f64>, f64)) -> MedialSphere {
    MedialSphere::new(Vector::new(c.x as f32, c.y as f32, c.z as f32), *r as f32)
}

fn at_rest(spheres: &Spheres) -> Vec<MovingSphere> {
    let still = |s: &(Vector3<f64>, f64)| {
        let MedialSphere { center, radius } = sphere(s);
        MovingSphere {
            center,
            radius,
            displacement: Vector::ZERO,
        }
    };
    spheres.iter().map(still).collect()
}

fn contacts_of(a: &Spheres, b: &Spheres) -> Vec<SpherePair> {
    let soup = |s: &Spheres| {
        let mut soup = PrimitiveList::default();
        soup.push(&s.iter().map(sphere).collect::<Vec<_>>());
        soup
    };
    contacts(&soup(a), &soup(b), &Pose::IDENTITY, 0.0).0
}

/// Spheres strung on one axis leave the direction across it open. Seen from the axis all is a function
/// of `x = n·axis` alone, which a table of `x` maximises; and of two equal directions the one nearest
/// to the preferred is given.
#[test]
fn spheres_on_one_axis_are_left_across_it() {
    const STEPS: i32 = 20_000;
    let mut rng = Rng::new(5);
    for k in 0..400 {
        let axis = rng.direction();
        let counts = [[1, 1], [1, 2], [2, 1], [2, 2]][k % 4];
        let mut strung = |count: usize| -> Spheres {
            let (from, to) = (rng.range(-0.9, -0.1), rng.range(0.1, 0.9));
            let radius = rng.log_range(0.02, 0.5);
            let other = if rng.chance(0.5) {
                radius
            } else {
                rng.log_range(0.02, 0.5)
            };
            match count {
                1 => vec![(Vector3::zeros(), radius)],
                _ => vec![(axis * from, radius), (axis * to, other)],
            }
        };
        let (a, b) = (strung(counts[0]), strung(counts[1]));
        let corners = differences(&a, &b);
        let across = rng.direction().cross(&axis).normalize();
        let along = |i: i32| {
            let x = f64::from(i) / f64::from(STEPS);
            corners.support(&(axis * x + across * (1.0 - x * x).sqrt()))
        };
        let best = (-STEPS..=STEPS).map(along).fold(f64::MIN, f64::max);
        let lean = rng.range(-2.0, 2.0) * rng.below(2) as f64;
        let wish = [axis, across + axis * lean, Vector3::zeros()][k / 4 % 3];
        let preferred = Vec3::new(wish.x, wish.y, wish.z);
        let (gap, n) = deepest(&convert::<f64>(&a), &convert::<f64>(&b), preferred, 0.0);
        let n = Vector3::new(n.x, n.y, n.z);
        assert!((n.norm() - 1.0).abs() < 1.0e-12, "{n:?}");
        assert!(
            (corners.support(&n) - gap).abs() < 1.0e-12,
            "{gap} along {n:?}"
        );
        // A step of the table changes the gap by at most the corners' extent times it.
        let close = 4.0 * corners.scale() / f64::from(STEPS);
        assert!(
            (gap - best).abs() < close,
            "{gap}, but {best}: {a:?} {b:?}, {wish:?}"
        );
        let aside = n.cross(&axis).cross(&axis).normalize();
        let free = n.cross(&axis).norm() > 0.01 && k / 4 % 3 == 1;
        assert!(!free || aside.dot(&across) < -0.999, "{n:?} but {wish:?}");
    }
}
