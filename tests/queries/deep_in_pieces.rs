//! Contacts of a box with a capsule that is deep in it, against directions in double precision: all lead out of the
//! box.

use crate::ccd::rng::Rng;
use nalgebra::Vector3;
use rapier3d::prelude::{Pose, Real, Vector};
use rapier3d_medial::MedialMesh;
use rapier3d_medial::pair::contacts;

type V = Vector3<f64>;

const HALF: [Real; 3] = [0.3, 0.15, 0.2];
const RADIUS: Real = 0.1;

fn exact(v: Vector) -> V {
    V::new(v.x.into(), v.y.into(), v.z.into())
}

/// How far the capsule has to move along a unit direction to leave the box, a length.
fn way_out(ends: [V; 2], n: V) -> f64 {
    let of_box: f64 = (0..3).map(|k| n[k].abs() * f64::from(HALF[k])).sum();
    let near = ends.map(|e| n.dot(&e) - f64::from(RADIUS));
    of_box - near[0].min(near[1])
}

/// Symptom: a ring and a box that were put into each other stayed so, because contacts of the box's own slabs pointed
/// both ways, and rapier's solver could follow neither.
#[test]
fn contacts_of_a_capsule_deep_in_a_box_lead_out_of_it() {
    let [x, y, z] = HALF;
    let block = MedialMesh::cuboid(Vector::new(x, y, z)).expect("a box");
    let mut rng = Rng::new(3);
    let mut inside = |by: f64| rng.range(-by, by) as Real;
    let mut deep = 0;
    for _ in 0..4000 {
        let [a, b] = [(); 2].map(|()| Vector::new(inside(0.4), inside(0.25), inside(0.3)));
        if (b - a).length() < 0.05 {
            continue;
        }
        let capsule = MedialMesh::capsule(a, b, RADIUS).expect("a capsule");
        let ends = [a, b].map(exact);
        let (found, _) = contacts(&block, &capsule, &Pose::IDENTITY, 0.0);
        // The least way out is along a face, or across an edge of the box and the capsule.
        let along = ends[1] - ends[0];
        let axes = [V::x(), V::y(), V::z()];
        let across = axes.map(|e| e.cross(&along));
        let directions = axes.into_iter().chain(across).filter(|n| n.norm() > 1e-9);
        let ways = directions.flat_map(|n| {
            let n = n.normalize();
            [n, -n].map(|n| way_out(ends, n))
        });
        let least = ways.fold(f64::MAX, f64::min);
        // If the capsule's axis is outside the box, other directions count too.
        if least < f64::from(RADIUS) {
            continue;
        }
        deep += 1;
        assert!(!found.is_empty(), "{a} {b}: no contact at {least}");
        let mut deepest: f64 = 0.0;
        for contact in &found {
            let way = way_out(ends, exact(contact.normal));
            assert!(
                way <= 2.05 * least,
                "{a} {b}: {way} out along {}, {least} at least",
                contact.normal
            );
            deepest = deepest.max(-f64::from(contact.distance));
        }
        assert!(
            deepest >= 0.949 * least,
            "{a} {b}: {deepest} deep, {least} in truth"
        );
    }
    assert!(deep > 1000, "{deep}");
}
