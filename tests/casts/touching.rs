//! Turning casts that start in touch: before the answer no place gets deeper than the bodies are at the start
//! and get by the speed at which their deepest contact closes, and none deeper than half way to
//! the medial axes there; what comes no nearer is not hit. A ball, and what turns under it: a ring, and a thick
//! beam with a thin antenna. Judged by sampled distances in `f64`.
//!
//! The full run: `CASTS=5000 cargo test --all-features --test casts touching -- --nocapture`.

use crate::rng::Rng;
use nalgebra::{UnitQuaternion, Vector3};
use parry3d::math::{Pose, Real, Vector};
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher};
use parry3d::shape::{Shape, SharedShape};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

const BALL: f64 = 0.07;
/// Share of a part's radius that it may sink in at most.
const CORE: f64 = 0.5;
/// Contact distance of casts, at the start and at the hit, and what rounding of `f32` poses adds.
const SLACK: f64 = 2.2e-4;

/// A union of capsules.
struct Body {
    mesh: MedialMesh,
    parts: Vec<Part>,
    /// Moments of a cast that are sampled.
    moments: usize,
}

/// The ends and the radius of a capsule.
#[derive(Clone, Copy)]
struct Part {
    ends: [Vector; 2],
    radius: Real,
}

impl Body {
    fn new(parts: Vec<Part>, moments: usize) -> Self {
        let spheres = parts
            .iter()
            .flat_map(|p| p.ends.map(|c| MedialSphere::new(c, p.radius)));
        let edges = (0..parts.len() as u32).map(|k| [2 * k, 2 * k + 1]);
        let mesh = MedialMesh::new(spheres.collect(), edges.collect(), vec![]).expect("a body");
        Self {
            mesh,
            parts,
            moments,
        }
    }

    /// Signed distance of each part to the ball at `p`, in the body's frame.
    fn gaps(&self, p: Vector3<f64>) -> Vec<f64> {
        let wide = |v: Vector| Vector3::new(v.x.into(), v.y.into(), v.z.into());
        let gap = |part: &Part| {
            let [a, b]: [Vector3<f64>; 2] = part.ends.map(wide);
            let d = b - a;
            let s = ((p - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
            (p - a - d * s).norm() - f64::from(part.radius) - BALL
        };
        self.parts.iter().map(gap).collect()
    }

    /// A place of the ball so far off one of the parts, and no nearer to any other.
    fn place(&self, rng: &mut Rng, gap: f64) -> Vector3<f64> {
        let part = self.parts[rng.below(self.parts.len())];
        let from = part.ends[0].lerp(part.ends[1], rng.range(0.0, 1.0) as Real);
        let from = Vector3::new(from.x.into(), from.y.into(), from.z.into());
        let out = rng.direction();
        let (mut a, mut b) = (0.0, 2.0);
        for _ in 0..50 {
            let way = 0.5 * (a + b);
            if least(&self.gaps(from + out * way)) < gap {
                a = way
            } else {
                b = way
            }
        }
        from + out * a
    }
}

fn ring() -> Body {
    let center = |i: u32| {
        let (sin, cos) = (f64::from(i % 24) / 24.0 * std::f64::consts::TAU).sin_cos();
        Vector::new((0.5 * cos) as Real, 0.0, (0.5 * sin) as Real)
    };
    let part = |i| Part {
        ends: [center(i), center(i + 1)],
        radius: 0.1,
    };
    Body::new((0..24).map(part).collect(), 500)
}

/// A beam 0.6 m thick from which 1 m of an antenna 2 cm thick sticks out: a twentieth of its size, so that
/// the mesh as a whole is as thick as the beam.
fn beam_with_antenna() -> Body {
    let part = |a: Vector, b: Vector, radius| Part {
        ends: [a, b],
        radius,
    };
    let beam = part(Vector::X * -1.0, Vector::X, 0.3);
    let antenna = part(Vector::Y * 0.2, Vector::Y * 1.3, 0.01);
    let body = Body::new(vec![beam, antenna], 4000);
    assert_eq!(body.mesh.thickness(), 0.3);
    body
}

fn least(gaps: &[f64]) -> f64 {
    gaps.iter().copied().fold(f64::MAX, f64::min)
}

#[test]
fn turning_casts_that_start_in_touch_get_no_deeper_than_their_deepest_contact_does() {
    judge(&ring());
}

/// Symptom: what lay against a thick body went through its antenna. Cause: one thickness per mesh.
#[test]
fn turning_casts_that_start_in_touch_stop_at_thin_parts() {
    judge(&beam_with_antenna());
}

fn judge(body: &Body) {
    let casts = std::env::var("CASTS").ok().and_then(|n| n.parse().ok());
    let casts = casts.unwrap_or(300);
    let ours = MedialDispatcher::default();
    let medial = MedialMesh::ball(BALL as Real).expect("a ball");
    let balls = [SharedShape::ball(BALL as Real), SharedShape::new(medial)];
    let mut rng = Rng::new(4711);
    let (mut deep, mut free, mut late, mut false_hits) = (0, 0, 0, 0);
    for _ in 0..casts {
        let gap = rng.range(-0.004, 5.0e-5);
        let vector = |v: Vector3<Real>| Vector::new(v.x, v.y, v.z);
        // What `f32` holds is the truth.
        let at = body.place(&mut rng, gap).map(|x| x as Real);
        let velocity = (rng.direction() * rng.range(0.0, 1.0)).map(|x| x as Real);
        let turn = (rng.direction() * rng.range(0.0, 3.0)).map(|x| x as Real);
        let seen = |t: f64| {
            let turned = UnitQuaternion::from_scaled_axis(turn.map(f64::from) * t);
            turned.inverse() * (at.map(f64::from) + velocity.map(f64::from) * t)
        };
        let start = body.gaps(seen(0.0));
        let deepest = least(&start);
        let part = (0..start.len()).min_by(|&i, &j| start[i].total_cmp(&start[j]));
        let part = part.expect("a part");
        let step = 1.0e-5;
        let closing = (start[part] - body.gaps(seen(step))[part]) / step;
        let sinks = (-deepest).max(0.0) + closing.max(0.0);
        // The thinner of the two that meet.
        let core = |part: &Part| CORE * f64::from(part.radius).min(BALL);
        let floors: Vec<f64> = (body.parts.iter().map(|p| -sinks.min(core(p)) - SLACK)).collect();
        let time = |k: usize| k as f64 / body.moments as f64;
        let moments = (0..=body.moments).map(|k| (time(k), body.gaps(seen(time(k)))));
        let (mut told_by, mut nearer) = (f64::INFINITY, false);
        for (t, gaps) in moments {
            for ((gap, floor), start) in gaps.iter().zip(&floors).zip(&start) {
                if gap < floor {
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
            let (mesh, ball): (&dyn Shape, &dyn Shape) = (&body.mesh, ball.as_ref());
            let (a, b) = ((&still, mesh), (&moved, ball));
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
