//! Normals of contacts of a mesh with a convex shape along which the two are not as far apart as the contact says.
//! Where sharp edges just touch a face, the direction that parry's iterative algorithms find is noise: a slab that
//! stands on a table has normals to its sides, and trips over them.
//!
//! The gap of two convex bodies is their largest gap along any direction, so a normal is right if the gap along it is
//! that of the contact. Where it is not, but that along the normal of a flat face of either body nearly is
//! ([`GAP_TOLERANCE`]), it is turned to that. The points turn along: what rolls touches the face below its axis, and
//! not ahead of it, where it comes down.

use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::contacts::convex_parts::{ConvexPart, child_of, part_number, slack};
use crate::parry::contacts::manifold_points::places;
use crate::parry::partners::shape_faces::flat_sides;
use parry3d::query::ContactManifold;
use parry3d::shape::{Shape, TypedShape};

/// Tolerance, in units of the prediction distance: a contact's normal is turned to a face's if the gap along that falls
/// short of the contact's gap by no more than this, while the gap along its own normal falls short by more. At 0 bodies
/// that lie aslant over the end of a table stumble there.
const GAP_TOLERANCE: Real = 0.02;

/// Turns wrong normals to those of faces. The mesh is body `side` (0 or 1) of the manifolds; `other` is the other
/// shape, and where it is in the mesh's frame.
pub fn correct<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    (other, pose): (&dyn Shape, &Pose),
    prediction: Real,
) {
    let ids =
        |m: &ContactManifold<M, C>| [[m.subshape1, m.subshape2], [m.subshape2, m.subshape1]][side];
    let parts = |m: &ContactManifold<M, C>| {
        let [own, others] = ids(m);
        [part_number(mesh, own), others]
    };
    let gap =
        |m: &ContactManifold<M, C>| m.points.iter().map(|p| p.dist).fold(Real::MAX, Real::min);
    let slack = slack(mesh, pose);
    // The least gap of each two parts, which may have several contacts.
    let mut gaps: Option<FastMap<[u32; 2], Real>> = None;
    for k in 0..manifolds.len() {
        let m = &manifolds[k];
        let [own, others] = ids(m);
        let Some((child, placed)) = child_of((other, pose), others) else {
            continue;
        };
        let two = (ConvexPart::of(mesh, own), (child, &placed));
        let Some(told) = gap_along(&two, [m.local_n1, m.local_n2][side]) else {
            continue;
        };
        if m.points.is_empty() || told >= gap(m) - slack {
            continue;
        }
        let gaps = gaps.get_or_insert_with(|| {
            let mut gaps = FastMap::default();
            for m in manifolds.iter() {
                let least = gaps.entry(parts(m)).or_insert(Real::MAX);
                *least = least.min(gap(m));
            }
            gaps
        });
        let least = gaps.get(&parts(m)).copied().unwrap_or(Real::MAX) - slack;
        if told >= least {
            continue;
        }
        let room = GAP_TOLERANCE * prediction;
        let room = if told < least - room { room } else { 0.0 };
        let Some((normal, is_of_mesh)) = flat_normal(&two, least - room) else {
            continue;
        };
        let m = &mut manifolds[k];
        let turned = [m.local_n1, m.local_n2][side] - normal;
        let primitive = mesh.primitive(own as usize);
        let radii = primitive.spheres().iter().map(|s| s.radius);
        let of_own = turned * -radii.fold(Real::MAX, Real::min);
        let of_other = turned * border(child);
        for i in 0..m.points.len() {
            let at = places(m, i);
            let others = pose * at[1 - side] + of_other;
            let point = &mut m.points[i];
            let mut to_own = of_own;
            point.dist = (others - at[side] - of_own).dot(normal);
            if is_of_mesh {
                point.dist = others.dot(normal) - two.0.reach(normal);
                to_own = others - normal * point.dist - at[side];
            }
            let to_other = placed.rotation.inverse() * of_other;
            let [to_first, to_second] = [[to_own, to_other], [to_other, to_own]][side];
            point.local_p1 += to_first;
            point.local_p2 += to_second;
        }
        m.points.retain(|point| point.dist < prediction);
        let from_other = placed.rotation.inverse() * -normal;
        [m.local_n1, m.local_n2] = match side {
            0 => [normal, from_other],
            _ => [from_other, normal],
        };
    }
}

/// The radius that a convex shape's core is grown by, a length.
fn border(shape: &dyn Shape) -> Real {
    match shape.as_typed_shape() {
        TypedShape::Ball(ball) => ball.radius,
        _ => shape.as_polygonal_feature_map().map_or(0.0, |map| map.1),
    }
}

/// A part of the mesh, and a convex shape at a pose in the mesh's frame.
type Two<'a> = (ConvexPart<'a>, (&'a dyn Shape, &'a Pose));

/// Gap of two shapes along a unit direction out of the mesh, negative where they overlap along it. `None` for a shape
/// without a support map.
fn gap_along((part, (shape, pose)): &Two, n: Vector) -> Option<Real> {
    let nearest = shape.as_support_map()?.support_point(pose, -n);
    Some(n.dot(nearest) - part.reach(n))
}

/// The normal with the largest gap among those of the flat faces of both shapes, if that gap is `least` or more, and
/// whether it is that of a face of the mesh.
fn flat_normal(two: &Two, least: Real) -> Option<(Vector, bool)> {
    let (part, (shape, pose)) = two;
    let of_shape = flat_sides(*shape).into_iter();
    let of_shape = of_shape.map(|(n, _)| (pose.rotation * -n, false));
    let all = part.flat_normals().map(|n| (n, true)).chain(of_shape);
    let gaps = all.filter_map(|(n, own)| Some((gap_along(two, n)?, (n, own))));
    let (gap, found) = gaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (gap >= least).then_some(found)
}
