//! Bodies that slide off the edge of a table of rapier's shapes, beside rapier's own shapes. The sides of the table are met
//! from inside then, and are no obstacle.

use crate::bodies::attached;
use crate::blocks::{l_shape, prism};
use rapier3d::parry::shape::{ConvexPolyhedron, Cuboid};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Half sides of the tables, metres; a body slides over the edge at `TABLE.x`.
const TABLE: Vector = Vector::new(4.0, 0.5, 4.0);

fn tables() -> Vec<(&'static str, SharedShape)> {
    let (points, _) = Cuboid::new(TABLE).to_trimesh();
    let rim: Vec<_> = (0..24)
        .flat_map(|k| {
            let (y, x) = (k as Real * std::f32::consts::TAU / 24.0).sin_cos();
            [-0.5, 0.5].map(|up| Vector::new(4.0 * x, up, 4.0 * y))
        })
        .collect();
    let hull = |points: &[Vector]| {
        SharedShape::new(ConvexPolyhedron::from_convex_hull(points).expect("a hull"))
    };
    let at = |x: Real| Pose::from_translation(Vector::X * x);
    let half = SharedShape::cuboid(2.0, 0.5, 4.0);
    vec![
        ("cuboid", SharedShape::cuboid(4.0, 0.5, 4.0)),
        ("hull", hull(&points)),
        ("round hull", hull(&rim)),
        ("rounded cuboid", SharedShape::round_cuboid(3.9, 0.4, 3.9, 0.1)),
        ("compound", SharedShape::compound(vec![(at(-2.0), half.clone()), (at(2.0), half)])),
    ]
}

/// Bodies and the height of their centre over what they lie on.
fn sliders() -> Vec<(&'static str, MedialMesh, Real)> {
    let (outline, faces) = l_shape();
    let l = prism(&outline, &faces);
    vec![]
}
