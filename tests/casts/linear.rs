//! Straight casts with a target distance and no end in time: parry's `cast_shapes`.

use crate::oracle::{COARSE_CUTS, CUTS, FINE_CUTS, Samples, Scene, stand_in};
use crate::rng::Rng;
use crate::rotating::{rotation, vector};
use crate::shapes::{every_shape, ring};
use parry3d::math::{Pose, Real};
use parry3d::query::details::ShapeCastOptions;
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher, ShapeCastStatus};
use rapier3d_medial::{MedialDispatcher, MedialMesh, ToiOptions};

const CASES: usize = 16;
const TARGET: Real = 0.1;

#[test]
fn every_shape_on_a_straight_path_without_end_is_hit_at_the_target_distance() {
    let mesh = ring();
    let samples = Samples::new(&mesh, CUTS);
    let fine = Samples::new(&mesh, FINE_CUTS);
    let coarse = Samples::new(&mesh, COARSE_CUTS);
    let dispatcher = MedialDispatcher::default();
    let mut failures = Vec::new();
    let mut hits = 0;
    let mut cases = 0;
    for (i, (name, shape, _)) in every_shape().iter().enumerate() {
        let measured = stand_in(shape);
        let mut rng = Rng::new(500 + i as u64);
        let mut left = CASES;
        while left > 0 {
            let from = vector(rng.direction() * rng.range(2.0, 4.0));
            let speed = rng.log_range(0.01, 100.0) as Real;
            let to = vector(rng.in_ball() * 3.0);
            let velocity = (to - from).normalize() * speed;
            let pos12 = Pose::from_parts(from, rotation(&mut rng));
            let flipped = rng.chance(0.5);
            let still = NonlinearRigidMotion::identity();
            let moving = NonlinearRigidMotion {
                linvel: velocity,
                ..NonlinearRigidMotion::constant_position(pos12)
            };
            let motions = if flipped {
                [&moving, &still]
            } else {
                [&still, &moving]
            };
            let scene = Scene {
                samples: &samples,
                fine: &fine,
                other: measured.as_ref(),
                other_samples: shape.as_shape::<MedialMesh>().map(|_| &coarse),
                motions,
                target: TARGET,
                end: 8.0 / speed,
                moments: 400,
            };
            if scene.distance(0.0, 0.1) < 0.05 {
                continue;
            }
            left -= 1;
            cases += 1;
            let options = ShapeCastOptions {
                target_distance: TARGET,
                max_time_of_impact: Real::MAX,
                stop_at_penetration: true,
                ..ShapeCastOptions::default()
            };
            let (g1, g2): (&dyn parry3d::shape::Shape, _) = (&mesh, shape.as_ref());
            let [g1, g2] = if flipped { [g2, g1] } else { [g1, g2] };
            let hit = dispatcher
                .cast_shapes(&pos12, velocity, g1, g2, options)
                .expect("every built-in shape is swept")
                .map(|h| if flipped { h.swapped() } else { h });
            hits += usize::from(hit.is_some());
            if hit.is_some_and(|h| h.status == ShapeCastStatus::OutOfIterations) {
                failures.push(format!("{name} {}: unresolved {hit:?}", CASES - left));
            }
            if let Err(e) = scene.judge(hit.as_ref(), ToiOptions::default().tolerance) {
                failures.push(format!("{name} {}: {e}", CASES - left));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(
        (cases * 3 / 10..=cases * 7 / 10).contains(&hits),
        "{hits} of {cases} hit"
    );
}
