//! Blunt tips of what touches at the start: they may pass each other where they are thin, what is behind them is
//! stopped, and the normal is that of what meets. All of it planted.

use crate::ccd::rng::Rng;
use crate::meshes::vector;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::{Cores, InitialContact, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Real, Vector};
use rapier3d_medial::pair::first_contact::first_contact_counted;
use rapier3d_medial::pair::{PrimitiveList, first_contact};
use rapier3d_medial::{MedialMesh, MedialSphere};

/// Queries with normals.
const QUERIES: u32 = 1000;

const TOLERANCE: Real = 1.0e-5;

fn options(by: Real, tips: Real) -> ToiOptions {
    ToiOptions {
        tolerance: TOLERANCE,
        initial_contact: InitialContact::Deepen { by },
        cores: Some(Cores {
            share: 0.0,
            at_most: Real::INFINITY,
            tips,
        }),
        ..ToiOptions::default()
    }
}

fn sliding(linvel: Vector) -> NonlinearRigidMotion {
    NonlinearRigidMotion {
        linvel,
        ..NonlinearRigidMotion::identity()
    }
}

/// A cone from its tip, where its radius is 0, to where it is 0.5, 1 m away.
fn cone(tip: Vector, along: Vector) -> MedialMesh {
    let spheres = [
        MedialSphere::new(tip, 0.0),
        MedialSphere::new(tip + along, 0.5),
    ];
    MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a cone")
}

/// Two cones, tip to tip, a millimetre beside each other, the upper one on its way down. Both are 0.5 thick, so with a
/// share of 0.2 their tips pass up to where their radii are 0.05, which is 0.1 behind the tip. The spheres there start
/// 0.198 from each other, and what counts as touching is let sink in by 0.02: a contact where they are that deep.
#[test]
fn blunt_tips_pass_as_far_as_their_share_and_no_further() {
    let aside = 1.0e-3;
    let lower = cone(Vector::ZERO, -Vector::Y);
    let upper = cone(Vector::new(aside, -0.002, 0.0), Vector::Y);
    let still = sliding(Vector::ZERO);
    let moving = sliding(-0.5 * Vector::Y);
    let by = 0.02;
    let toi = first_contact(&lower, &still, &upper, &moving, 1.0, &options(by, 0.2));
    let apart: Real = 0.1 - by;
    let way = 0.198 - (apart * apart - aside * aside).sqrt();
    assert_eq!(toi.status, ToiStatus::Contact);
    assert!((0.5 * toi.lower - way).abs() < 1.0e-4, "{toi:?}, {way}");
    assert!(toi.normal.y > 0.99, "{toi:?}");
    // Without a share, the tips are stopped before they pass.
    let toi = first_contact(&lower, &still, &upper, &moving, 1.0, &options(by, 0.0));
    assert!(
        toi.status == ToiStatus::Contact && 0.5 * toi.lower < 0.001,
        "{toi:?}"
    );
}

/// The edge of a slab, of radius 0, is 0.01 below a floor; 0.6 above the edge its radius is 0.3. Of a body and a
/// surface the body has all of the share: the floor meets the radius 0.06, which is 0.12 from the edge, 0.01 deep.
#[test]
fn body_behind_an_edge_that_has_passed_is_stopped() {
    let corner = |x, y, radius| MedialSphere::new(Vector::new(x, y, 0.0), radius);
    let spheres = vec![
        corner(-0.5, -0.01, 0.0),
        corner(0.5, -0.01, 0.0),
        corner(0.0, 0.59, 0.3),
    ];
    let slab = MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).expect("a slab");
    let mut floor = PrimitiveList::default();
    let corners = [(-9.0, -9.0), (9.0, -9.0), (0.0, 9.0)];
    floor.push(&corners.map(|(x, z)| MedialSphere::new(Vector::new(x, 0.0, z), 0.0)));
    floor.end_part();
    let (still, moving) = (sliding(Vector::ZERO), sliding(-Vector::Y));
    let (toi, _) = first_contact_counted(&slab, &moving, &floor, &still, 1.0, &options(0.01, 0.2));
    assert_eq!(toi.status, ToiStatus::Contact);
    assert!((toi.lower - 0.06).abs() < 1.0e-4, "{toi:?}");
    assert!(toi.normal.y < -0.999, "{toi:?}");
}

/// At a first contact the bodies approach along the normal told, however deep thick parts are in each other beside it.
#[test]
fn bodies_approach_along_the_normal_of_their_first_contact() {
    let mut rng = Rng::new(11);
    let mut met = 0;
    for case in 0..QUERIES {
        let mesh = |rng: &mut Rng, at: Vector| {
            let radii = [0.0, 0.3 * rng.range(0.5, 1.0) as Real];
            let ends = [at + vector(rng) * 0.3, at + vector(rng) * 0.3];
            let spheres = [0, 1].map(|k| MedialSphere::new(ends[k], radii[k]));
            MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a rod")
        };
        let (a, b) = (mesh(&mut rng, Vector::ZERO), mesh(&mut rng, Vector::ZERO));
        let moving = sliding(vector(&mut rng) * 0.3);
        let still = sliding(Vector::ZERO);
        let toi = first_contact(&a, &still, &b, &moving, 1.0, &options(0.05, 0.0));
        if toi.status == ToiStatus::Contact && toi.lower > 1.0e-3 {
            met += 1;
            let approach = moving.linvel.dot(toi.normal);
            assert!(approach < 1.0e-4, "case {case}: {approach}, {toi:?}");
        }
    }
    assert!(met > QUERIES / 20, "only {met} met");
}
