//! The judge convicts wrong answers, and only those.

use crate::ccd::judge::{Answer, Truth};
use crate::ccd::motion::{Ball, Motion, Query};
use nalgebra::Vector3;
use rapier3d_medial::elementary::ToiStatus;
use std::time::Duration;

const TOLERANCE: f64 = 1.0e-4;
const WIDTH: f64 = 1.0e-6;

/// Unit spheres, `gap` apart along x, the second moving `speed` towards the first.
fn approach(gap: f64, speed: f64) -> Truth {
    let ball = |x: f64, speed: f64| Ball {
        center: Vector3::x() * x,
        radius: 1.0,
        displacement: -Vector3::x() * speed,
    };
    let balls = [vec![ball(0.0, 0.0)], vec![ball(2.0 + gap, speed)]];
    let motion = Motion::Straight;
    Truth::new(&Query { balls, motion }, 0.0)
}

fn answer(status: ToiStatus, lower: f64, upper: f64) -> Answer {
    Answer {
        status,
        lower,
        upper,
        tolerance: TOLERANCE,
        iterations: 1,
        time: Duration::ZERO,
    }
}

#[test]
fn right_answers_pass() {
    let hit = approach(1.0, 2.0);
    let verdict = hit.judge(&answer(ToiStatus::Contact, 0.5 - 1.0e-7, 0.5), WIDTH);
    assert!(!verdict.missed && !verdict.false_hit && !verdict.misnamed && !verdict.wide);
    assert_eq!(verdict.late, 0.0);
    // Told before the tolerance is reached: as early as nothing, then by 0.1.
    assert_eq!(verdict.early, Some(0.0));
    let verdict = hit.judge(&answer(ToiStatus::Contact, 0.4, 0.5), WIDTH);
    assert!((verdict.early.unwrap() - (0.1 - 0.5 * TOLERANCE)).abs() < 1.0e-9);

    assert!(
        !approach(1.0, 0.5)
            .judge(&answer(ToiStatus::Separated, 1.0, 1.0), WIDTH)
            .missed
    );
    let overlap = approach(-1.0, 0.0).judge(&answer(ToiStatus::Overlapping, 0.0, 0.0), WIDTH);
    assert!(!overlap.misnamed && !overlap.false_hit && overlap.late == 0.0);
}

#[test]
fn wrong_answers_are_caught() {
    let hit = approach(1.0, 2.0);
    assert!(
        hit.judge(&answer(ToiStatus::Separated, 1.0, 1.0), WIDTH)
            .missed
    );
    // Late by 1e-9 of the step, in any status that carries a time.
    for status in [ToiStatus::Contact, ToiStatus::Unresolved] {
        let late = hit
            .judge(&answer(status, 0.5 + 1.0e-9, 0.5 + 1.0e-9), WIDTH)
            .late;
        assert!((late - 1.0e-9).abs() < 1.0e-10, "{late:e}");
    }
    // Apart by 1.001 tolerances at `upper`.
    let upper = 0.5 - 0.5 * 1.001 * TOLERANCE;
    assert!(
        hit.judge(&answer(ToiStatus::Contact, upper, upper), WIDTH)
            .false_hit
    );
    assert!(
        hit.judge(&answer(ToiStatus::Contact, 0.5 - 2.0e-6, 0.5), WIDTH)
            .wide
    );
    assert!(
        hit.judge(&answer(ToiStatus::Overlapping, 0.0, 0.0), WIDTH)
            .false_hit
    );

    let overlap = approach(-1.0, 0.0);
    assert!(
        overlap
            .judge(&answer(ToiStatus::Contact, 0.0, 0.0), WIDTH)
            .misnamed
    );
    assert!(
        overlap
            .judge(&answer(ToiStatus::Overlapping, 0.0, 0.1), WIDTH)
            .misnamed
    );
    assert!(
        overlap
            .judge(&answer(ToiStatus::Separated, 1.0, 1.0), WIDTH)
            .missed
    );
}

/// Corners of a body without thickness that moves straight.
fn thin(corners: &[[f64; 3]], displacement: [f64; 3]) -> Vec<Ball> {
    let ball = |c: &[f64; 3]| Ball {
        center: Vector3::from(*c),
        radius: 0.0,
        displacement: Vector3::from(displacement),
    };
    corners.iter().map(ball).collect()
}

/// Bodies without thickness are in contact for a moment, or where one is in the other. They meet, or pass each other
/// at a distance, at a planted time; a hit is told after it by no more than rounding makes of it.
#[test]
fn bodies_without_thickness_meet_when_they_do() {
    let triangle = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.2, 0.0, 1.5]];
    let across = [[-1.0, 0.0, 0.3], [1.0, 0.0, 0.1]];
    let along = [[0.1, 0.0, -2.0], [0.1, 0.0, 2.0]];
    let point = [[0.1, 0.0, 0.1]];
    let hanging = [[0.1, 0.0, 0.1], [0.1, -3.0, 0.1]];
    let leaning = [[0.1, 0.0, 0.1], [0.1, 3.0, 0.1], [2.0, 2.0, 0.1]];
    type Corners<'a> = &'a [[f64; 3]];
    let cases: [(Corners, Corners); 5] = [
        (&across, &along),
        (&triangle, &point),
        (&point, &triangle),
        (&triangle, &hanging),
        (&leaning, &triangle),
    ];
    for (a, b) in cases {
        for speed in [1.0e-3, 1.0, 100.0] {
            for beside in [0.0, 10.0] {
                let at = |c: [f64; 3]| [c[0] + beside, c[1] + 0.4 * speed, c[2]];
                let a = thin(
                    &a.iter().copied().map(at).collect::<Vec<_>>(),
                    [0.0, -speed, 0.0],
                );
                let balls = [a, thin(b, [0.0; 3])];
                let motion = Motion::Straight;
                let truth = Truth::new(&Query { balls, motion }, 0.0);
                let contact = truth.contact.contact_at;
                if beside > 0.0 {
                    assert_eq!(contact, None, "speed {speed}");
                    continue;
                }
                let contact = contact.expect("they meet");
                assert!(
                    contact >= 0.4 && contact < 0.4 + 1.0e-11 * (1.0 + speed) / speed,
                    "{contact}, {speed}"
                );
            }
        }
    }
    // Crossed from the start, and never.
    for shift in [0.0, 0.5] {
        let a = [
            [0.1, -1.0 + 4.0 * shift, 0.1],
            [0.1, 1.0 + 4.0 * shift, 0.1],
        ];
        let balls = [thin(&a, [0.0, 1.0e-3, 0.0]), thin(&triangle, [0.0; 3])];
        let motion = Motion::Straight;
        let truth = Truth::new(&Query { balls, motion }, 0.0);
        assert_eq!(truth.contact.contact_at, (shift == 0.0).then_some(0.0));
    }
}
