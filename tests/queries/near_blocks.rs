//! Blocks of flat faces that are near each other without touching, as a character beside a wall is: how far they are
//! apart, and that a query that starts within its target distance says so, both against the distance of their
//! triangles in double precision, and by few elementary tests.

use crate::blocks::{l_shape, prism, t_shape};
use crate::ccd::rng::Rng;
use crate::convex_pieces::{V, cuboid, mesh_of, motion};
use crate::truth_of_examples::mesh::Mesh;
use crate::truth_of_examples::triangle_toi::{TriangleBody, distance_at};
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::TriMesh;
use rapier3d::prelude::{Real, Vector};
use rapier3d_medial::pair::first_contact::first_contact_counted;
use rapier3d_medial::pair::nearest_spheres;
use rapier3d_medial::{MedialMesh, ToiOptions, ToiStatus};

/// What two blocks are thicker than their triangles, and rounding of the poses, together.
const THICKER: f64 = 6.0e-6;

/// A U-shaped block of 1 m by 1 m by 0.27 m.
fn u_shape() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let outline = [
        (0.0, 0.0),
        (3.0, 0.0),
        (3.0, 3.0),
        (2.0, 3.0),
        (2.0, 1.0),
        (1.0, 1.0),
        (1.0, 3.0),
        (0.0, 3.0),
    ];
    let outline = outline.map(|(x, y): (Real, Real)| ((x - 1.5) / 3.0, (y - 1.5) / 3.0));
    let base = [[0, 1, 4], [0, 4, 5]];
    let arms = [[1, 2, 3], [1, 3, 4], [0, 5, 6], [0, 6, 7]];
    prism(&outline, &[&base[..], &arms[..]].concat(), [-0.135, 0.135])
}

/// The blocks, and their triangles.
fn blocks() -> [(Mesh, MedialMesh); 4] {
    let built = [l_shape(), t_shape(), u_shape()];
    let [l, t, u] = built.map(|(vertices, indices)| Mesh { vertices, indices });
    [l, t, u, cuboid([0.3, 0.2, 0.5])].map(|source| {
        let mesh = mesh_of(&source);
        (source, mesh)
    })
}

#[test]
fn blocks_are_as_far_apart_as_their_triangles() {
    let blocks = blocks();
    let mut rng = Rng::new(4101);
    let (mut apart, mut tests) = (0, 0);
    for case in 0..600 {
        let [i, j] = [case % 4, case / 4 % 4];
        let first = motion(V::zeros(), V::zeros(), rng.in_ball());
        let second = motion(rng.in_ball() * 1.6, V::zeros(), rng.in_ball() * 3.0);
        let bodies = [i, j].map(|k| TriangleBody::new(&blocks[k].0));
        let truth = distance_at([&bodies[0], &bodies[1]], [&first.0, &second.0], 1.0);
        let [p, q] = [&first.1, &second.1].map(|m| m.position_at_time(1.0));
        let [a, b] = [&blocks[i].1, &blocks[j].1];
        let (found, counts) = nearest_spheres(a, b, &(p.inverse() * q), f32::MAX);
        let found = f64::from(found.expect("a pair").distance);
        if truth < 1.0e-3 {
            assert!(found < truth + THICKER, "{case}: {found}, truly {truth}");
            continue;
        }
        assert!(
            (found - truth).abs() < THICKER,
            "{case}: {found}, truly {truth}"
        );
        apart += 1;
        tests += counts.tests;
        // What is asked for to the last digit is found.
        let limit = (found as f32).next_up();
        let (again, _) = nearest_spheres(a, b, &(p.inverse() * q), limit);
        let again = again.map(|pair| pair.distance);
        assert!(
            again.is_some_and(|d| d <= limit),
            "{case}: {again:?} within {limit}"
        );
    }
    println!("{apart} apart, {tests} elementary tests");
    assert!(apart > 200, "{apart}");
    assert!(tests < 25 * apart, "{tests} elementary tests for {apart}");
}

#[test]
fn blocks_within_the_target_distance_are_told_so_at_once() {
    let blocks = blocks();
    let surface = |(source, _): &(Mesh, MedialMesh)| {
        TriMesh::new(source.vertices.clone(), source.indices.clone()).expect("a surface")
    };
    let surfaces = blocks.each_ref().map(surface);
    let mut rng = Rng::new(4102);
    let (mut within, mut tests) = (0, 0);
    for case in 0..2000 {
        let [i, j] = [case % 4, case / 4 % 4];
        let first = motion(V::zeros(), rng.in_ball() * 0.05, V::zeros());
        let second = motion(rng.in_ball() * 1.2, V::zeros(), V::zeros());
        let bodies = [i, j].map(|k| TriangleBody::new(&blocks[k].0));
        let truth = distance_at([&bodies[0], &bodies[1]], [&first.0, &second.0], 0.0);
        if truth < 1.0e-3 {
            continue;
        }
        let target = truth + rng.range(-0.5, 0.5) * truth;
        let options = ToiOptions {
            target_distance: target as f32,
            ..ToiOptions::default()
        };
        let [a, b] = [&blocks[i].1, &blocks[j].1];
        let (toi, counts) = first_contact_counted(a, &first.1, b, &second.1, 1.0, &options);
        let beyond = truth - target;
        if beyond < -THICKER {
            assert_eq!(
                toi.status,
                ToiStatus::Overlapping,
                "{case}: {beyond} {toi:?}"
            );
            let found = f64::from((toi.points[1] - toi.points[0]).dot(toi.normal));
            let told = truth - THICKER..target + THICKER;
            assert!(told.contains(&found), "{case}: {found}, truly {truth}");
            for (side, (block, (_, motion))) in [(i, &first), (j, &second)].iter().enumerate() {
                let pose = motion.position_at_time(0.0);
                let off = surfaces[*block].distance_to_point(&pose, toi.points[side], false);
                assert!(f64::from(off) < THICKER, "{case}: {off} off the surface");
            }
            within += 1;
            tests += counts.tests;
        } else if beyond > THICKER + f64::from(options.tolerance) {
            assert!(toi.upper > 0.0, "{case}: {beyond} {toi:?}");
        }
    }
    println!("{within} within, {tests} elementary tests");
    assert!(within > 300, "{within}");
    assert!(10 * tests < within, "{tests} elementary tests for {within}");
}
