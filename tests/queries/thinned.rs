//! Hundreds of contacts of smooth bodies: those at one place are one, and of those at about one place under about one
//! normal the nearest stays.

use crate::ccd::rng::Rng;
use crate::meshes::vector;
use rapier3d_medial::MedialMesh;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::pair::thinned::thin;
use rapier3d_medial::pair::{SpherePair, contacts, contacts_of_listed};

const MINOR: Real = 0.12;

fn ring(cones: usize) -> MedialMesh {
    MedialMesh::torus(0.5, MINOR, cones).expect("a ring")
}

/// The rule by which contacts at one place are one, applied one by one: the last of those within a ten-thousandth of
/// both radii of each other, under normals within 10°, gives way to a nearer one.
fn one_of_each_place(all: impl Iterator<Item = SpherePair>) -> Vec<SpherePair> {
    let apart = 1.0e-4 * 2.0 * f64::from(MINOR);
    let wide = |v: Vector| v.to_array().map(f64::from);
    let mut found: Vec<SpherePair> = Vec::new();
    for contact in all {
        let same = found.iter_mut().rev().find(|c| {
            let [p, q] = [wide(c.points[0]), wide(contact.points[0])];
            let square: f64 = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum();
            square <= apart * apart && c.normal.dot(contact.normal) >= 0.985
        });
        match same {
            None => found.push(contact),
            Some(c) if contact.distance < c.distance => *c = contact,
            Some(_) => {}
        }
    }
    found
}

#[test]
fn of_hundreds_of_contacts_those_at_one_place_are_one() {
    let mut rng = Rng::new(2611);
    let ring = ring(100);
    let count = ring.primitive_count() as u32;
    let mut most = 0;
    for k in 0..12 {
        // On each other, beside each other, and through each other.
        let away = [Vector::Y * 0.24, Vector::X * 1.24, Vector::X * 0.6][k % 3];
        let turn = vector(&mut rng) * [0.02, 0.3][k % 2];
        let pos12 = Pose::new(away + vector(&mut rng) * 0.01, turn);
        let mut all: Vec<[u32; 2]> = (0..count)
            .flat_map(|p| (0..count).map(move |q| [p, q]))
            .collect();
        let (found, _) = contacts(&ring, &ring, &pos12, 0.02);
        let (listed, _) = contacts_of_listed(&ring, &ring, &pos12, 0.02, &mut all.clone());
        assert_eq!(found, listed, "{k}");
        // Each primitive pair alone has no others to be one with but its own.
        all.sort_by_key(|pair| found.iter().position(|c| c.primitives == *pair));
        let alone = all
            .iter()
            .flat_map(|pair| contacts_of_listed(&ring, &ring, &pos12, 0.02, &mut [*pair]).0);
        let expected = one_of_each_place(alone);
        assert_eq!(found.len(), expected.len(), "{k}");
        most = most.max(found.len());
    }
    println!("{most} contacts at most");
    assert!(most > 400, "{most}");
}

/// What is left out has a nearer one beside it, and what is left lacks none.
#[test]
fn the_nearest_contact_of_each_place_stays() {
    let ring = ring(200);
    let pos12 = Pose::new(Vector::new(0.03, 0.235, 0.0), Vector::new(0.01, 0.2, 0.0));
    let (all, _) = contacts(&ring, &ring, &pos12, 0.02);
    assert!(all.len() > 500, "{} contacts", all.len());
    for apart in [0.005, 0.03, 0.2] {
        let mut left = all.clone();
        thin(&mut left, apart);
        assert!(left.len() < all.len(), "{} of {}", left.len(), all.len());
        for c in &all {
            let stands_in = |k: &&SpherePair| {
                k.distance <= c.distance
                    && k.points[0].distance(c.points[0]) <= apart * Real::sqrt(3.0)
                    && k.normal.angle_between(c.normal) <= Real::to_radians(12.5)
            };
            assert!(left.iter().any(|k| stands_in(&k)), "{apart}: {c:?}");
        }
        let mut of_all = all.iter();
        assert!(
            left.iter().all(|c| of_all.any(|k| k == c)),
            "in their order"
        );
    }
    let mut few = all[..256].to_vec();
    thin(&mut few, 0.2);
    assert_eq!(few, all[..256]);
}
