//! How deep the contacts of rapier's narrow phase are where their colliders are now. rapier keeps contacts until their
//! pair has moved by its recycle distance, so the distances it stores may be out of date by more than a thin part is
//! thick.

use crate::math::{Pose, Real};
use rapier3d::geometry::ContactManifold;

/// Depth of the deepest contact of a manifold at these poses of its colliders, or when it was computed, whichever is
/// more: a length, 0 if none is in contact.
pub fn deepest(manifold: &ContactManifold, poses: [&Pose; 2]) -> Real {
    let parts = [manifold.subshape_pos1(), manifold.subshape_pos2()];
    let [pose1, pose2] = [0, 1].map(|k| parts[k].map_or(*poses[k], |part| poses[k] * part));
    let normal = pose1.rotation * manifold.local_n1;
    let depths = manifold.points.iter().map(|p| {
        let distance = (pose2 * p.local_p2 - pose1 * p.local_p1).dot(normal);
        -distance.min(p.dist)
    });
    depths.fold(0.0, Real::max)
}
