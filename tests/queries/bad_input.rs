//! Bad input is answered with `Unresolved` and `lower = 0`, never with a panic.

use parry3d::query::NonlinearRigidMotion;
use rapier3d_medial::MedialSphere;
use rapier3d_medial::elementary::{self, MovingSphere, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Real, Vector};

const BAD: [Real; 3] = [Real::NAN, Real::INFINITY, Real::NEG_INFINITY];

fn sphere(x: Real) -> MovingSphere {
    MovingSphere {
        center: Vector::new(x, 0.0, 0.0),
        radius: 1.0,
        displacement: Vector::new(-x, 0.0, 0.0),
    }
}

fn double(spheres: &[MovingSphere]) -> Vec<elementary::f64::MovingSphere> {
    let three = |v: Vector| [v.x, v.y, v.z].map(f64::from);
    let convert = |s: &MovingSphere| elementary::f64::MovingSphere {
        center: three(s.center),
        radius: s.radius.into(),
        displacement: three(s.displacement),
    };
    spheres.iter().map(convert).collect()
}

/// Both precisions and the paper's iteration, in both orders.
fn assert_refused(a: &[MovingSphere], b: &[MovingSphere]) {
    let options = ToiOptions::default();
    let double_options = elementary::f64::ToiOptions::default();
    for (a, b) in [(a, b), (b, a)] {
        let toi = elementary::first_contact(a, b, &options);
        assert_eq!(
            (toi.status, toi.lower),
            (ToiStatus::Unresolved, 0.0),
            "{a:?} {b:?}"
        );
        let (a64, b64) = (double(a), double(b));
        let toi = elementary::f64::first_contact(&a64, &b64, &double_options);
        assert_eq!(
            (toi.status, toi.lower),
            (ToiStatus::Unresolved, 0.0),
            "{a:?} {b:?}"
        );
        elementary::alternating(a, b, &options);
        elementary::f64::alternating(&a64, &b64, &double_options);
    }
}

#[test]
fn no_spheres_or_more_than_three_are_refused() {
    let good = [sphere(4.0)];
    for count in [0, 4, 5, 100] {
        assert_refused(&good, &vec![sphere(0.0); count]);
    }
}

#[test]
fn spheres_out_of_range_are_refused() {
    let good = [sphere(4.0)];
    for bad in BAD {
        for place in 0..7 {
            let mut spheres = [sphere(0.0); 3];
            match place {
                0..3 => spheres[1].center[place] = bad,
                3..6 => spheres[2].displacement[place - 3] = bad,
                _ => spheres[0].radius = bad,
            }
            assert_refused(&good, &spheres);
        }
    }
    for radius in [-1.0, -Real::MIN_POSITIVE] {
        assert_refused(
            &good,
            &[MovingSphere {
                radius,
                ..sphere(0.0)
            }],
        );
    }
}

#[test]
fn options_that_are_not_finite_promise_nothing() {
    let (a, b) = ([sphere(0.0)], [sphere(4.0)]);
    for bad in BAD {
        for place in 0..3 {
            let mut options = ToiOptions::default();
            match place {
                0 => options.tolerance = bad,
                1 => options.time_tolerance = bad,
                _ => options.target_distance = bad,
            }
            let toi = elementary::first_contact(&a, &b, &options);
            // An infinite tolerance is met at once; whatever the status, nothing is promised.
            assert_eq!(toi.lower, 0.0, "{options:?} {toi:?}");
        }
    }
}

#[test]
fn motions_that_are_not_finite_are_refused() {
    let spheres = [MedialSphere::new(Vector::ZERO, 1.0)];
    let good = NonlinearRigidMotion::identity();
    for bad in BAD {
        for place in 0..7 {
            let mut motion = good;
            let mut seconds = 1.0;
            match place {
                0 => motion.start.translation.x = bad,
                1 => motion.start.rotation.w = bad,
                2 => motion.local_center.y = bad,
                3 => motion.linvel.z = bad,
                4 => motion.angvel.x = bad,
                5 => motion.start.rotation = parry3d::math::Rotation::from_xyzw(0.0, 0.0, 0.0, 0.0),
                _ => seconds = bad,
            }
            for (first, second) in [(&motion, &good), (&good, &motion)] {
                let options = ToiOptions::default();
                let toi = elementary::first_contact_rigid(
                    &spheres, first, &spheres, second, seconds, &options,
                );
                let refused = (ToiStatus::Unresolved, 0.0);
                assert_eq!((toi.status, toi.lower), refused, "place {place}, {bad}");
                let toi = elementary::f64::first_contact_rigid(
                    &spheres,
                    first,
                    &spheres,
                    second,
                    seconds.into(),
                    &elementary::f64::ToiOptions::default(),
                );
                assert_eq!(
                    (toi.status, toi.lower),
                    (ToiStatus::Unresolved, 0.0),
                    "place {place}"
                );
            }
        }
    }
}
