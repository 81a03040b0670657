//! Sheets and wires without thickness, which cylinders and cones must not pass, and bodies of any size, which are told
//! apart where they are: by closed forms in `f64`.

use crate::rng::Rng;
use crate::rotating::vector;
use parry3d::math::{Pose, Real, Rotation, Vector};
use parry3d::query::QueryDispatcher;
use parry3d::query::details::ShapeCastOptions;
use parry3d::shape::{Shape, SharedShape};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

/// A square of 20 by 20 units in the plane of x and z.
fn sheet(scale: Real) -> MedialMesh {
    let corner = |x: Real, z: Real| MedialSphere::new(Vector::new(x, 0.0, z) * scale, 0.0);
    let corners = [
        corner(-10.0, -10.0),
        corner(10.0, -10.0),
        corner(10.0, 10.0),
        corner(-10.0, 10.0),
    ];
    MedialMesh::new(corners.to_vec(), vec![], vec![[0, 1, 2], [0, 2, 3]]).expect("a sheet")
}

/// How far a solid of the axis `up` reaches down from its middle: a cylinder of half a height and a radius, or the cone
/// in it.
fn reach(is_cone: bool, up: Vector, [half, radius]: [f64; 2]) -> f64 {
    let cosine = f64::from(up.y);
    let rim = radius * (1.0 - cosine * cosine).max(0.0).sqrt();
    match is_cone {
        true => (half * cosine + rim).max(-half * cosine),
        false => half * cosine.abs() + rim,
    }
}

#[test]
fn cylinders_and_cones_do_not_pass_sheets_on_a_slant() {
    let mut rng = Rng::new(71);
    let dispatcher = MedialDispatcher::default();
    let mut hits = 0;
    for case in 0..2_000 {
        let scale = [0.02, 1.0, 10.0][case % 3];
        let mesh = sheet(scale);
        let is_cone = case % 2 == 0;
        let size = [0.3, 0.2].map(|s| s * scale);
        let other = match is_cone {
            true => SharedShape::cone(size[0], size[1]),
            false => SharedShape::cylinder(size[0], size[1]),
        };
        let turn = vector(rng.direction() * rng.range(0.0, 3.0));
        let pose = Pose::from_parts(
            Vector::new(0.3, rng.range(0.4, 0.9) as Real, -0.2) * scale,
            Rotation::from_scaled_axis(turn),
        );
        // From as good as along the sheet to straight down on it.
        let down = -(rng.log_range(0.05, 5.0) as Real);
        let velocity = Vector::new(2.5, down, rng.range(-1.0, 1.0) as Real) * scale;
        let up = pose.rotation * Vector::Y;
        let height = f64::from(pose.translation.y) - reach(is_cone, up, size.map(f64::from));
        let time = height / f64::from(-velocity.y);
        let options = ShapeCastOptions {
            max_time_of_impact: 3.0,
            target_distance: 0.0,
            stop_at_penetration: case % 5 == 0,
            compute_impact_geometry_on_penetration: true,
        };
        let cast = |swapped: bool| {
            let (first, second): (&dyn Shape, &dyn Shape) = match swapped {
                true => (&*other, &mesh),
                false => (&mesh, &*other),
            };
            let (pos12, vel12) = match swapped {
                true => (pose.inverse(), pose.rotation.inverse() * -velocity),
                false => (pose, velocity),
            };
            dispatcher
                .cast_shapes(&pos12, vel12, first, second, options)
                .expect("swept")
        };
        for hit in [cast(false), cast(true)] {
            let name = format!("{case}: cone {is_cone}, scale {scale}, {velocity:?}, {pose:?}");
            if time > 3.01 {
                assert!(hit.is_none(), "{name}: {hit:?} for {time}");
            } else if time < 2.99 {
                let found = hit.unwrap_or_else(|| panic!("{name}: passed, {time}"));
                // Within the tolerance, 1e-4 for metres.
                let off = (f64::from(found.time_of_impact) - time) * f64::from(velocity.y);
                assert!(off.abs() < 1.0e-4 * f64::from(scale), "{name}: {off}");
                hits += 1;
            }
        }
    }
    assert!(hits > 2_000, "{hits}");
}

