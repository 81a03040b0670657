//! Bodies of flat faces with fewer primitives than they would be exact with: most of the exact medial mesh is kept.

use crate::drums::{build, drum};
use crate::oracle::Random;
use crate::polyhedra::{hull, off, points_in_ball};
use rapier3d_medial::{BuildOptions, MedialMesh, Quality, Variant};

/// Hulls of random points in a ball, against their planes.
#[test]
fn hulls_with_a_twentieth_of_the_primitives_fewer_are_nearly_exact() {
    for seed in 1..=4 {
        let mesh = hull(&points_in_ball(&mut Random(seed), 24));
        let built = |primitives: usize| {
            let options = BuildOptions {
                primitives: Some(primitives),
                quality: Quality::Fast,
                ..Default::default()
            };
            MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options).expect("a hull")
        };
        let (exact, report) = built(1_000);
        assert_eq!(report.variant, Variant::Exact);
        let fewer = exact.primitive_count() * 19 / 20;
        let (medial, report) = built(fewer);
        assert_eq!(report.variant, Variant::Reduced, "{seed}");
        assert!(report.primitives <= fewer);
        assert_eq!(report.exact_with, Some(exact.primitive_count()));
        let [error, bound] = [report.hausdorff.error(), report.hausdorff.bound()]
            .map(|length| f64::from(length / report.longest_side));
        let (bloat, uncovered) = off(&mesh, &medial, seed, 2_000);
        assert!(error <= 0.005, "{seed}: {error}");
        assert!(bloat <= bound, "{seed}: {bloat} of {bound}");
        assert!(uncovered < 1.0e-6, "{seed}: {uncovered}");
    }
}

/// The pieces of a drum are reduced together.
#[test]
fn drums_with_some_primitives_fewer_are_nearly_exact() {
    let (_, report) = build(&drum(12, 4, 0.1), Quality::Fast, 450);
    assert_eq!(report.variant, Variant::Reduced);
    assert!(report.hausdorff.error() < 0.002, "{:?}", report.hausdorff);
    assert!(report.exact_with.is_some_and(|count| count > 450));
}
