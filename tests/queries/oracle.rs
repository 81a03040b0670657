//! The oracle against closed forms, planted answers and a second method.

use crate::ccd::contact::{FirstContact, RESOLUTION, distance_at, first_contact};
use crate::ccd::distance::{Corners, Goal, distance};
use crate::ccd::families::Family;
use crate::ccd::motion::{Ball, Motion, Paths, Query, Rigid};
use crate::ccd::rng::Rng;
use nalgebra::Vector3;

/// Rounding of a closed form and of the oracle together, relative to the numbers that go in.
const ROUNDING: f64 = 1.0e-13;

fn ball(center: Vector3<f64>, radius: f64) -> Ball {
    Ball {
        center,
        radius,
        displacement: Vector3::zeros(),
    }
}

fn still(a: &[Ball], b: &[Ball]) -> Paths {
    Paths::new(&Query {
        balls: [a.to_vec(), b.to_vec()],
        motion: Motion::Straight,
    })
}

fn assert_distance(paths: &Paths, expected: f64) {
    let (lower, upper) = distance_at(paths, 0.0);
    assert!(
        lower <= expected + ROUNDING && expected <= upper + ROUNDING,
        "{lower} {upper} {expected}"
    );
    assert!(upper - lower < 1.0e-11, "{lower} {upper}");
}

fn assert_contact(found: FirstContact, expected: Option<f64>) {
    match expected {
        None => assert!(
            found.contact_at.is_none() && found.free_until == 1.0,
            "{found:?}"
        ),
        Some(time) => {
            let at = found
                .contact_at
                .unwrap_or_else(|| panic!("{found:?}, not {time}"));
            // Contact at `time` is closed to rounding of √: near grazing it has half the digits.
            assert!((at - time).abs() < 1.0e-9, "{found:?}, not {time}");
            assert!(
                found.free_until <= at && at - found.free_until < 1.0e-9,
                "{found:?}"
            );
        }
    }
}

/// Bounds meet for every family, at the start and within the step, in all degenerate forms; to
/// less where surfaces that were made to cross nearly touch after rounding.
#[test]
fn bounds_of_the_distance_meet() {
    let mut rng = Rng::new(1);
    for family in Family::ALL {
        let mut worst: f64 = 0.0;
        for k in 0..1800 {
            let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
            let time = [0.0, rng.range(0.0, 1.0)][k / 18 % 2];
            let corners = Paths::new(&query).at(time);
            let found = distance(&corners, Goal::Value);
            worst = worst.max((found.upper - found.lower) / corners.scale());
        }
        let meet = match family {
            Family::Overlapping => 1.0e-7,
            _ => 1.0e-11,
        };
        assert!(worst < meet, "{family:?}: {worst:e}");
    }
}

/// |c1 − c2| − r1 − r2, also for concentric and for enclosed spheres.
#[test]
fn spheres_are_as_far_as_their_centres_less_their_radii() {
    let mut rng = Rng::new(2);
    for _ in 0..1000 {
        let (c1, c2) = (rng.in_ball(), rng.in_ball() * [0.0, 1.0][rng.below(2)]);
        let (r1, r2) = (rng.range(0.0, 2.0), rng.range(0.0, 2.0));
        let paths = still(&[ball(c1, r1)], &[ball(c2, r2)]);
        assert_distance(&paths, (c1 - c2).norm() - r1 - r2);
    }
}

/// Two slabs of constant radii whose triangles cross: the distance is −(r1 + r2), at the crossing.
#[test]
fn crossing_slabs_are_as_deep_as_the_sum_of_their_radii() {
    let mut rng = Rng::new(3);
    for _ in 0..1000 {
        let (r1, r2) = (rng.range(0.0, 0.3), rng.range(0.0, 0.3));
        // Three points around the common origin, in each of two planes.
        let mut around = |radius| {
            let (u, v) = (rng.direction(), rng.direction());
            let (x, y) = (rng.range(0.2, 1.0), rng.range(0.2, 1.0));
            [u, v, -u * x - v * y].map(|c| ball(c, radius))
        };
        let paths = still(&around(r1), &around(r2));
        assert_distance(&paths, -(r1 + r2));
    }
}

