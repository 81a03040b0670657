//! Tips of convex pieces that end within another piece: the walls of a ring of sixteen sides reach into each other with
//! edges of 22.5°. Taken alone such a tip is a sheet, which passes through things at any speed. But what passes through
//! it passes through the other piece, too: there the mesh is as thick as that one.

use super::simplex::{Simplex, primitive_of};
use super::sphere::MedialSphere;
use crate::math::Real;
use parry3d::bounding_volume::{Aabb, BoundingVolume};

/// How far a primitive may stick out of what hides it, in units of its largest radius: rounding of the pieces' corners.
const STICKS_OUT: Real = 1.0e-2;

/// Least thickness of what hides a primitive, in units of the primitive's largest radius: a tip hides no other tip.
const AS_THICK: Real = 0.5;

/// Raises the thickness of primitives that taper to their largest radius, as of blunt tips, where they lie within
/// another of the connected `groups`, all of which are convex.
pub(super) fn raise(
    thicknesses: &mut [Real],
    spheres: &[MedialSphere],
    primitives: &[Simplex],
    groups: &[Vec<u32>],
) {
    let primitive = |p: u32| primitive_of(spheres, &primitives[p as usize]);
    let bounds = groups.iter().map(|group| {
        let boxes = group.iter().map(|p| primitive(*p).aabb());
        boxes.fold(Aabb::new_invalid(), |all, one| all.merged(&one))
    });
    let bounds: Vec<Aabb> = bounds.collect();
    let alone = thicknesses.to_vec();
    for (own, group) in groups.iter().enumerate() {
        for &p in group {
            let tip = primitive(p);
            let radii = tip.spheres().iter().map(|s| s.radius);
            let most = radii.fold(0.0, Real::max);
            if alone[p as usize] >= most {
                continue;
            }
            let slack = STICKS_OUT * most;
            let holds = |q: u32, s: &MedialSphere| {
                let depth = -primitive(q).signed_distance(s.center).distance;
                alone[q as usize] >= AS_THICK * most && depth >= s.radius - slack
            };
            let is_within = |(other, group): (usize, &Vec<u32>)| {
                let near = bounds[other].loosened(slack);
                other != own
                    && tip.spheres().iter().all(|s| {
                        near.contains_local_point(s.center) && group.iter().any(|q| holds(*q, s))
                    })
            };
            if groups.iter().enumerate().any(is_within) {
                thicknesses[p as usize] = most;
            }
        }
    }
}
