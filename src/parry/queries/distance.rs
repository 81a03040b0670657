//! Distance of a medial mesh to one of parry's shapes at fixed poses, and the contact that attains it.
//!
//! The other shape is its surface as swept spheres ([`super::swept_sphere_parts`]), so the closed forms for two medial
//! meshes serve here too. Cylinders and cones have closed forms of their own
//! ([`crate::parry::partners::axisymmetric`]). A centre inside a closed body counts as deep as its shortest way out is
//! long ([`crate::parry::partners::inside`]).
//!
//! parry's own answers come from its iterative GJK algorithm: they are off by up to 1e-3 of the distance at times, are
//! missing for height fields and voxels, and are in the wrong frame for contacts of compounds with half-spaces.

use super::swept_sphere_parts::{self, SweptParts, Unsweepable};
use crate::math::lane::Vec3;
use crate::math::least_first::least_first;
use crate::math::sphere::Ball;
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::tree::NodeKind;
use crate::medial::{MedialMesh, MedialSphere};
use crate::pair::distance::{Wanted, near_spheres};
use crate::pair::first_contact::Counts;
use crate::pair::{PrimitiveTree, SpherePair};
use crate::parry::partners::axisymmetric::{AxisFrame, Axisymmetric, NearBall, unit};
use crate::parry::partners::inside;
use parry3d::bounding_volume::BoundingVolume;
use parry3d::shape::Shape;
use std::collections::BinaryHeap;

/// The nearest pair of spheres of `mesh` and `other`, if they are within `max_distance` (a length) of each other.
/// `pos12` is the pose of `other` in the frame of the mesh; the second primitive index is the subshape of `other`.
/// If a centre of the mesh is inside `other`, the distance is minus the length of the shortest way out.
///
/// # Errors
/// For a shape that is neither medial nor one of parry's own, and a compound that has such a child in reach.
pub fn nearest(
    mesh: &MedialMesh,
    other: &dyn Shape,
    pos12: &Pose,
    max_distance: Real,
) -> Result<(Option<SpherePair>, Counts), Unsweepable> {
    near(mesh, other, pos12, max_distance, Wanted::Nearest)
}

/// Whether the distance of `mesh` and `other` at relative pose `pos12` is at most `max_distance`, and the work it took
/// to know. Fails as [`nearest`].
pub fn is_within(
    mesh: &MedialMesh,
    other: &dyn Shape,
    pos12: &Pose,
    max_distance: Real,
) -> Result<(bool, Counts), Unsweepable> {
    let (found, counts) = near(mesh, other, pos12, max_distance, Wanted::Any)?;
    Ok((found.is_some(), counts))
}

fn near(
    mesh: &MedialMesh,
    other: &dyn Shape,
    pos12: &Pose,
    max_distance: Real,
    wanted: Wanted,
) -> Result<(Option<SpherePair>, Counts), Unsweepable> {
    if let Some(second) = other.as_shape::<MedialMesh>() {
        return Ok(near_spheres(mesh, second, pos12, max_distance, wanted));
    }
    // The inverse of a pose at the end of the numbers is not finite.
    let pos21 = pos12.inverse();
    if !pos12.is_finite() || !pos21.is_finite() || max_distance.is_nan() {
        return Ok((None, Counts::default()));
    }
    let region =
        mesh.aabb()
            .transform_by(&pos21)
            .loosened(reach(mesh, other, &pos21, max_distance));
    let mut parts = SweptParts::default();
    if !swept_sphere_parts::add_shape(&mut parts, other, &region) {
        return Err(Unsweepable);
    }
    let (mut best, mut counts) = near_spheres(mesh, &parts.primitives, pos12, max_distance, wanted);
    if best.is_some() && wanted == Wanted::Any {
        return Ok((best, counts));
    }
    for pair in best.iter_mut() {
        pair.primitives[1] = parts.primitive_subshape(pair.primitives[1]);
    }
    for (index, body) in parts.axisymmetric.iter().enumerate() {
        let limit = best.map_or(max_distance, |b| b.distance);
        let found = nearest_axisymmetric(mesh, body, pos12, limit, &mut counts);
        if let Some(mut found) = found {
            found.primitives[1] = parts.axisymmetric_subshape(index as u32);
            best = Some(found);
        }
    }
    if let Some(inside) = overlap_with_center_inside(mesh, other, pos12)
        && best.is_none_or(|b| inside.distance < b.distance)
    {
        best = Some(inside);
    }
    Ok((best, counts))
}

