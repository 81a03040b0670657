//! The spheres, points and normal of an answer: they are on the bodies, and they are the nearest.

use crate::ccd::contact::distance_at;
use crate::ccd::families::Family;
use crate::ccd::motion::{Ball, Motion, Paths, Query};
use crate::ccd::rng::Rng;
use crate::ccd::subject::{Subject, single_toi};
use nalgebra::Vector3;
use rapier3d_medial::elementary::ToiStatus;
use rapier3d_medial::math::Vector;

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z).map(f64::from)
}

/// The body's spheres at a time, at rest.
fn frozen(query: &Query, body: usize, time: f64) -> Vec<Ball> {
    let place = |ball: &Ball| match &query.motion {
        Motion::Straight => ball.center + ball.displacement * time,
        Motion::Rigid(motions, seconds) => motions[body].place(&ball.center, seconds * time),
    };
    let freeze = |ball: &Ball| Ball {
        center: place(ball),
        radius: ball.radius,
        displacement: Vector3::zeros(),
    };
    query.balls[body].iter().map(freeze).collect()
}

/// What `f32` resolves: 64 roundings of the largest coordinate met, which is also the unit of the
/// slack that the query itself allows for.
fn resolution(query: &Query) -> f64 {
    let spheres = query.balls.iter().flatten();
    let reach = spheres.map(|b| b.center.norm() + b.displacement.norm() + b.radius);
    let motions = match &query.motion {
        Motion::Straight => 0.0,
        Motion::Rigid(motions, seconds) => motions
            .iter()
            .map(|m| m.translation.norm() + m.local_center.norm() + m.linvel.norm() * seconds)
            .fold(0.0, f64::max),
    };
    64.0 * f64::from(f32::EPSILON) * (reach.fold(0.0, f64::max) + motions)
}

#[test]
fn contacts_carry_the_nearest_spheres() {
    let mut contacts = 0;
    for family in [
        Family::LargeRotation,
        Family::Grazing,
        Family::FarAway,
        Family::Disparity,
    ] {
        let mut rng = Rng::new(400 + family as u64);
        for k in 0..1800 {
            let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
            let (toi, _) = single_toi(&query, &Subject::Single.options(family.size()));
            if toi.status != ToiStatus::Contact {
                continue;
            }
            contacts += 1;
            let time = f64::from(toi.lower);
            let close = resolution(&query);
            let context = || format!("{family:?} {toi:?}\n{query:?}");
            for body in 0..2 {
                // The sphere lies inside its body: its centre is at least its radius deep.
                let sphere = toi.spheres[body];
                let center = Ball {
                    center: wide(sphere.center),
                    radius: 0.0,
                    displacement: Vector3::zeros(),
                };
                let balls = [frozen(&query, body, time), vec![center]];
                let paths = Paths::new(&Query {
                    balls,
                    motion: Motion::Straight,
                });
                let depth = -distance_at(&paths, 0.0).0;
                assert!(
                    depth >= f64::from(sphere.radius) - close,
                    "{depth} {}",
                    context()
                );
                // The point is on the sphere, towards the other body.
                let sign = [1.0, -1.0][body];
                let point = sphere.center + toi.normal * (sign * sphere.radius);
                assert!(
                    (wide(point) - wide(toi.points[body])).norm() < close,
                    "{}",
                    context()
                );
            }
            // As far apart as the bodies are.
            let [a, b] = toi
                .spheres
                .map(|sphere| (wide(sphere.center), f64::from(sphere.radius)));
            let apart = (a.0 - b.0).norm() - a.1 - b.1;
            let (lower, upper) = distance_at(&Paths::new(&query), time);
            assert!(
                lower - close <= apart && apart <= upper + close,
                "{apart} {lower} {}",
                context()
            );
            let normal = wide(toi.normal);
            assert!((normal.norm() - 1.0).abs() < 1.0e-5, "{}", context());
            // The normal separates the spheres as far as they are apart, to second order in how
            // well f32 resolves the direction between their centres.
            let along = normal.dot(&(b.0 - a.0)) - a.1 - b.1;
            assert!(along >= apart - close, "{along} {apart} {}", context());
        }
    }
    assert!(contacts > 2000, "{contacts}");
}
