//! Points where two shapes touch: those of the contacts that rapier's solver would get of them.

use super::dispatcher::MedialDispatcher;
use crate::math::{Pose, Real, Vector};
use crate::parry::contacts::manifold_points::{normals, places};
use parry3d::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use parry3d::shape::Shape;

/// A point where two shapes touch.
pub struct TouchingPoint {
    /// Where it is on each shape, in that shape's frame.
    pub places: [Vector; 2],
    /// Unit normal out of the first shape, in its frame.
    pub normal: Vector,
    /// Signed distance, a length.
    pub distance: Real,
}

/// Where two shapes are no farther apart than `prediction` (a length). `pos12` is the pose of the second in the frame
/// of the first.
pub fn touching_points(
    shapes: [&dyn Shape; 2],
    pos12: &Pose,
    prediction: Real,
) -> Vec<TouchingPoint> {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    let [a, b] = shapes;
    let asked = dispatcher.contact_manifolds(pos12, a, b, prediction, &mut manifolds, &mut None);
    if asked.is_err() {
        return Vec::new();
    }
    let points = manifolds.iter().flat_map(|m| {
        m.points.iter().enumerate().map(|(i, point)| TouchingPoint {
            places: places(m, i),
            normal: normals(m)[0],
            distance: point.dist,
        })
    });
    points
        .filter(|point| point.distance <= prediction)
        .collect()
}
