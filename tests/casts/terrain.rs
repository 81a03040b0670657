//! Contacts of a box that is sunk into a terrain of triangles: where they lead, against the box's corners in `f64`.

use crate::rng::Rng;
use rapier3d::parry::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use rapier3d::parry::shape::TriMesh;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::{MedialDispatcher, MedialMesh};

/// A bumpy terrain, 4 m by 4 m, of triangles with legs of a third of a metre.
fn terrain() -> TriMesh {
    let side = 13u32;
    let point = |k: u32| {
        let (x, z) = (k / side, k % side);
        let height = 0.12 * ((x * 7 + z * 13) % 5) as Real / 4.0;
        Vector::new(x as Real / 3.0 - 2.0, height, z as Real / 3.0 - 2.0)
    };
    let cells = (0..side - 1).flat_map(|x| (0..side - 1).map(move |z| x * side + z));
    let triangles = cells.flat_map(|a| {
        let b = a + side;
        [[a, a + 1, b], [a + 1, b + 1, b]]
    });
    let triangles = triangles.collect();
    TriMesh::new((0..side * side).map(point).collect(), triangles).expect("a terrain")
}

/// Symptom: boxes slept up to 2 cm deep in a terrain. Cause: the slabs along their edges, which are thin, had contacts
/// with triangles that led further in.
#[test]
fn contacts_of_a_box_in_a_terrain_do_not_lead_through_it() {
    let half = Vector::new(0.35, 0.08, 0.25);
    let block = MedialMesh::cuboid(half).expect("a box");
    let ground = terrain();
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mut rng = Rng::new(11);
    let mut random = |by: f64| rng.range(-by, by) as Real;
    let (mut held, mut lost) = (0, 0);
    for _ in 0..2000 {
        let at = Vector::new(random(1.0), 0.16 + random(0.06), random(1.0));
        let turn = Vector::new(random(0.3), random(3.0), random(0.3));
        let pose = Pose::new(at, turn);
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        dispatcher
            .contact_manifolds(
                &pose.inverse(),
                &block,
                &ground,
                0.02,
                &mut manifolds,
                &mut None,
            )
            .expect("supported");
        // How far a contact would have to take the box to lead it out there, and its depth.
        let contacts = manifolds
            .iter()
            .flat_map(|m| m.points.iter().map(move |p| (m.local_n1, p)));
        let deep = contacts.filter(|(_, p)| p.dist < 0.0);
        let ways: Vec<[f64; 2]> = deep
            .map(|(n, p)| {
                let [n, at] = [n, p.local_p1].map(|v| v.as_dvec3());
                let corner: f64 = (n.abs() * half.as_dvec3()).element_sum();
                let depth = -f64::from(p.dist);
                [corner - n.dot(at) + depth, depth]
            })
            .collect();
        let leads_out = |w: &&[f64; 2]| w[0] <= 2.0 * w[1] + 1.0e-5;
        let good = ways.iter().filter(leads_out).count();
        held += usize::from(good > 0);
        lost += usize::from(good == 0 && !ways.is_empty());
        assert!(
            good == 0 || good == ways.len(),
            "at {at}, turned {turn}: {ways:?}"
        );
    }
    println!("{held} held, {lost} without a contact that leads out");
    assert!(held > 1000 && lost * 20 < held, "{held} held, {lost} not");
}
