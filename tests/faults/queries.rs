//! What is known to be wrong of queries.

use rapier3d::parry::query::QueryDispatcher;
use rapier3d::prelude::*;
use rapier3d_medial::MedialDispatcher;
use rapier3d_medial::prelude::*;

/// parry merges the faces of a hull that are about as one into one of a single normal, without the corners between
/// them: of a box with a roof 8 mm high it keeps one tilted face. Its surface is what medial bodies are held against,
/// so that they are off by some of these 8 mm there; rapier's own shapes are held against the corners.
#[test]
fn blunt_roofs_of_hulls_are_not_where_they_are() {
    let corner = |k: u8| {
        let side = |bit: u8| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Vector::new(0.5 * side(0), 0.2 * side(1), 0.5 * side(2))
    };
    let mut corners: Vec<Vector> = (0..8).map(corner).collect();
    corners.push(Vector::Y * 0.208);
    let hull = SharedShape::convex_hull(&corners).expect("a box with a roof");
    let ball = MedialMesh::ball(0.001).expect("a ball");
    let dispatcher = MedialDispatcher::default();
    let mut off = 0;
    for k in 0..400 {
        let [x, z] = [k % 20, k / 20].map(|i| 0.04 * (i as Real - 9.5));
        let roof = 0.208 - 0.016 * x.abs().max(z.abs());
        let pose = Pose::translation(x, roof + 0.011, z);
        let told = dispatcher.distance(&pose, &*hull, &ball).expect("known");
        off += usize::from((told.distance - 0.01).abs() > 1.0e-3);
    }
    assert!(off > 100, "{off} of 400 are off");
}
