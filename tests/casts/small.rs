//! Casts of bodies from a tenth of a millimetre to a hundred metres: where they are hit they are apart by a small part
//! of their size.

use parry3d::math::{Pose, Real, Vector};
use parry3d::query::{NonlinearRigidMotion, QueryDispatcher};
use parry3d::shape::Ball;
use rapier3d_medial::{MedialDispatcher, MedialMesh};

/// Distance of a point from a segment, in double precision.
fn from_segment(p: Vector, [a, b]: [Vector; 2]) -> f64 {
    let [p, a, b] = [p, a, b].map(|v| [v.x, v.y, v.z].map(f64::from));
    let less = |v: [f64; 3], w: [f64; 3]| [0, 1, 2].map(|k| v[k] - w[k]);
    let dot = |v: [f64; 3], w: [f64; 3]| (0..3).map(|k| v[k] * w[k]).sum::<f64>();
    let (along, way) = (less(b, a), less(p, a));
    let share = (dot(way, along) / dot(along, along)).clamp(0.0, 1.0);
    let off = less(way, along.map(|x| x * share));
    dot(off, off).sqrt()
}

#[test]
fn small_bodies_are_hit_where_they_touch() {
    let dispatcher = MedialDispatcher::default();
    for size in [1.0e-4, 1.0e-3, 1.0e-2, 0.1, 1.0, 100.0] {
        let ends = [Vector::X * -0.4 * size, Vector::X * 0.4 * size];
        let mesh = MedialMesh::capsule(ends[0], ends[1], 0.1 * size).expect("a capsule");
        let ball = Ball::new(0.3 * size);
        let mut hits = 0;
        for k in 0..50u8 {
            let t = Real::from(k);
            let turn = Vector::new(t.sin(), t.cos(), 1.0) * 3.0;
            let turns = NonlinearRigidMotion::new(Pose::IDENTITY, Vector::ZERO, Vector::ZERO, turn);
            let start = Pose::from_translation(Vector::new(1.5, 0.1 * t.sin(), 0.2) * size);
            let flies = NonlinearRigidMotion::new(
                start,
                Vector::ZERO,
                Vector::X * -2.0 * size,
                Vector::ZERO,
            );
            let hit = dispatcher
                .cast_shapes_nonlinear(&turns, &mesh, &flies, &ball, 0.0, 2.0, true)
                .expect("a ball is swept");
            let Some(hit) = hit else {
                continue;
            };
            hits += 1;
            let [capsule, ball] = [&turns, &flies].map(|m| m.position_at_time(hit.time_of_impact));
            let distance = from_segment(ball.translation, ends.map(|end| capsule * end));
            let gap = distance / f64::from(size) - 0.4;
            assert!(
                gap.abs() < 2.0e-4,
                "{k} of size {size} m: {gap} of it apart"
            );
        }
        assert_eq!(hits, 50, "of size {size} m");
    }
}

#[test]
fn small_balls_are_hit_where_they_touch_a_large_mesh_in_both_orders() {
    let dispatcher = MedialDispatcher::default();
    let mesh = MedialMesh::capsule(Vector::X * -5.0, Vector::X * 5.0, 0.5).expect("a capsule");
    let size = 1.0e-4;
    let ball = Ball::new(size);
    let motion = |at: Vector, velocity: Vector| {
        NonlinearRigidMotion::new(
            Pose::from_translation(at),
            Vector::ZERO,
            velocity,
            Vector::ZERO,
        )
    };
    // It starts at twenty times its radius above the mesh, and falls by as much in a second.
    let gap = 20.0 * size;
    let still = motion(Vector::ZERO, Vector::ZERO);
    let falls = motion(Vector::Y * (0.5 + size + gap), Vector::Y * -gap);
    let cast = |first: bool| match first {
        true => dispatcher.cast_shapes_nonlinear(&still, &mesh, &falls, &ball, 0.0, 2.0, true),
        false => dispatcher.cast_shapes_nonlinear(&falls, &ball, &still, &mesh, 0.0, 2.0, true),
    };
    for first in [true, false] {
        let hit = cast(first).expect("a ball is swept").expect("a hit");
        let apart = (1.0 - hit.time_of_impact) * gap / size;
        // Half a micrometre of the mesh is a rounding of its coordinates.
        assert!(
            apart.abs() < 5.0e-3,
            "mesh first: {first}, {apart} radii apart"
        );
    }
}
