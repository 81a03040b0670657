//! Normals of contacts of sharp edges with voxels. parry asks for the contacts of a primitive with a box around all
//! neighbouring voxels, by GJK, whose direction is noise where the two just touch: a slab that stands on a flat floor
//! then has contacts to its sides. What touches a face can be pushed along its normal only, and at the border of
//! several along one between theirs. Of rounded parts GJK sees what is within their surface, which does not touch.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::contacts::manifold_points::places;
use crate::parry::partners::shape_faces::free_faces;
use parry3d::bounding_volume::Aabb;
use parry3d::query::ContactManifold;
use parry3d::shape::Voxels;

/// Distance from a face within which a contact is on it, in units of the voxels' smallest side.
const ON_FACE: Real = 0.01;

/// Cosine with the nearest normal that is possible from which a normal is left as it is (8°).
const POSSIBLE: Real = 0.99;

/// Cosine with the only face that a contact is on, from which a normal is turned to that of the face (down to 6° below
/// its plane). A normal below that is left: the mesh is on the other side.
const BACKFACE_COSINE: Real = -0.1;

/// Turns normals that the deepest contact cannot have to the nearest that it can. The mesh is body `side` (0 or 1) of
/// the manifolds, and the voxels are at `pose` in its frame.
pub fn correct<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    (voxels, pose): (&Voxels, &Pose),
    prediction: Real,
) {
    let within = ON_FACE * voxels.voxel_size().min_element();
    let ground = 1 - side;
    for m in manifolds.iter_mut().filter(|m| !m.points.is_empty()) {
        let part = mesh.primitive([m.subshape1, m.subshape2][side] as usize);
        if part.spheres().iter().all(|s| s.radius > within) {
            continue;
        }
        // No part is turned against its body, so this is the normal in the voxels' frame.
        let to_mesh = [m.local_n1, m.local_n2][ground];
        let gaps = m.points.iter().map(|point| point.dist).enumerate();
        let Some((deepest, _)) = gaps.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        let faces = faces(voxels, places(m, deepest)[ground], within);
        let Some(normal) = nearest(&faces, to_mesh).filter(|n| n.dot(to_mesh) <= POSSIBLE) else {
            continue;
        };
        let in_mesh = pose.rotation * normal;
        for i in 0..m.points.len() {
            let places = places(m, i);
            m.points[i].dist = (places[side] - pose * places[ground]).dot(in_mesh);
        }
        m.points.retain(|point| point.dist < prediction);
        [m.local_n1, m.local_n2] = match side {
            0 => [-in_mesh, normal],
            _ => [normal, -in_mesh],
        };
    }
}

/// Axis and side of each face of the surface that a point is on.
fn faces(voxels: &Voxels, at: Vector, within: Real) -> Vec<(usize, Real)> {
    let half = 0.5 * voxels.voxel_size();
    let around = Aabb::from_half_extents(at, Vector::splat(within));
    let mut found = Vec::new();
    for voxel in voxels.voxels_intersecting_local_aabb(&around) {
        for (axis, sign) in free_faces(voxel.state) {
            let off = (at - voxel.center)[axis] * sign - half[axis];
            if off.abs() <= within && !found.contains(&(axis, sign)) {
                found.push((axis, sign));
            }
        }
    }
    found
}

/// The normal between those of faces that is nearest to `normal`; `None` where that points away from all of them.
fn nearest(faces: &[(usize, Real)], normal: Vector) -> Option<Vector> {
    let mut sum = Vector::ZERO;
    for &(axis, sign) in faces {
        sum[axis] += sign * (normal[axis] * sign).max(0.0);
    }
    if let [(axis, sign)] = *faces
        && normal[axis] * sign > BACKFACE_COSINE
    {
        sum = Vector::ZERO;
        sum[axis] = sign;
    }
    (sum.length_squared() > 0.0).then(|| sum.normalize())
}
