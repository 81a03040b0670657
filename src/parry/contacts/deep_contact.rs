//! The contact of a medial mesh that overlaps a solid: the shortest way out of the convex part that it is deepest in.
//!
//! Nearest spheres tell how far two bodies are apart, and how deep they are in each other as long as no sphere's centre
//! is in the other body. Deeper, the way out of one sphere need not be that of the primitive: a slab across a cylinder
//! is out sooner along the cylinder's radius than along the slab. So the depth of two convex parts is what
//! it is for parry's compounds: the shortest translation that separates them, found by parry's EPA algorithm on their
//! support maps; that of two bodies is the depth of the two parts that are deepest in each other.
//!
//! A translation along any direction that separates two parts bounds their depth from above. Ways out that are found
//! bound those of the other parts, so that few are looked at.

use super::scaled_contact;
use crate::math::{Pose, Real, Vector};
use crate::medial::convex_pieces::ConvexPiece;
use crate::medial::{MedialMesh, MedialSphere};
use crate::pair::{SpherePair, Support};
use crate::parry::partners::compound_children::children_in;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::shape::{Shape, SupportMap, TypedShape};

/// Difference of two depths that parry's algorithm may make: in units of the depth, and of the sizes in play (about
/// eight ulps of `f32`).
const SAME_DEPTH: [Real; 2] = [1.0e-3, 1.0e-6];

/// A convex part of one of the bodies.
struct PlacedPart<'a> {
    map: Map<'a>,
    /// Radius by which its support map is grown, a length.
    border: Real,
    /// Poses in the frame of its body, and of the mesh.
    poses: [Pose; 2],
    subshape: u32,
    /// Boxes around it in its own frame, and in that of the mesh.
    own_bounds: Aabb,
    bounds: Aabb,
}

enum Map<'a> {
    Spheres(Support),
    Shape(&'a dyn SupportMap),
}

impl<'a> PlacedPart<'a> {
    fn new(map: Map<'a>, border: Real, poses: [Pose; 2], subshape: u32) -> Self {
        let mut part = Self {
            map,
            border,
            poses,
            subshape,
            own_bounds: Aabb::new_invalid(),
            bounds: Aabb::new_invalid(),
        };
        part.own_bounds = part.bounds_at(&Pose::IDENTITY);
        part.bounds = part.bounds_at(&poses[1]);
        part
    }

    fn map(&self) -> &dyn SupportMap {
        match &self.map {
            Map::Spheres(support) => support,
            Map::Shape(map) => *map,
        }
    }

    /// How far it reaches along a unit direction of the mesh's frame, a length.
    fn reach(&self, n: Vector) -> Real {
        self.reach_at(&self.poses[1], n)
    }

    fn reach_at(&self, pose: &Pose, n: Vector) -> Real {
        n.dot(self.map().support_point(pose, n)) + self.border
    }

    fn bounds_at(&self, pose: &Pose) -> Aabb {
        let most = Vector::AXES.map(|n| self.reach_at(pose, n));
        let least = Vector::AXES.map(|n| -self.reach_at(pose, -n));
        Aabb::new(least.into(), most.into())
    }

    /// The part of spheres, in the frame of their body, which is at `pose` in that of the mesh.
    fn of_spheres(spheres: &[MedialSphere], pose: &Pose, subshape: u32) -> Self {
        let border = spheres.iter().map(|s| s.radius).fold(Real::MAX, Real::min);
        let core = spheres.iter().map(|s| (s.center, s.radius - border));
        let map = Map::Spheres(Support(core.collect()));
        Self::new(map, border, [Pose::IDENTITY, *pose], subshape)
    }
}

/// Parts of a mesh at `pose` that may meet a box: its convex pieces and lone primitives.
fn parts_of_mesh<'a>(mesh: &MedialMesh, pose: &Pose, region: &Aabb) -> Vec<PlacedPart<'a>> {
    let pieces = mesh.convex_pieces();
    let own_region = region.transform_by(&pose.inverse());
    let is_near = |k: &u32| mesh.primitive(*k as usize).aabb().intersects(&own_region);
    let is_lone = |primitive: &u32| pieces.node_of(*primitive).is_none();
    let lone = (0..mesh.primitive_count() as u32)
        .filter(is_lone)
        .filter(is_near);
    let lone = lone.map(|k| PlacedPart::of_spheres(mesh.primitive(k as usize).spheres(), pose, k));
    let of_piece =
        |piece: &ConvexPiece| PlacedPart::of_spheres(&piece.spheres, pose, piece.primitive);
    let all = pieces.iter().map(of_piece).chain(lone);
    all.filter(|part| part.bounds.intersects(region)).collect()
}

/// Convex parts of any shape at `pose` that may meet a box. Meshes of triangles, height fields, voxels and half-spaces
/// have none.
fn parts_of<'a>(shape: &'a dyn Shape, pose: &Pose, region: &Aabb) -> Vec<PlacedPart<'a>> {
    if let Some(mesh) = shape.as_shape::<MedialMesh>() {
        return parts_of_mesh(mesh, pose, region);
    }
    let solid = |child: &'a dyn Shape, own: Pose, subshape| {
        let map = Map::Shape(child.as_support_map()?);
        Some(PlacedPart::new(map, 0.0, [own, *pose * own], subshape))
    };
    match shape.as_typed_shape() {
        TypedShape::Compound(compound) => {
            let own_region = region.transform_by(&pose.inverse());
            let children = children_in(compound, &own_region);
            let child = |k: u32| {
                let (own, child) = &compound.shapes()[k as usize];
                solid(&**child, *own, k)
            };
            children.into_iter().filter_map(child).collect()
        }
        _ => solid(shape, Pose::IDENTITY, 0).into_iter().collect(),
    }
}

