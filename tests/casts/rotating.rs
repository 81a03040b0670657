//! Exact rigid motion: never missed, never late, at contact distance when hit, in both orders.

use crate::oracle::{COARSE_CUTS, CUTS, FINE_CUTS, Samples, Scene, stand_in};
use crate::rng::Rng;
use crate::shapes::{every_shape, ring};
use parry3d::math::{Pose, Real, Rotation, Vector};
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher, ShapeCastStatus};
use rapier3d_medial::{MedialDispatcher, MedialMesh, ToiOptions};

const CASES: usize = 60;
const MOMENTS: usize = 400;

/// Largest angle in radians that a body turns in the step.
const TURN: f64 = 2.0;

pub fn vector(v: nalgebra::Vector3<f64>) -> Vector {
    Vector::new(v.x as Real, v.y as Real, v.z as Real)
}

pub fn rotation(rng: &mut Rng) -> Rotation {
    Rotation::from_scaled_axis(vector(
        rng.direction() * rng.range(0.0, std::f64::consts::PI),
    ))
}

fn motions(rng: &mut Rng, aim: f64) -> [NonlinearRigidMotion; 2] {
    let from = vector(rng.direction() * rng.range(2.5, 4.0));
    let to = vector(rng.in_ball() * aim);
    let drift = vector(rng.in_ball());
    let turning = |rng: &mut Rng, at: Vector, velocity: Vector| NonlinearRigidMotion {
        start: Pose::from_parts(at, rotation(rng)),
        local_center: vector(rng.in_ball() * 0.3),
        linvel: velocity,
        angvel: vector(rng.in_ball() * TURN),
    };
    let travel = rng.range(0.6, 1.6) as Real;
    [
        turning(rng, from, (to - from) * travel + drift),
        turning(rng, Vector::ZERO, drift),
    ]
}

#[test]
fn every_shape_in_rotation_is_hit_neither_late_nor_never() {
    let mesh = ring();
    let samples = Samples::new(&mesh, CUTS);
    let fine = Samples::new(&mesh, FINE_CUTS);
    let coarse = Samples::new(&mesh, COARSE_CUTS);
    let dispatcher = MedialDispatcher::default();
    let mut failures = Vec::new();
    for (i, (name, shape, aim)) in every_shape().iter().enumerate() {
        let measured = stand_in(shape);
        let mut rng = Rng::new(100 + i as u64);
        let (mut cases, mut hits) = (0, 0);
        let started = std::time::Instant::now();
        let other_samples = shape.as_shape::<MedialMesh>().map(|_| &coarse);
        while cases < CASES {
            let [motion1, motion2] = motions(&mut rng, *aim);
            let scene = Scene {
                samples: &samples,
                fine: &fine,
                other: measured.as_ref(),
                other_samples,
                motions: [&motion1, &motion2],
                target: 0.0,
                end: 1.0,
                moments: MOMENTS,
            };
            // Starts well apart: what starts inside has its own tests.
            if scene.distance(0.0, 0.1) < 0.05 {
                continue;
            }
            cases += 1;
            let cast = |flipped: bool| {
                let (g1, g2): (&dyn parry3d::shape::Shape, _) = (&mesh, shape.as_ref());
                let hit = if flipped {
                    dispatcher
                        .cast_shapes_nonlinear(&motion2, g2, &motion1, g1, 0.0, 1.0, true)
                        .map(|h| h.map(|h| h.swapped()))
                } else {
                    dispatcher.cast_shapes_nonlinear(&motion1, g1, &motion2, g2, 0.0, 1.0, true)
                };
                hit.expect("every built-in shape is swept")
            };
            let results = [cast(false), cast(true)];
            hits += usize::from(results[0].is_some());
            let tolerance = ToiOptions::default().tolerance;
            for hit in &results {
                if let Err(e) = scene.judge(hit.as_ref(), tolerance) {
                    failures.push(format!("{name} {cases}: {e}"));
                }
                let unresolved = |s| s == ShapeCastStatus::OutOfIterations;
                if hit.is_some_and(|h| unresolved(h.status)) {
                    failures.push(format!("{name} {cases}: unresolved {hit:?}"));
                }
            }
            let times = results.map(|h| h.map(|h| h.time_of_impact));
            let [a, b] = times.map(|t| t.unwrap_or(1.0));
            if results[0].is_some() == results[1].is_some() && (a - b).abs() > 1.0e-3 {
                failures.push(format!("{name} {cases}: the order matters, {times:?}"));
            }
        }
        println!("{name}: {hits} of {CASES} hit, {:?}", started.elapsed());
        if !(CASES * 3 / 10..=CASES * 7 / 10).contains(&hits) {
            failures.push(format!("{name}: {hits} of {CASES} hit"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
