//! Bodies whose primitives are all within the prediction distance of each other: the nearest contacts are found, among
//! them all that nearly touch. Brute force over all pairs of spheres, in `f64`, says which these are.

use crate::ccd::rng::Rng;
use crate::meshes::vector;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::pair::{contacts, contacts_of_listed};
use rapier3d_medial::{MedialMesh, MedialSphere};

const SPHERES: usize = 120;

/// Spheres that do not touch, within 3 cm.
fn cloud(rng: &mut Rng, radius: Real) -> MedialMesh {
    let spheres = (0..SPHERES).map(|_| MedialSphere::new(vector(rng) * 0.015, radius));
    MedialMesh::new(spheres.collect(), vec![], vec![]).expect("spheres")
}

/// Distances of all pairs of spheres.
fn distances(meshes: [&MedialMesh; 2], pos12: &Pose) -> Vec<([u32; 2], f64)> {
    let wide = |v: Vector| v.to_array().map(f64::from);
    let primitives = |k: usize| (0u32..).zip(meshes[k].primitives());
    let mut all = Vec::new();
    for (i, a) in primitives(0) {
        for (j, b) in primitives(1) {
            let [a, b] = [a.spheres()[0], b.spheres()[0]];
            let [p, q] = [wide(a.center), wide(pos12.translation + b.center)];
            let squared: f64 = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum();
            all.push(([i, j], squared.sqrt() - f64::from(a.radius + b.radius)));
        }
    }
    all
}

#[test]
fn of_very_many_contacts_the_nearest_are_found() {
    let mut rng = Rng::new(7701);
    let (mut shortened, mut complete) = (0, 0);
    for k in 0..60 {
        // Apart, mixed without touching, and overlapping.
        let radius = [2.0e-4, 1.0e-3, 6.0e-3][k % 3];
        let [a, b] = [0, 1].map(|_| cloud(&mut rng, radius));
        let away = Vector::X * [0.05, 0.03, 0.0, 0.0][k / 3 % 4];
        let pos12 = Pose::from_translation(away);
        let prediction = [0.0, 0.02, 0.1][k / 12 % 3];
        let expected = distances([&a, &b], &pos12);
        let (found, _) = contacts(&a, &b, &pos12, prediction);
        let within = expected.iter().filter(|(_, d)| *d <= prediction.into());
        let within = within.count();
        if within <= 2048 {
            assert_eq!(found.len(), within, "{k}");
            complete += usize::from(within > 0);
        } else {
            let touch = |d: f64| d < f64::from(prediction) / 8.0 - 1.0e-7;
            let touching = expected.iter().filter(|(_, d)| touch(*d)).count();
            let most = 2048.max(2 * touching + 1);
            assert!(
                (1024.max(touching)..=most).contains(&found.len()),
                "{k}: {} of {within}, {touching} touch",
                found.len()
            );
            shortened += usize::from(found.len() < within);
        }
        let farthest = found
            .iter()
            .map(|c| f64::from(c.distance))
            .fold(-1.0, f64::max);
        for (pair, distance) in &expected {
            let is_found = found.iter().any(|c| c.primitives == *pair);
            let is_near = *distance < farthest - 1.0e-7;
            assert!(
                is_found || !is_near,
                "{k}: {pair:?} at {distance} is missing"
            );
        }
        let mut listed: Vec<_> = expected.iter().map(|(pair, _)| *pair).collect();
        let (of_list, _) = contacts_of_listed(&a, &b, &pos12, prediction, &mut listed);
        assert_eq!(found, of_list, "{k}");
    }
    println!("{shortened} of 60 had too many contacts, {complete} had not");
    assert!(shortened > 25 && complete > 10);
}
