//! Normals of contacts of a mesh with a convex shape along which the two are not as far apart as the contact says. Where
//! sharp edges just touch a face, the direction that parry's iterative algorithms find is noise: a slab that stands on a
//! table has normals to its sides, and trips over them.
//!
//! The gap of two convex bodies is their largest gap along any direction, so a normal is right if the gap along it is that of
//! the contact. Where it is not, but that along the normal of a flat face of either body is, it is turned to that.

use super::contact_reduction::places;
use super::ghost_contacts::{BEHIND, part_number, part_of};
use super::shape_faces::for_each_flat_face;
use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialSphere};
use parry3d::bounding_volume::Aabb;
use parry3d::query::ContactManifold;
use parry3d::shape::{Shape, TypedShape};

/// How much smaller the gap along a face's normal may be than that of the contact where that along the contact's own is
/// smaller still, in units of the prediction distance.
const ROOM: Real = 0.02;

/// Turns wrong normals to those of faces. The mesh is body `side` (0 or 1) of the manifolds; `other` is the other shape, and
/// where it is in the mesh's frame.
pub fn correct<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    (other, pose): (&dyn Shape, &Pose),
    prediction: Real,
) {
    let ids = |m: &ContactManifold<M, C>| {
        let [own, others] = [[m.subshape1, m.subshape2], [m.subshape2, m.subshape1]][side];
        (own, others, [part_number(mesh, own), others])
    };
    let gap =
        |m: &ContactManifold<M, C>| m.points.iter().map(|p| p.dist).fold(Real::MAX, Real::min);
    let behind = BEHIND * mesh.aabb().extents().max_element();
    // The least gap of each two parts, which may have several contacts.
    let mut gaps: Option<FastMap<[u32; 2], Real>> = None;
    for k in 0..manifolds.len() {
        if manifolds[k].points.is_empty() {
            continue;
        }
        let m = &manifolds[k];
        let (own, others, parts) = ids(m);
        let Some((part, placed)) = convex_part((other, pose), others) else {
            continue;
        };
        let Some(solid) = part.as_support_map() else {
            continue;
        };
        let primitives = part_of(mesh, own);
        let along = |n: Vector| {
            let nearest = solid.support_point(&placed, -n);
            n.dot(nearest) - height(primitives.spheres(), n)
        };
        let told = along([m.local_n1, m.local_n2][side]);
        if told >= gap(m) - behind {
            continue;
        }
        let gaps = gaps.get_or_insert_with(|| {
            let mut gaps = FastMap::default();
            for m in manifolds.iter() {
                let least = gaps.entry(ids(m).2).or_insert(Real::MAX);
                *least = least.min(gap(m));
            }
            gaps
        });
        let least = gaps.get(&parts).map_or(Real::MAX, |least| least - behind);
        if told >= least {
            continue;
        }
        // A body that lies aslant on the end of a table is lower beside it.
        let room = ROOM * prediction;
        let least = if told < least - room {
            least - room
        } else {
            least
        };
        let mut best = (least, None);
        let mut see = |n: Vector| {
            let gap = along(n);
            if gap >= best.0 {
                best = (gap, Some(n));
            }
        };
        primitives.normals().for_each(&mut see);
        flat_normals(part, &placed, |n| see(-n));
        let Some(normal) = best.1 else { continue };
        let m = &mut manifolds[k];
        for i in 0..m.points.len() {
            let at = places(m, i);
            m.points[i].dist = (pose * at[1 - side] - at[side]).dot(normal);
        }
        m.points.retain(|point| point.dist < prediction);
        let from_other = placed.rotation.inverse() * -normal;
        [m.local_n1, m.local_n2] = match side {
            0 => [normal, from_other],
            _ => [from_other, normal],
        };
    }
}

/// The convex part of a shape that a subshape of a manifold is, and where it is in the mesh's frame.
pub fn convex_part<'a>(
    (other, pose): (&'a dyn Shape, &Pose),
    part: u32,
) -> Option<(&'a dyn Shape, Pose)> {
    match other.as_typed_shape() {
        TypedShape::Compound(compound) => {
            let (own, shape) = compound.shapes().get(part as usize)?;
            Some((&**shape, *pose * *own))
        }
        _ => Some((other, *pose)),
    }
}

/// How far spheres reach along a unit direction, a length.
fn height(spheres: &[MedialSphere], n: Vector) -> Real {
    let heights = spheres.iter().map(|s| n.dot(s.center) + s.radius);
    heights.fold(Real::MIN, Real::max)
}

/// Calls `see` on the outward unit normals of a convex shape's flat faces.
fn flat_normals(shape: &dyn Shape, pose: &Pose, mut see: impl FnMut(Vector)) {
    if let TypedShape::Cylinder(_) = shape.as_typed_shape() {
        let axis = pose.rotation * Vector::Y;
        [axis, -axis].into_iter().for_each(see);
        return;
    }
    let everywhere = Aabb::new(Vector::splat(Real::MIN), Vector::splat(Real::MAX));
    for_each_flat_face(shape, pose, &everywhere, &mut |face| {
        let [a, b, c] = [0, 1, 2].map(|k| face.corners[k]);
        if let Some(n) = (b - a).cross(c - a).try_normalize() {
            see(n);
        }
    });
}