/// Sphere and cone by golden-section search over the cone's parameter.
#[test]
fn sphere_and_cone_are_as_far_as_a_search_finds() {
    let mut rng = Rng::new(4);
    for _ in 0..1000 {
        let ends = [
            ball(rng.in_ball(), rng.range(0.0, 0.5)),
            ball(rng.in_ball(), rng.range(0.0, 0.5)),
        ];
        let (center, radius) = (rng.in_ball() * 2.0, rng.range(0.0, 0.5));
        let at = |x: f64| {
            let c = ends[0].center.lerp(&ends[1].center, x);
            (c - center).norm() - radius - ends[0].radius * (1.0 - x) - ends[1].radius * x
        };
        let (mut low, mut high) = (0.0, 1.0);
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        for _ in 0..80 {
            let (x1, x2) = (high - golden * (high - low), low + golden * (high - low));
            if at(x1) < at(x2) { high = x2 } else { low = x1 }
        }
        let expected = at(0.5 * (low + high)).min(at(0.0)).min(at(1.0));
        assert_distance(&still(&ends, &[ball(center, radius)]), expected);
    }
}

/// Two spheres on straight paths: the smaller root of |y + t d|² = R².
#[test]
fn spheres_in_flight_meet_at_the_smaller_root() {
    let mut rng = Rng::new(5);
    let mut hits = 0;
    for _ in 0..2000 {
        let mut make = || Ball {
            center: rng.in_ball() * 2.0,
            radius: rng.range(0.01, 0.4),
            displacement: rng.in_ball(),
        };
        let (a, mut b) = (make(), make());
        // Aimed, more or less.
        b.displacement += (a.center - b.center) * 1.5;
        let (y, d, r) = (
            a.center - b.center,
            a.displacement - b.displacement,
            a.radius + b.radius,
        );
        let (p, q) = (y.dot(&d), y.norm_squared() - r * r);
        let root = (p * p - d.norm_squared() * q).sqrt();
        let time = q / (root - p);
        let expected = if q <= 0.0 {
            Some(0.0)
        } else {
            (p < 0.0 && time <= 1.0).then_some(time)
        };
        hits += usize::from(expected.is_some());
        assert_contact(first_contact(&still(&[a], &[b]), 0.0), expected);
    }
    assert!((600..1400).contains(&hits), "{hits}");
}

/// A sphere that flies straight at a cone. With half angle θ, sin θ = (r0 − r1)/L, the point of the
/// mantle at height z is `x cos θ + z sin θ − r0` away from a centre at (x, z).
#[test]
fn a_flying_sphere_meets_a_cone_where_the_formula_says() {
    let mut rng = Rng::new(6);
    for _ in 0..1000 {
        let (r0, r1) = (rng.range(0.1, 0.5), rng.range(0.1, 0.5));
        let (length, radius) = (rng.range(1.0, 3.0), rng.range(0.0, 0.5));
        let sin = (r0 - r1) / length;
        let cos = (1.0 - sin * sin).sqrt();
        let (start, height, speed) = (rng.range(2.0, 4.0), 0.5 * length, rng.range(1.0, 5.0));
        let cone = [ball(Vector3::zeros(), r0), ball(Vector3::z() * length, r1)];
        let mut sphere = ball(Vector3::new(start, 0.0, height), radius);
        sphere.displacement = -Vector3::x() * speed;
        let gone = (start - (r0 + radius - height * sin) / cos) / speed;
        let paths = still(&cone, &[sphere]);
        assert_contact(first_contact(&paths, 0.0), (gone <= 1.0).then_some(gone));
    }
}

