//! Faults of builds.

use super::scenes::bodies::boxes;
use super::scenes::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A shelf of boards that touch, with vertices that are off by up to a thousandth, as a file of three decimals leaves
/// them: the sides of its boards, a fiftieth thick, are less flat than those of uneven kits may be. It is fitted, and
/// the cracks between its boards, which a fit closes, count in the error with their depth.
#[test]
fn a_shelf_with_coarse_vertices_is_not_exact() {
    let shelf = |off: Real| {
        let sides = [-0.3, 0.3].map(|x| (Vector::X * x, Vector::new(0.01, 0.15, 0.5)));
        let boards = [-0.45, 0.0, 0.45].map(|z| (Vector::Z * z, Vector::new(0.29, 0.15, 0.01)));
        let back = (Vector::Y * 0.155, Vector::new(0.31, 0.005, 0.5));
        let parts: Vec<_> = sides.into_iter().chain(boards).chain([back]).collect();
        let (mut vertices, indices) = boxes(&parts);
        let mut random = Random(1);
        for vertex in &mut vertices {
            *vertex += Vector::from([(); 3].map(|()| random.within(-off, off)));
        }
        let options = BuildOptions {
            quality: Quality::Fast,
            ..Default::default()
        };
        let (_, report) = MedialMesh::from_trimesh(&vertices, &indices, &options).expect("builds");
        report.variant
    };
    assert_eq!(shelf(3.0e-4), Variant::Exact);
    assert_ne!(shelf(1.0e-3), Variant::Exact);
}