/// Distance from the mesh within which the other shape's surface matters, a length at most `max_distance`: the distance
/// of any one sphere bounds that of the mesh.
fn reach(mesh: &MedialMesh, other: &dyn Shape, pos21: &Pose, max_distance: Real) -> Real {
    let bounds = mesh.spheres().first().map(|s| {
        let center = pos21 * s.center;
        let distance = inside::most_distance(other, center) - s.radius;
        let sizes = [center, pos21.translation, s.center].map(|p| p.abs().max_element());
        let size = sizes.into_iter().fold(s.radius, |sum, size| sum + size);
        inside::PROJECTION_SLACK * distance.max(0.0) + REAL_ROUNDING * size
    });
    let bound = bounds.filter(|b| b.is_finite()).unwrap_or(Real::MAX);
    // Infinite boxes do not survive transformations.
    bound.min(max_distance).clamp(0.0, 1.0e18)
}

/// The overlap with a closed shape that holds a centre.
fn overlap_with_center_inside(
    mesh: &MedialMesh,
    other: &dyn Shape,
    pos12: &Pose,
) -> Option<SpherePair> {
    let pos21 = pos12.inverse();
    let placed = |s: &MedialSphere| MedialSphere::new(pos21 * s.center, s.radius);
    let placed: Vec<_> = mesh.spheres().iter().map(placed).collect();
    let way = inside::min_translation(other, &placed)?;
    let of_sphere = |p: &crate::medial::simplex::Simplex| p.vertices.contains(&(way.sphere as u32));
    let primitive = mesh.simplices().iter().position(of_sphere).unwrap_or(0);
    let MedialSphere { center, radius } = placed[way.sphere];
    Some(SpherePair {
        primitives: [primitive as u32, way.child],
        feature: 0,
        distance: -way.depth,
        normal: pos12.rotation * -way.direction,
        points: [
            pos12 * (center - way.direction * radius),
            center + way.direction * way.to_surface,
        ],
    })
}

/// The nearest sphere to a cylinder or cone, if it is nearer than `limit`: best-first over the mesh's tree.
fn nearest_axisymmetric(
    mesh: &MedialMesh,
    body: &Axisymmetric,
    pos12: &Pose,
    limit: Real,
    counts: &mut Counts,
) -> Option<SpherePair> {
    let pos21 = pos12.inverse();
    let place = AxisFrame {
        origin: Vec3::from_vector(body.center),
        axis: unit(Vec3::from_vector(body.axis)),
    };
    let border = f64::from(body.border);
    let ball = |(center, radius): (Vector, Real)| {
        let center = Vec3::from_vector(pos21 * center) - place.origin;
        Ball::new(center, f64::from(radius) + border)
    };
    let mut best: Option<(NearBall, u32)> = None;
    let mut limit = f64::from(limit);
    let mut heap = BinaryHeap::new();
    for root in 0..mesh.roots() {
        let bound = f64::NEG_INFINITY;
        heap.push(Entry { bound, node: root });
    }
    while let Some(Entry { bound, node }) = heap.pop() {
        if bound > limit {
            break;
        }
        counts.nodes += 1;
        match mesh.kind(node) {
            NodeKind::Nodes(i, j) => heap.extend([i, j].map(|node| {
                let (center, radius) = mesh.bound(node);
                let near = body.nearest(&place, &[ball((center, radius))]);
                let rounding = 8.0 * f64::from(Real::EPSILON) * f64::from(center.length() + radius);
                let bound = out_of(body, &place, &near).1 - rounding;
                Entry { bound, node }
            })),
            NodeKind::Primitive(i) => {
                counts.tests += 1;
                let (spheres, share) = PrimitiveTree::primitive(mesh, i);
                let balls = spheres.map(|s| ball((s.center, s.radius)));
                let near = body.nearest(&place, &balls[..share.spheres.clamp(1, 3)]);
                let (_, distance) = out_of(body, &place, &near);
                if distance <= limit {
                    limit = distance;
                    best = Some((near, i));
                }
            }
        }
    }
    let (near, primitive) = best?;
    let (out, distance) = out_of(body, &place, &near);
    let Ball { center, radius } = near.ball;
    let shared = |p: Vec3<f64>| (p + place.origin).to_vector();
    let first = shared(center - out * (radius - border));
    let second = shared(center - out * (radius + distance - border));
    Some(SpherePair {
        primitives: [primitive, 0],
        feature: 0,
        distance: distance as Real,
        normal: pos12.rotation * -out.to_vector(),
        points: [pos12 * first, second],
    })
}

/// Unit direction from the body to a sphere, and the signed distance; of a centre inside, the way out.
fn out_of(body: &Axisymmetric, place: &AxisFrame, near: &NearBall) -> (Vec3<f64>, f64) {
    if near.apart <= 0.0 {
        let (out, way) = body.min_translation(place, near.ball.center);
        return (out, -way - near.ball.radius);
    }
    (unit(near.direction), near.distance())
}

/// An entry of the queue: a node of the mesh with a lower bound of its distance, the nearest first.
struct Entry {
    bound: f64,
    node: u32,
}
least_first!(Entry, bound, node);