/// A sphere that turns about the origin, past one at rest: |c − p|² = ρ² + p² − 2ρp cos(φ − ωt).
#[test]
fn a_turning_sphere_meets_one_at_rest_when_the_formula_says() {
    let mut rng = Rng::new(7);
    let mut later = 0;
    for _ in 0..1000 {
        let (arm, far) = (rng.range(0.5, 2.0), rng.range(0.5, 2.0));
        let (r1, r2) = (rng.range(0.01, 0.3), rng.range(0.01, 0.3));
        let (angle, turn) = (rng.range(0.0, 6.0), rng.range(0.01, 6.2));
        let seconds = rng.log_range(1.0e-3, 10.0);
        let rest = Rigid {
            translation: rng.in_ball() * 10.0,
            rotation: [0.0, 0.0, 0.0, 1.0],
            local_center: Vector3::zeros(),
            linvel: Vector3::zeros(),
            angvel: Vector3::zeros(),
        };
        // The turning body's frame has its own origin; only the centre of rotation stays.
        let local_center = rng.in_ball();
        let turning = Rigid {
            translation: rest.translation - local_center,
            local_center,
            angvel: Vector3::z() * (turn / seconds),
            ..rest
        };
        let a = ball(local_center + Vector3::x() * arm, r1);
        let b = ball(Vector3::new(angle.cos(), angle.sin(), 0.0) * far, r2);
        let query = Query {
            balls: [vec![a], vec![b]],
            motion: Motion::Rigid(Box::new([turning, rest]), seconds),
        };
        // Contact while φ − ωt is within `half` of a multiple of 2π.
        let cos = (arm * arm + far * far - (r1 + r2) * (r1 + r2)) / (2.0 * arm * far);
        let half = cos.acos();
        let expected = if cos >= 1.0 {
            None
        } else if angle <= half || angle >= std::f64::consts::TAU - half {
            Some(0.0)
        } else {
            Some((angle - half) / turn).filter(|t| *t <= 1.0)
        };
        later += usize::from(expected.is_some_and(|t| t > 0.0));
        assert_contact(first_contact(&Paths::new(&query), 0.0), expected);
    }
    assert!((100..900).contains(&later), "{later}");
}

/// Conservative advancement by the Lipschitz constant of the distance, which shares only the
/// distance with the oracle: the first time at which it is at most `near`.
fn advance(query: &Query, paths: &Paths, near: f64) -> Option<f64> {
    let speed: f64 = match &query.motion {
        Motion::Straight => {
            let fastest = |balls: &[Ball]| {
                balls
                    .iter()
                    .map(|b| b.displacement.norm())
                    .fold(0.0, f64::max)
            };
            query.balls.iter().map(|balls| fastest(balls)).sum()
        }
        Motion::Rigid(motions, seconds) => [0, 1]
            .map(|i| {
                let m = &motions[i];
                let arm = |b: &Ball| (b.center - m.local_center).norm();
                let arm = query.balls[i].iter().map(arm).fold(0.0, f64::max);
                (m.linvel.norm() + m.angvel.norm() * arm) * seconds
            })
            .iter()
            .sum(),
    };
    let mut time = 0.0;
    while time <= 1.0 {
        let (lower, _) = distance_at(paths, time);
        if lower <= near {
            return Some(time);
        }
        time += lower / speed.max(f64::MIN_POSITIVE);
    }
    None
}

/// No dip is skipped and none is invented: two methods agree on the first time at which the
/// distance is at most 1e-3 of the size, for every family but the one of crossings so fast that
/// small steps take too long.
#[test]
fn small_steps_find_the_same_contact() {
    let mut rng = Rng::new(8);
    let mut hits = 0;
    for family in Family::ALL
        .into_iter()
        .filter(|family| *family != Family::Fast)
    {
        let near = 1.0e-3 * family.size();
        for k in 0..90 {
            let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
            let paths = Paths::new(&query);
            let found = first_contact(&paths, near);
            // Small steps stop short of contact at a time at which the distance is below `near`,
            // having proven that it was above 0 before.
            match advance(&query, &paths, near) {
                None => assert!(found.contact_at.is_none(), "{family:?} {found:?} {query:?}"),
                Some(time) => {
                    hits += 1;
                    assert!(
                        found.free_until <= time + RESOLUTION,
                        "{family:?} {query:?}"
                    );
                    let deep = first_contact(&paths, 0.0);
                    let no_sooner = deep.contact_at.is_none_or(|at| at >= time - RESOLUTION);
                    assert!(no_sooner, "{family:?} {deep:?} {time} {query:?}");
                }
            }
        }
    }
    assert!(hits > 600, "{hits}");
}

/// Weights that prove the upper bound are weights: not negative, sum 1.
#[test]
fn weights_are_not_negative_and_sum_to_one() {
    let mut rng = Rng::new(9);
    for _ in 0..1000 {
        let mut corners = Corners::new();
        for _ in 0..1 + rng.below(18) {
            corners.push(rng.in_ball(), rng.range(0.0, 0.5));
        }
        let found = distance(&corners, Goal::Value);
        assert!(found.weights.iter().all(|w| *w >= 0.0));
        assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < ROUNDING);
        assert!(found.normal.norm() <= 1.0 + ROUNDING);
    }
}
