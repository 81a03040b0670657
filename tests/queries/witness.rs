//! The spheres, points and normal of an answer: they are on the bodies, and they are the nearest.

use crate::ccd::contact::distance_at;
use crate::ccd::families::Family;
use crate::ccd::motion::{Ball, Motion, Paths, Query};
use crate::ccd::rng::Rng;
use crate::ccd::subject::{Subject, single_toi};
use nalgebra::Vector3;
use rapier3d_medial::MedialSphere;
use rapier3d_medial::elementary::ToiStatus;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::pair::{PrimitiveList, contacts};

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

/// Spheres all over a slab, in steps of a twelfth of its sides.
fn all_over(slab: &[MedialSphere; 3]) -> Vec<(Vector3<f64>, f64)> {
    const STEPS: u32 = 12;
    let mut spheres = Vec::new();
    for i in 0..=STEPS {
        for j in 0..=STEPS - i {
            let shares = [i, j, STEPS - i - j].map(|k| f64::from(k) / f64::from(STEPS));
            let parts = slab.iter().zip(shares);
            spheres.push(parts.fold((Vector3::zeros(), 0.0), |sum, (s, share)| {
                let radius = f64::from(s.radius);
                (sum.0 + wide(s.center) * share, sum.1 + radius * share)
            }));
        }
    }
    spheres
}

/// Of two slabs with a common centre, several elementary tests have their nearest spheres at one point and along one
/// normal, all the more where corners of a slab have one centre. The deepest of them is told: no sphere of one slab is
/// nearer to any of the other.
#[test]
fn the_deepest_of_contacts_at_one_point_is_told() {
    let mut rng = Rng::new(31);
    for k in 0..3000 {
        let slab = |rng: &mut Rng| {
            [0; 3].map(|_| {
                let at = rng.in_ball().cast::<f32>();
                let radius = rng.log_range(0.01, 0.3) as Real;
                MedialSphere::new(Vector::new(at.x, at.y, at.z), radius)
            })
        };
        let (a, mut b) = (slab(&mut rng), slab(&mut rng));
        let place = [0.0, 0.5, rng.range(0.0, 1.0)][k % 3] as Real;
        b[0].center = a[0].center + (a[1].center - a[0].center) * place;
        match k / 3 % 4 {
            0 => {}
            1 => b[2].center = b[1].center,
            2 => b = b.map(|s| MedialSphere::new(b[0].center, s.radius)),
            _ => b[1].center = a[1].center,
        }
        let soup = |slab: &[MedialSphere; 3]| {
            let mut soup = PrimitiveList::default();
            soup.push(slab);
            soup
        };
        let (found, _) = contacts(&soup(&a), &soup(&b), &Pose::IDENTITY, 0.0);
        let told = found.iter().map(|c| f64::from(c.distance));
        let told = told.fold(f64::MAX, f64::min);
        let mut nearest = f64::MAX;
        for (p, r) in all_over(&a) {
            for (q, s) in all_over(&b) {
                nearest = nearest.min((q - p).norm() - r - s);
            }
        }
        assert!(told < nearest + 1.0e-6, "{k}: {told}, but {nearest}");
    }
}
