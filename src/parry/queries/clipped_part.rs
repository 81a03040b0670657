//! The part of a primitive on one side of a plane, or of several. Over a primitive the centre and the radius of its
//! spheres are linear, so a height above a plane is too, and the part is a convex polygon of spheres.

use crate::math::clipping::part_below;
use crate::math::lane::Vec3;
use crate::math::{Pose, Real};
use crate::medial::{MedialMesh, MedialSphere};
use parry3d::bounding_volume::Aabb;

/// The part of a polygon of spheres where a linear function of them is at most 0.
pub fn spheres_below(
    polygon: &[MedialSphere],
    height: impl Fn(&MedialSphere) -> f64,
) -> Vec<MedialSphere> {
    part_below(polygon, height, |_, a, b, share| {
        let share = share as Real;
        let radius = a.radius + (b.radius - a.radius) * share;
        MedialSphere::new(a.center.lerp(b.center, share), radius)
    })
}

/// Spheres, in the mesh's frame, whose convex hulls hold all of the mesh that is in a box. `pose` is that of the mesh
/// in the box's frame.
pub fn within(mesh: &MedialMesh, pose: &Pose, aabb: &Aabb) -> Vec<MedialSphere> {
    let around = aabb.transform_by(&pose.inverse());
    let near = mesh.bvh().intersect_aabb(&around);
    let within = |primitive: u32| {
        let mut part = mesh.primitive(primitive as usize).spheres().to_vec();
        for axis in 0..3 {
            let [low, high] = [aabb.mins[axis], aabb.maxs[axis]];
            let place = |s: &MedialSphere| (pose * s.center)[axis];
            part = spheres_below(&part, |s| f64::from(place(s) - s.radius - high));
            part = spheres_below(&part, |s| f64::from(low - place(s) - s.radius));
        }
        part
    };
    near.flat_map(within).collect()
}

/// Whether a convex polygon and a face, seen along `n`, are on different sides of a line along one of the polygon's
/// edges. `corners` are those of the face.
pub fn is_beside(polygon: &[Vec3<f64>], corners: &[Vec3<f64>], n: Vec3<f64>) -> bool {
    let range = |places: &[Vec3<f64>], axis: Vec3<f64>| {
        let along = places.iter().map(|p| axis.dot(*p));
        along.fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(x), b.max(x)])
    };
    let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let mut axes = ends.map(|(p, q)| n.cross(*q - *p));
    axes.any(|axis| {
        let [a, b] = range(polygon, axis);
        let [c, d] = range(corners, axis);
        b < c || d < a
    })
}
