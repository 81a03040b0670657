//! Points and normals of parry's contact manifolds in the frames of the two bodies: parry keeps them in those of the
//! parts that touch.

use crate::math::{Pose, Vector};
use parry3d::query::ContactManifold;

/// The two points of a contact, each in its body's frame.
pub fn places<M, C>(manifold: &ContactManifold<M, C>, i: usize) -> [Vector; 2] {
    let point = &manifold.points[i];
    let in_body = |pose: Option<&Pose>, p: Vector| pose.map_or(p, |pose| pose * p);
    [
        in_body(manifold.subshape_pos1(), point.local_p1),
        in_body(manifold.subshape_pos2(), point.local_p2),
    ]
}

/// The normals out of both bodies, each in its body's frame.
pub fn normals<M, C>(manifold: &ContactManifold<M, C>) -> [Vector; 2] {
    let in_body = |pose: Option<&Pose>, n: Vector| pose.map_or(n, |pose| pose.rotation * n);
    [
        in_body(manifold.subshape_pos1(), manifold.local_n1),
        in_body(manifold.subshape_pos2(), manifold.local_n2),
    ]
}
