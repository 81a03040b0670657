//! Flat plates that roll, rock and slide close to cylinders and cones: neither late, nor never, nor unresolved. There
//! the distance stays small and has kinks. Judged by the distance in `f64` at dense times, found by section over the
//! plate, along which it is convex.

use crate::rng::Rng;
use crate::rotating::{rotation, vector};
use crate::within::least;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use parry3d::math::{Pose, Real, Vector};
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher, ShapeCastStatus};
use parry3d::shape::SharedShape;
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere, ToiOptions};

const CASES: usize = 100;
const MOMENTS: usize = 50;

/// Half extents of the plates' medial rectangle, half height and radius of the bodies, in metres.
const HALF: [f64; 2] = [0.4, 0.3];
const HEIGHT: f64 = 0.5;
const RADIUS: f64 = 0.4;

/// Error of the distance found by section, and of a time and an axis in `f32`, in metres.
const ERROR: f64 = 5.0e-7;

/// Distance of a point to a body, 0 inside.
type Distance = fn(Vector3<f64>) -> f64;

fn to_cylinder(p: Vector3<f64>) -> f64 {
    let (x, y) = (p.x.hypot(p.z) - RADIUS, p.y.abs() - HEIGHT);
    x.max(0.0).hypot(y.max(0.0))
}

fn to_cone(p: Vector3<f64>) -> f64 {
    let (x, y) = (p.x.hypot(p.z), p.y);
    if y >= -HEIGHT && 2.0 * HEIGHT * x + RADIUS * y <= HEIGHT * RADIUS {
        return 0.0;
    }
    let base = (x - x.min(RADIUS)).hypot(y + HEIGHT);
    let (dx, dy) = (-RADIUS, 2.0 * HEIGHT);
    let s = ((x - RADIUS) * dx + (y + HEIGHT) * dy) / (dx * dx + dy * dy);
    let s = s.clamp(0.0, 1.0);
    base.min((x - RADIUS - s * dx).hypot(y + HEIGHT - s * dy))
}

/// Distance of the plate's medial rectangle, in the body's frame.
fn distance(to_body: Distance, pose: &Isometry3<f64>) -> f64 {
    let at = |x: f64, z: f64| to_body((pose * nalgebra::Point3::new(x, 0.0, z)).coords);
    let [x_span, z_span] = HALF.map(|half| [-half, half]);
    least(x_span, |x| least(z_span, |z| at(x, z)).0).0
}

fn exact(pose: &Pose) -> Isometry3<f64> {
    let (t, q) = (pose.translation, pose.rotation);
    let [x, y, z, w] = [q.x, q.y, q.z, q.w].map(f64::from);
    Isometry3::from_parts(
        Translation3::new(t.x.into(), t.y.into(), t.z.into()),
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z)),
    )
}

/// A motion about the origin of its frame, in `f64`.
fn pose_at(motion: &NonlinearRigidMotion, time: f64) -> Isometry3<f64> {
    let (start, v, w) = (exact(&motion.start), motion.linvel, motion.angvel);
    let moved = |v: Vector| Vector3::new(v.x.into(), v.y.into(), v.z.into()) * time;
    let turned = UnitQuaternion::from_scaled_axis(moved(w)) * start.rotation;
    Isometry3::from_parts(
        Translation3::from(start.translation.vector + moved(v)),
        turned,
    )
}

/// A plate close to a body at rest at the origin of its own turn, mostly sliding along it, and how both move.
fn scene(rng: &mut Rng, to_body: Distance, thin: f64) -> [NonlinearRigidMotion; 2] {
    let moving = |start: Pose, linvel: Vector, angvel: Vector| NonlinearRigidMotion {
        start,
        local_center: Vector::ZERO,
        linvel,
        angvel,
    };
    let turning = rotation(rng);
    let away = rng.direction();
    let mut start = Pose::from_parts(vector(away * 2.0), rotation(rng));
    let gap = thin + 10.0_f64.powf(rng.range(-4.5, -2.0));
    let body = moving(
        Pose::from_parts(Vector::ZERO, turning),
        Vector::ZERO,
        vector(rng.in_ball() * 0.2),
    );
    for _ in 0..60 {
        let apart = distance(to_body, &(exact(&body.start).inverse() * exact(&start)));
        start.translation -= vector(away * (apart - gap));
    }
    let slow = |rng: &mut Rng, most: f64| vector(rng.in_ball() * most);
    let velocity = slow(rng, 0.2) - vector(away * rng.range(0.0, 0.02));
    [moving(start, velocity, slow(rng, 0.1)), body]
}

fn plate(thin: f64) -> MedialMesh {
    let [x, z] = HALF.map(|half| half as Real);
    let corners = [(-x, -z), (x, -z), (x, z), (-x, z)];
    let sphere = |(x, z)| MedialSphere::new(Vector::new(x, 0.0, z), thin as Real);
    MedialMesh::new(
        corners.map(sphere).to_vec(),
        vec![],
        vec![[0, 1, 2], [0, 2, 3]],
    )
    .expect("a plate")
}

#[test]
fn plates_close_to_cylinders_and_cones_are_hit_neither_late_nor_never() {
    let dispatcher = MedialDispatcher::default();
    let tolerance = f64::from(ToiOptions::default().tolerance);
    let bodies: [(&str, SharedShape, Distance); 2] = [
        (
            "cylinder",
            SharedShape::cylinder(HEIGHT as Real, RADIUS as Real),
            to_cylinder,
        ),
        (
            "cone",
            SharedShape::cone(HEIGHT as Real, RADIUS as Real),
            to_cone,
        ),
    ];
    let mut failures = Vec::new();
    for (name, shape, to_body) in &bodies {
        for thin in [0.0, 0.002, 0.05] {
            let mesh = plate(thin);
            let mut rng = Rng::new(7);
            let mut hits = 0;
            for case in 0..CASES {
                let [motion1, motion2] = scene(&mut rng, *to_body, thin);
                let hit = dispatcher
                    .cast_shapes_nonlinear(
                        &motion1,
                        &mesh,
                        &motion2,
                        shape.as_ref(),
                        0.0,
                        1.0,
                        true,
                    )
                    .expect("cylinders and cones are swept");
                let apart = |time: f64| {
                    let pose = pose_at(&motion2, time).inverse() * pose_at(&motion1, time);
                    distance(*to_body, &pose) - thin
                };
                let mut fail =
                    |what: String| failures.push(format!("{name}, {thin} m, {case}: {what}"));
                let until = hit.map_or(1.0, |hit| f64::from(hit.time_of_impact));
                hits += usize::from(hit.is_some());
                for k in 0..=MOMENTS {
                    let time = until * k as f64 / MOMENTS as f64;
                    let distance = apart(time);
                    // Of a plate without thickness the distance is 0 at least.
                    if distance <= if thin > 0.0 { -ERROR } else { 0.0 } {
                        fail(format!("{distance} deep at {time}, {hit:?}"));
                        break;
                    }
                }
                let Some(hit) = hit else { continue };
                let distance = apart(until);
                if hit.status == ShapeCastStatus::OutOfIterations {
                    fail(format!("unresolved, {distance} apart, {hit:?}"));
                } else if distance > tolerance + ERROR {
                    fail(format!("{distance} apart at the hit, {hit:?}"));
                }
            }
            println!("{name}, {thin} m: {hits} of {CASES} hit");
        }
    }
    assert!(
        failures.is_empty(),
        "{} fail:\n{}",
        failures.len(),
        failures.join("\n")
    );
}
