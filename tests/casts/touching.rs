//! Turning casts that start in touch: before the answer no place gets deeper than the bodies are at the start
//! and get by the speed at which their deepest contact closes, and none deeper than a core; what comes no
//! nearer is not hit. A ball and a ring that
//! turns under it, judged by sampled distances in `f64`.
//!
//! The full run: `CASTS=5000 cargo test --all-features --test casts touching -- --nocapture`.

use crate::rng::Rng;
use nalgebra::{UnitQuaternion, Vector3};
use parry3d::math::{Pose, Real, Vector};
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher};
use parry3d::shape::{Shape, SharedShape};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

const PARTS: usize = 24;
const MAJOR: f64 = 0.5;
const MINOR: f64 = 0.1;
const BALL: f64 = 0.07;
/// Depth of the ring's core: half its thickness.
const CORE: f64 = 0.05;
/// Contact distance of casts, at the start and at the hit, and what rounding of `f32` poses adds.
const SLACK: f64 = 2.2e-4;
const MOMENTS: usize = 500;

fn center(i: usize) -> Vector {
    let (sin, cos) = ((i % PARTS) as f64 / PARTS as f64 * std::f64::consts::TAU).sin_cos();
    Vector::new((MAJOR * cos) as Real, 0.0, (MAJOR * sin) as Real)
}

fn ring() -> MedialMesh {
    let spheres = (0..PARTS).map(|i| MedialSphere::new(center(i), MINOR as Real));
    let edges = (0..PARTS as u32).map(|i| [i, (i + 1) % PARTS as u32]);
    MedialMesh::new(spheres.collect(), edges.collect(), vec![]).expect("a ring")
}

/// Signed distance of each part to a ball there, in the ring's frame.
fn gaps(p: Vector3<f64>) -> [f64; PARTS] {
    let wide = |v: Vector| Vector3::new(v.x.into(), v.y.into(), v.z.into());
    std::array::from_fn(|i| {
        let (a, b): (Vector3<f64>, Vector3<f64>) = (wide(center(i)), wide(center(i + 1)));
        let d = b - a;
        let s = ((p - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
        (p - a - d * s).norm() - MINOR - BALL
    })
}

fn least(p: Vector3<f64>) -> f64 {
    gaps(p).into_iter().fold(f64::MAX, f64::min)
}

/// A place of the ball so far off the ring.
fn place(rng: &mut Rng, gap: f64) -> Vector3<f64> {
    let (sin, cos) = rng.range(0.0, std::f64::consts::TAU).sin_cos();
    let (from, out) = (Vector3::new(MAJOR * cos, 0.0, MAJOR * sin), rng.direction());
    let (mut a, mut b) = (0.0, 2.0);
    for _ in 0..50 {
        let way = 0.5 * (a + b);
        if least(from + out * way) < gap {
            a = way
        } else {
            b = way
        }
    }
    from + out * a
}

#[test]
fn turning_casts_that_start_in_touch_get_no_deeper_than_their_deepest_contact_does() {
    let casts = std::env::var("CASTS").ok().and_then(|n| n.parse().ok());
    let casts = casts.unwrap_or(300);
    let (ring, ours) = (ring(), MedialDispatcher::default());
    let medial = MedialMesh::ball(BALL as Real).expect("a ball");
    let balls = [SharedShape::ball(BALL as Real), SharedShape::new(medial)];
    let mut rng = Rng::new(4711);
    let (mut deep, mut free, mut late, mut false_hits) = (0, 0, 0, 0);
    for _ in 0..casts {
        let gap = rng.range(-0.004, 5.0e-5);
        let vector = |v: Vector3<Real>| Vector::new(v.x, v.y, v.z);
        // What `f32` holds is the truth.
        let at = place(&mut rng, gap).map(|x| x as Real);
        let velocity = (rng.direction() * rng.range(0.0, 1.0)).map(|x| x as Real);
        let turn = (rng.direction() * rng.range(0.0, 3.0)).map(|x| x as Real);
        let seen = |t: f64| {
            let turned = UnitQuaternion::from_scaled_axis(turn.map(f64::from) * t);
            turned.inverse() * (at.map(f64::from) + velocity.map(f64::from) * t)
        };
        let start = gaps(seen(0.0));
        let deepest = least(seen(0.0));
        let part = (0..PARTS).min_by(|&i, &j| start[i].total_cmp(&start[j]));
        let part = part.expect("a part");
        let step = 1.0e-5;
        let closing = (start[part] - gaps(seen(step))[part]) / step;
        let floor = -((-deepest).max(0.0) + closing.max(0.0)).min(CORE) - SLACK;
        let time = |k: usize| k as f64 / MOMENTS as f64;
        let moments = (0..=MOMENTS).map(|k| (time(k), gaps(seen(time(k)))));
        let (mut told_by, mut nearer) = (f64::INFINITY, false);
        for (t, gaps) in moments {
            for (gap, start) in gaps.iter().zip(start) {
                if *gap < floor {
                    told_by = told_by.min(t);
                }
                nearer |= *gap < start.min(SLACK) - 2.0e-6;
            }
        }
        deep += usize::from(told_by.is_finite());
        free += usize::from(!nearer);
        let still =
            NonlinearRigidMotion::new(Pose::IDENTITY, Vector::ZERO, Vector::ZERO, vector(turn));
        let moved = Pose::from_translation(vector(at));
        let moved = NonlinearRigidMotion::new(moved, Vector::ZERO, vector(velocity), Vector::ZERO);
        for ball in &balls {
            let (ring, ball): (&dyn Shape, &dyn Shape) = (&ring, ball.as_ref());
            let (a, b) = ((&still, ring), (&moved, ball));
            for ((m1, g1), (m2, g2)) in [(a, b), (b, a)] {
                let hit = ours.cast_shapes_nonlinear(m1, g1, m2, g2, 0.0, 1.0, false);
                let hit = hit.expect("swept");
                let end = hit.map_or(f64::INFINITY, |h| h.time_of_impact.into());
                late += usize::from(told_by.is_finite() && end > told_by + 1.0e-6);
                false_hits += usize::from(hit.is_some() && !nearer);
            }
        }
    }
    println!(
        "{casts} casts: {deep} get deep, {free} come no nearer; {late} late, {false_hits} false"
    );
    assert!(deep > casts / 20 && free > casts / 5, "{deep}, {free}");
    assert_eq!([late, false_hits], [0; 2], "of {casts}");
}
