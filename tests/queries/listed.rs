//! Contacts from lists of primitive pairs: brute force over all pairs says which are near, lists with others beside
//! them, in any order, have the contacts of the search, bit by bit; a list that lacks one has not.

use crate::ccd::rng::Rng;
use crate::detailed::{Form, detailed};
use crate::meshes::{mesh, vector};
use rapier3d_medial::elementary::distance::signed_distance;
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::pair::{SpherePair, contacts, contacts_of_listed};
use rapier3d_medial::{MedialMesh, MedialPrimitive, MedialSphere};

fn bodies(rng: &mut Rng) -> Vec<MedialMesh> {
    let box_frame = MedialMesh::box_frame(Vector::new(0.4, 0.3, 0.5), 0.05);
    let solid = |built: Result<MedialMesh, _>| built.expect("a solid");
    vec![
        mesh(rng),
        solid(MedialMesh::torus(0.5, 0.1, 24)),
        solid(MedialMesh::rectangle_frame(0.4, 0.3, 0.06)),
        solid(box_frame),
        solid(MedialMesh::ball(0.3)),
        detailed(Form::Ring, 50),
        detailed(Form::Spider, 60),
        detailed(Form::Bear, 60),
        detailed(Form::Sheet, 60),
    ]
}

/// Spheres in the first body's frame, in double precision.
fn placed(primitive: &MedialPrimitive, pose: &Pose) -> Vec<(Vec3<f64>, f64)> {
    let wide = |v: Vector| Vec3::<f64>::from_vector(v);
    let turn = |axis| wide(pose.rotation * axis);
    let axes = [Vector::X, Vector::Y, Vector::Z].map(turn);
    let at = |s: &MedialSphere| {
        let c = wide(s.center);
        let turned = axes[0] * c.x + axes[1] * c.y + axes[2] * c.z;
        (turned + wide(pose.translation), f64::from(s.radius))
    };
    primitive.spheres().iter().map(at).collect()
}

/// All primitive pairs within a distance, by brute force.
fn near(meshes: [&MedialMesh; 2], pos12: &Pose, distance: f64) -> Vec<[u32; 2]> {
    let poses = [&Pose::IDENTITY, pos12];
    let [first, second] = [0, 1].map(|k: usize| {
        let spheres = meshes[k].primitives().map(|p| placed(&p, poses[k]));
        spheres.collect::<Vec<_>>()
    });
    let mut near = Vec::new();
    for (p, a) in (0u32..).zip(&first) {
        for (q, b) in (0u32..).zip(&second) {
            // Axes are turned in single precision here.
            if signed_distance(a, b) <= distance + 1.0e-5 {
                near.push([p, q]);
            }
        }
    }
    near
}

fn shuffle(rng: &mut Rng, list: &mut [[u32; 2]]) {
    for k in (1..list.len()).rev() {
        list.swap(k, rng.below(k + 1));
    }
}

fn bits(contacts: &[SpherePair]) -> Vec<u32> {
    let each = |c: &SpherePair| {
        let numbers = [c.points[0], c.points[1], c.normal].map(|v| v.to_array());
        let numbers = numbers.concat().into_iter().map(Real::to_bits);
        let named = [c.primitives[0], c.primitives[1], c.feature];
        numbers.chain(named).chain([c.distance.to_bits()])
    };
    contacts.iter().flat_map(each).collect()
}

#[test]
fn lists_have_the_contacts_of_the_search() {
    let mut rng = Rng::new(2301);
    let bodies = bodies(&mut rng);
    let (mut touching, mut several, mut found_in_all) = (0, 0, 0);
    for k in 0..900 {
        let [a, b] = [&bodies[k % 9], &bodies[k / 9 % 9]];
        let away = vector(&mut rng) * [0.1, 0.5, 0.8, 1.2][k % 4];
        // Also placed alike, so that distances are equal and primitives cross.
        let turn = if k % 5 == 0 {
            Vector::ZERO
        } else {
            vector(&mut rng) * 3.0
        };
        let pos12 = Pose::new(away, turn);
        let prediction = [0.0, 0.002, 0.02, 0.1][k / 4 % 4];
        let (expected, _) = contacts(a, b, &pos12, prediction);
        let needed = near([a, b], &pos12, prediction.into());
        let counts = [a, b].map(MedialMesh::primitive_count);
        let all = (0..counts[0] as u32).flat_map(|p| (0..counts[1] as u32).map(move |q| [p, q]));
        let all: Vec<_> = all.collect();
        for others in [0, 5, all.len()] {
            let mut listed = needed.clone();
            listed.extend((0..others).map(|_| all[rng.below(all.len())]));
            // What does not exist.
            listed.extend([[u32::MAX, 0], [0, counts[1] as u32]].iter().take(others));
            shuffle(&mut rng, &mut listed);
            let (found, _) = contacts_of_listed(a, b, &pos12, prediction, &mut listed);
            assert_eq!(bits(&found), bits(&expected), "{k}: {others} others");
        }
        let (found, _) = contacts_of_listed(a, b, &pos12, prediction, &mut all.clone());
        assert_eq!(bits(&found), bits(&expected), "{k}: all");
        touching += usize::from(!expected.is_empty());
        several += usize::from(expected.len() > 3);
        found_in_all += expected.len();
    }
    println!("{touching} of 900 touch, {several} at more than 3 places; {found_in_all} contacts");
    assert!(touching > 400 && touching < 800, "{touching}");
    assert!(several > 200, "{several}");
}

/// The list decides: without the primitive pair of a contact, that contact is missing.
#[test]
fn primitives_not_listed_are_not_found() {
    let ring = MedialMesh::torus(0.5, 0.1, 24).expect("a ring");
    let pos12 = Pose::from_translation(Vector::new(0.95, 0.1, 0.0));
    let (expected, _) = contacts(&ring, &ring, &pos12, 0.02);
    assert!(expected.len() > 1);
    for left_out in &expected {
        let mut listed = near([&ring; 2], &pos12, 0.02);
        listed.retain(|pair| *pair != left_out.primitives);
        let (found, _) = contacts_of_listed(&ring, &ring, &pos12, 0.02, &mut listed);
        assert!(found.iter().all(|c| c.primitives != left_out.primitives));
        assert_ne!(bits(&found), bits(&expected));
    }
}

/// No pose, no list, and a prediction that asks for overlaps only, which is searched whatever is listed.
#[test]
fn empty_lists_and_what_is_not_listed_by() {
    let ring = MedialMesh::torus(0.5, 0.1, 24).expect("a ring");
    let beside = Pose::from_translation(Vector::X * 0.95);
    let of = |pose: &Pose, prediction| contacts_of_listed(&ring, &ring, pose, prediction, &mut []);
    assert!(of(&beside, 0.02).0.is_empty());
    assert!(!contacts(&ring, &ring, &beside, 0.02).0.is_empty());
    let nowhere = Pose::from_translation(Vector::X * Real::NAN);
    assert!(of(&nowhere, 0.02).0.is_empty());
    let deep = contacts(&ring, &ring, &beside, -0.01).0;
    assert!(!deep.is_empty());
    assert_eq!(bits(&of(&beside, -0.01).0), bits(&deep));
}