/// Whether nearest spheres tell the depth of all pairs of parts of the two bodies.
fn is_told_by_spheres(mesh: &MedialMesh, other: &dyn Shape) -> bool {
    let of_other = match other.as_typed_shape() {
        TypedShape::Ball(_)
        | TypedShape::Capsule(_)
        | TypedShape::Segment(_)
        | TypedShape::Triangle(_)
        | TypedShape::RoundTriangle(_) => true,
        _ => other
            .as_shape::<MedialMesh>()
            .is_some_and(|other| other.convex_pieces().is_empty()),
    };
    of_other && mesh.convex_pieces().is_empty()
}

/// Whether a subshape of a body has a support map, so that it is a convex part.
fn is_convex(shape: &dyn Shape, subshape: u32) -> bool {
    match shape.as_typed_shape() {
        TypedShape::Compound(compound) => {
            let child = compound.shapes().get(subshape as usize);
            child.is_some_and(|(_, child)| child.as_support_map().is_some())
        }
        _ => true,
    }
}

/// The contact of a mesh and another shape at `pos12` in its frame, of which the nearest spheres are known.
pub fn shortest_way_out(
    mesh: &MedialMesh,
    other: &dyn Shape,
    pos12: &Pose,
    nearest: SpherePair,
) -> SpherePair {
    if nearest.distance >= 0.0 || is_told_by_spheres(mesh, other) {
        return nearest;
    }
    let others = parts_of(other, pos12, &mesh.aabb());
    let region = others.iter().map(|part| part.bounds);
    let Some(region) = region.reduce(|a, b| a.merged(&b)) else {
        return nearest;
    };
    let parts = [parts_of_mesh(mesh, &Pose::IDENTITY, &region), others];
    let Some((pair, way)) = deepest_parts(&parts) else {
        return nearest;
    };
    let depth = -way.distance;
    let of_nearest = separation(&parts, pair, nearest.normal);
    let size = region.half_extents().max_element() + region.center().abs().max_element();
    let slack = SAME_DEPTH[0] * depth + SAME_DEPTH[1] * size;
    let is_told = of_nearest <= depth + slack && (of_nearest + nearest.distance).abs() <= slack;
    let is_of_another = !is_convex(other, nearest.primitives[1]) && nearest.distance < way.distance;
    if is_told || is_of_another {
        nearest
    } else {
        way
    }
}

/// How far the second of two parts has to move along a unit direction to be out of the first, a length.
fn separation(parts: &[Vec<PlacedPart>; 2], [i, j]: [usize; 2], n: Vector) -> Real {
    parts[0][i].reach(n) + parts[1][j].reach(-n)
}

/// The two parts that are deepest in each other, and their contact.
fn deepest_parts(parts: &[Vec<PlacedPart>; 2]) -> Option<([usize; 2], SpherePair)> {
    let mut most = Vec::new();
    for (i, a) in parts[0].iter().enumerate() {
        for (j, b) in parts[1].iter().enumerate() {
            let (a, b) = (&a.bounds, &b.bounds);
            let bound = (a.maxs - b.mins).min(b.maxs - a.mins).min_element();
            if bound >= 0.0 {
                most.push(([i, j], bound));
            }
        }
    }
    let mut best: Option<([usize; 2], SpherePair)> = None;
    loop {
        let deepest = best.as_ref().map_or(0.0, |(_, way)| -way.distance);
        most.retain(|(_, bound)| *bound > deepest);
        let next = (0..most.len()).max_by(|a, b| most[*a].1.total_cmp(&most[*b].1));
        let Some(next) = next else {
            return best;
        };
        let ([i, j], _) = most.swap_remove(next);
        let Some(way) = way_out(&parts[0][i], &parts[1][j]) else {
            continue;
        };
        let reaches = [0, 1].map(|side| {
            let n = [way.normal, -way.normal][side];
            let reaches = parts[side].iter().map(|part| part.reach(n));
            reaches.collect::<Vec<_>>()
        });
        for ([i, j], bound) in &mut most {
            *bound = bound.min(reaches[0][*i] + reaches[1][*j]);
        }
        if -way.distance > deepest {
            best = Some(([i, j], way));
        }
    }
}

/// The contact of two parts that overlap. Its depth is what separates them along its normal.
fn way_out(a: &PlacedPart, b: &PlacedPart) -> Option<SpherePair> {
    let borders = a.border + b.border;
    let pose = a.poses[1].inv_mul(&b.poses[1]);
    let found = scaled_contact::contact(
        &pose,
        [a.map(), b.map()],
        [&a.own_bounds, &b.own_bounds],
        borders,
    )?;
    let normal = a.poses[1].rotation * found.normal1;
    let depth = a.reach(normal) + b.reach(-normal);
    let points = [
        found.point1 + found.normal1 * a.border,
        found.point2 + found.normal2 * (depth + found.dist - a.border),
    ];
    Some(SpherePair {
        primitives: [a.subshape, b.subshape],
        feature: 0,
        distance: -depth,
        normal,
        points: [a.poses[0] * points[0], b.poses[0] * points[1]],
    })
}