#[test]
fn balls_of_any_size_are_as_far_from_rounded_bodies_as_they_are() {
    let mut rng = Rng::new(72);
    let dispatcher = MedialDispatcher::default();
    let half = Vector::new(0.3, 0.2, 0.4);
    for case in 0..4_000 {
        let scale = [1.0, 0.05, 0.01, 0.001][case / 5 % 4];
        let corners = (0..8).map(|k| {
            let side = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            Vector::new(side(0), side(1), side(2)) * half * scale
        });
        let corners: Vec<Vector> = corners.collect();
        let [hx, hy, hz] = (half * scale).to_array();
        let border = 0.025 * scale;
        let center = vector(rng.in_ball()) * scale;
        let beyond = (center.abs() - half * scale).max(Vector::ZERO);
        let (other, border, beyond) = match case % 5 {
            0 => (
                SharedShape::round_cuboid(hx, hy, hz, border),
                border,
                beyond,
            ),
            1 => {
                let hull = SharedShape::convex_hull(&corners).expect("a hull");
                (hull, 0.0, beyond)
            }
            2 => {
                let hull = SharedShape::round_convex_hull(&corners, border).expect("a hull");
                (hull, border, beyond)
            }
            3 => {
                let hull = SharedShape::convex_hull(&corners).expect("a hull");
                let both = [Vector::ZERO, Vector::Y * (4.0 * scale)].map(Pose::from_translation);
                let compound = SharedShape::compound(both.map(|p| (p, hull.clone())).to_vec());
                (compound, 0.0, beyond)
            }
            _ => {
                let corner = |x: Real, z: Real| Vector::new(x, 0.0, z) * scale;
                let [a, b, c] = [corner(-9.0, -9.0), corner(9.0, -9.0), corner(0.0, 9.0)];
                let triangle = SharedShape::round_triangle(a, b, c, border);
                (triangle, border, Vector::Y * center.y.abs())
            }
        };
        let radius = 0.01 * scale;
        let mesh = MedialMesh::ball(radius).expect("a ball");
        let [x, y, z] = beyond.to_array().map(f64::from);
        let gap = (x * x + y * y + z * z).sqrt() - f64::from(border) - f64::from(radius);
        let told = dispatcher
            .distance(&Pose::from_translation(center), &mesh, &*other)
            .expect("known");
        let meets = dispatcher
            .intersection_test(&Pose::from_translation(-center), &mesh, &*other)
            .expect("known");
        let name = format!("{case}, scale {scale}, {center:?}");
        let off = (f64::from(told.distance) - gap.max(0.0)).abs();
        assert!(
            off < 1.0e-5 * f64::from(scale),
            "{name}: {told:?} for {gap}"
        );
        if gap.abs() > 1.0e-5 * f64::from(scale) {
            assert_eq!(meets.intersecting, gap < 0.0, "{name}: {gap}");
        }
    }
}

/// Hulls of many sides, of whose faces parry merges those that are about as one, and flat ones hold what is in them,
/// and nothing else.
#[test]
fn hulls_of_round_and_flat_bodies_hold_what_is_in_them() {
    let mut rng = Rng::new(74);
    let dispatcher = MedialDispatcher::default();
    let mesh = MedialMesh::ball(0.02).expect("a ball");
    let meets = |other: &SharedShape, at: Vector| {
        let pose = Pose::from_translation(-at);
        let told = dispatcher.intersection_test(&pose, &mesh, &**other);
        told.expect("known").intersecting
    };
    for (sides, border) in [16, 200, 256, 300, 500]
        .into_iter()
        .flat_map(|sides| [(sides, 0.0), (sides, 0.05)])
    {
        let (radius, half) = (0.4, 0.3);
        let rim = |k: u16| {
            let (sin, cos) = (std::f32::consts::TAU * Real::from(k) / Real::from(sides)).sin_cos();
            [-half, half].map(|y| Vector::new(radius * cos, y, radius * sin))
        };
        let corners: Vec<Vector> = (0..sides).flat_map(rim).collect();
        let hull = match border {
            0.0 => SharedShape::convex_hull(&corners),
            _ => SharedShape::round_convex_hull(&corners, border),
        };
        let hull = hull.expect("a drum");
        let mut judged = [0; 2];
        for case in 0..600 {
            let size = [1.0, 5.0][case % 2];
            let at = vector(rng.in_ball()) * size;
            let aside = Vector::new(at.x, 0.0, at.z).length();
            let beyond = [aside - radius, at.y.abs() - half];
            let outside = beyond[0].max(0.0).hypot(beyond[1].max(0.0));
            let inside = beyond[0].max(beyond[1]).min(0.0);
            let gap = outside - 0.02 - border;
            // Between the drum and the cylinder around it either may be told.
            if gap > 1.0e-3 {
                assert!(!meets(&hull, at), "{sides}, {border}: {at:?}, {gap} apart");
                judged[0] += 1;
            } else if outside + inside < border - 0.01 {
                assert!(meets(&hull, at), "{sides}, {border}: {at:?}");
                judged[1] += 1;
            }
        }
        assert!(judged[0] > 300 && judged[1] > 10, "{judged:?}");
    }
    let corner = |x: Real, z: Real| Vector::new(0.5 * x, 0.0, 0.4 * z);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let flat = SharedShape::convex_hull(&corners.map(|(x, z)| corner(x, z)));
    let flat = flat.expect("a flat hull");
    for x in [0.6, 0.9, 5.0, 100.0] {
        assert!(!meets(&flat, Vector::new(x, 0.0, 0.1)), "{x}");
    }
    assert!(meets(&flat, Vector::new(0.3, 0.0, 0.1)));
}
