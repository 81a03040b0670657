//! Turns parry's other shapes into swept spheres, so that one certified query serves all of them: a ball is a sphere,
//! a capsule a cone, a flat face a slab of radius 0, a rounded face a slab of its border radius. A new shape of
//! rapier is added here ([`add_surface`]), and in [`crate::parry::partners::inside`] if it is closed.
//!
//! A closed body is represented by its surface only, so [`crate::parry::partners::inside`] has to find out whether the
//! other body starts inside it. Cylinders and cones have no flat faces; they are collected separately, for
//! [`super::axisymmetric_toi`].

use super::sliding::{Lying, Sliding};
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialSphere;
use crate::pair::PrimitiveList;
use crate::parry::partners::axisymmetric::Axisymmetric;
use crate::parry::partners::compound_children::children_in;
use crate::parry::partners::shape_faces::{
    Face, all_faces, face_corners, for_each_triangle, free_faces, seen_from,
};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::shape::{ConvexPolyhedron, Cuboid, HalfSpace, Shape, TypedShape};

/// Inner radius of a half-space's stand-in, in units of the reach of the motion: a slab of radius 0 in the
/// half-space's plane, larger than anything the body can reach.
const PLANE_REACH: Real = 2.0;

/// Error: the other shape is neither medial nor one of parry's own, so it cannot be swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsweepable;

/// A shape as swept spheres, cylinders and cones, in the shape's frame.
#[derive(Clone, Debug, Default)]
pub struct SweptParts<'a> {
    /// Swept spheres.
    pub primitives: PrimitiveList,
    /// Cylinders and cones.
    pub axisymmetric: Vec<Axisymmetric>,
    /// parry's subshape of each primitive: child, triangle, segment, cell or voxel.
    primitive_subshapes: Vec<u32>,
    axisymmetric_subshapes: Vec<u32>,
    /// The slide of the searched mesh, by which flat faces are left out; `None` if none are.
    pub(super) sliding: Option<Sliding<'a>>,
    /// The faces of surfaces that it left out, as triangles.
    pub(super) left_out: Vec<[Vector; 3]>,
    /// Primitives that the searched mesh can meet along a plane's normal only, and that unit normal, to the side of the
    /// mesh.
    pub(super) normals: Vec<(u32, Vector)>,
}

impl<'a> SweptParts<'a> {
    /// An empty list of parts. Flat faces along which the searched mesh only slides will be left out.
    pub fn under(sliding: Option<Sliding<'a>>) -> Self {
        Self {
            sliding,
            ..Self::default()
        }
    }

    /// parry's subshape of a primitive.
    pub fn primitive_subshape(&self, primitive: u32) -> u32 {
        let of = self.primitive_subshapes.get(primitive as usize);
        of.copied().unwrap_or(0)
    }

    /// parry's subshape of one of the axisymmetric bodies.
    pub fn axisymmetric_subshape(&self, index: u32) -> u32 {
        let of = self.axisymmetric_subshapes.get(index as usize);
        of.copied().unwrap_or(0)
    }

    /// Adds a triangle of a mesh or height field.
    fn add_triangle(&mut self, corners: [Vector; 3], subshape: u32) {
        self.add_unless_slid(Face::of_surface(&corners), |primitives| {
            primitives.push(&corners.map(|p| MedialSphere::new(p, 0.0)));
        });
        self.name(subshape);
    }

    /// Adds what `add` does for a flat face, unless it is no obstacle.
    fn add_unless_slid(&mut self, face: Face, add: impl FnOnce(&mut PrimitiveList)) {
        let lying = self.sliding.as_ref().and_then(|s| s.treats(face));
        if lying.is_some_and(|lying| lying.slides) {
            if !face.is_of_solid {
                let corners = face.corners;
                let others = corners[1..].windows(2);
                self.left_out
                    .extend(others.map(|pair| [corners[0], pair[0], pair[1]]));
            }
            return;
        }
        let first = self.primitives.len() as u32;
        add(&mut self.primitives);
        if let Some(Lying { normal, .. }) = lying {
            let added = first..self.primitives.len() as u32;
            self.normals.extend(added.map(|p| (p, normal.to_vector())));
        }
    }

    /// Names the subshape of what was added since the last call: one convex part.
    fn name(&mut self, subshape: u32) {
        self.primitives.end_part();
        self.primitive_subshapes
            .resize(self.primitives.len(), subshape);
        self.axisymmetric_subshapes
            .resize(self.axisymmetric.len(), subshape);
    }
}

/// Thickness of a shape that is not medial, a length. It is infinite for a surface, which has no inside that could be
/// overlapped.
pub fn thickness(shape: &dyn Shape) -> Real {
    let thickness = shape.ccd_thickness();
    if thickness > 0.0 {
        thickness
    } else {
        Real::INFINITY
    }
}

/// Adds the surface of `shape`, in whose frame the parts are, as far as it meets `region`, and gives the parts a
/// hierarchy. Returns `false` for a shape that has no such surface: a custom one, or a compound with one in the region.
pub fn add_shape(parts: &mut SweptParts, shape: &dyn Shape, region: &Aabb) -> bool {
    let added = add_surface(parts, shape, &Pose::IDENTITY, region);
    parts.primitives.build_tree();
    added
}

/// Adds the surface of `shape`, placed at `pose` in the parts' frame, as [`add_shape`] does.
fn add_surface(parts: &mut SweptParts, shape: &dyn Shape, pose: &Pose, region: &Aabb) -> bool {
    if let Some(body) = Axisymmetric::new(shape, pose) {
        parts.axisymmetric.push(body);
        parts.name(0);
        return true;
    }
    let primitives = &mut parts.primitives;
    let point = |p: Vector| pose * p;
    let ball = |p: Vector, radius: Real| MedialSphere::new(point(p), radius);
    match shape.as_typed_shape() {
        TypedShape::Ball(s) => primitives.push(&[ball(Vector::ZERO, s.radius)]),
        TypedShape::Capsule(s) => {
            primitives.push(&[ball(s.segment.a, s.radius), ball(s.segment.b, s.radius)]);
        }
        TypedShape::Segment(s) => primitives.push(&[ball(s.a, 0.0), ball(s.b, 0.0)]),
        TypedShape::Triangle(t) => primitives.push(&[t.a, t.b, t.c].map(|p| ball(p, 0.0))),
        TypedShape::RoundTriangle(t) => {
            let i = &t.inner_shape;
            primitives.push(&[i.a, i.b, i.c].map(|p| ball(p, t.border_radius)));
        }
        TypedShape::Cuboid(c) => add_cuboid(parts, c, pose, 0.0, region),
        TypedShape::RoundCuboid(c) => {
            add_cuboid(parts, &c.inner_shape, pose, c.border_radius, region);
        }
        TypedShape::ConvexPolyhedron(c) => add_polyhedron(parts, c, pose, 0.0, region),
        TypedShape::RoundConvexPolyhedron(c) => {
            add_polyhedron(parts, &c.inner_shape, pose, c.border_radius, region);
        }
        TypedShape::HalfSpace(plane) => {
            add_plane(primitives, plane, pose, &seen_from(pose, region));
        }
        TypedShape::Compound(c) => {
            for i in children_in(c, &seen_from(pose, region)) {
                let (child, s) = &c.shapes()[i as usize];
                let (primitives, axisymmetric) = (parts.primitives.len(), parts.axisymmetric.len());
                if !add_surface(parts, s.as_ref(), &(pose * child), region) {
                    return false;
                }
                parts.primitive_subshapes.truncate(primitives);
                parts.axisymmetric_subshapes.truncate(axisymmetric);
                parts.name(i);
            }
        }
        _ => return add_elements(parts, shape, pose, region),
    }
    parts.name(0);
    true
}

/// Adds the triangles, segments or voxels of a shape that is made of them, as [`add_surface`] does.
fn add_elements(parts: &mut SweptParts, shape: &dyn Shape, pose: &Pose, region: &Aabb) -> bool {
    let local = seen_from(pose, region);
    let flat = |p: Vector| MedialSphere::new(pose * p, 0.0);
    match shape.as_typed_shape() {
        TypedShape::TriMesh(m) => {
            for i in m.bvh().intersect_aabb(&local) {
                parts.add_triangle(m.triangle(i).vertices().map(|p| pose * p), i);
            }
        }
        TypedShape::Polyline(l) => {
            for i in l.bvh().intersect_aabb(&local) {
                let s = l.segment(i);
                parts.primitives.push(&[s.a, s.b].map(flat));
                parts.name(i);
            }
        }
        TypedShape::HeightField(h) => {
            h.map_elements_in_local_aabb(&local, &mut |i, t| {
                parts.add_triangle(t.vertices().map(|p| pose * p), i);
            });
        }
        TypedShape::Voxels(v) => {
            let cube = Cuboid::new(v.voxel_size() * 0.5);
            for voxel in v.voxels_intersecting_local_aabb(&local) {
                let pose = pose * Pose::from_translation(voxel.center);
                let faces = free_faces(voxel.state);
                add_faces(parts, &cube, faces, &pose, Face::of_surface(&[]), region);
                parts.name(voxel.linear_id.flat_id() as u32);
            }
        }
        _ => return false,
    }
    parts.name(0);
    true
}

/// The faces of a cuboid, as far as `region` (in the parts' frame) meets them.
fn add_cuboid(parts: &mut SweptParts, cuboid: &Cuboid, pose: &Pose, border: Real, region: &Aabb) {
    let kind = Face::of_solid(&[], border);
    add_faces(parts, cuboid, all_faces(), pose, kind, region);
}

/// Some faces of a cuboid, each by axis and side, as far as `region` (in the parts' frame) meets them. `kind` has no
/// corners.
fn add_faces(
    parts: &mut SweptParts,
    cuboid: &Cuboid,
    faces: impl Iterator<Item = (usize, Real)>,
    pose: &Pose,
    kind: Face,
    region: &Aabb,
) {
    let region = seen_from(pose, region);
    for (axis, sign) in faces {
        let corners = face_corners(cuboid, (axis, sign), pose);
        let face = Face {
            corners: &corners,
            ..kind
        };
        parts.add_unless_slid(face, |primitives| {
            let side = sign * cuboid.half_extents[axis];
            add_face(primitives, cuboid, (axis, side), pose, face.border, &region);
        });
    }
}

/// The face of a cuboid at `side` along an axis, as far as `region` (in its frame) meets it.
fn add_face(
    primitives: &mut PrimitiveList,
    cuboid: &Cuboid,
    (axis, side): (usize, Real),
    pose: &Pose,
    border: Real,
    region: &Aabb,
) {
    if side + border < region.mins[axis] || side - border > region.maxs[axis] {
        return;
    }
    let other = [(axis + 1) % 3, (axis + 2) % 3];
    let at = |[x, y]: [Real; 2]| {
        let mut local = Vector::splat(side);
        (local[other[0]], local[other[1]]) = (x, y);
        MedialSphere::new(pose * local, border)
    };
    let spans = other.map(|k| [region.mins[k] - border, region.maxs[k] + border]);
    add_rectangle(primitives, other.map(|k| cuboid.half_extents[k]), spans, at);
}

/// One side of a rectangle about the origin of a plane.
struct RectangleSide {
    /// Stretch of the side that is nearest to anything within a span, and somewhat more.
    ends: [Real; 2],
    /// Lengths from the right angle to the ends of the legs: of two such, a triangle that covers both spans. The spans'
    /// far corner is at 9/10 of the way to the long side. `None` where there is no room.
    leg: Option<[Real; 2]>,
}

impl RectangleSide {
    /// `None` where none of it is within the span.
    fn new(half: Real, [least, most]: [Real; 2]) -> Option<Self> {
        if least > half || most < -half {
            return None;
        }
        let length = most - least;
        let (margin, leg) = (0.125 * length, 2.5 * length);
        let legs = [
            [least - margin, least - margin + leg],
            [most + margin, most + margin - leg],
        ];
        let fits = |[from, to]: &[Real; 2]| from.abs() <= half && to.abs() <= half;
        Some(Self {
            // Slivers would be hard to compute with.
            ends: [(-half).max(least - length), half.min(most + length)],
            leg: legs.into_iter().find(fits),
        })
    }
}

/// Adds the part of a rectangle that is nearest to anything within `spans` along its two sides: one triangle where it
/// has the room, two else. `at` puts a point of its plane in place.
fn add_rectangle(
    primitives: &mut PrimitiveList,
    half: [Real; 2],
    spans: [[Real; 2]; 2],
    at: impl Fn([Real; 2]) -> MedialSphere,
) {
    let [Some(x), Some(y)] = [0, 1].map(|k| RectangleSide::new(half[k], spans[k])) else {
        return;
    };
    if let (Some([x, across]), Some([y, up])) = (x.leg, y.leg) {
        primitives.push(&[[x, y], [across, y], [x, up]].map(at));
        return;
    }
    let ([left, right], [bottom, top]) = (x.ends, y.ends);
    let [a, b, c, d] = [[left, bottom], [right, bottom], [right, top], [left, top]].map(at);
    primitives.push(&[a, b, c]);
    primitives.push(&[a, c, d]);
}

/// The faces of a hull as triangles, as far as `region` (in the parts' frame) meets their boxes.
fn add_polyhedron(
    parts: &mut SweptParts,
    hull: &ConvexPolyhedron,
    pose: &Pose,
    border: Real,
    region: &Aabb,
) {
    for_each_triangle(hull, pose, |corners| {
        let face = Aabb::from_points(corners);
        let sizes = [pose.translation, face.mins, face.maxs].map(|p| p.abs().max_element());
        let face = face.loosened(border + REAL_ROUNDING * sizes.into_iter().sum::<Real>());
        // A region that is not a number holds everything.
        let apart = face.mins.cmpgt(region.maxs) | region.mins.cmpgt(face.maxs);
        if !apart.any() {
            parts.add_unless_slid(Face::of_solid(&corners, border), |primitives| {
                primitives.push(&corners.map(|p| MedialSphere::new(p, border)));
            });
        }
    });
}

/// A triangle of the half-space's plane that `region` (in its frame) cannot look past.
fn add_plane(primitives: &mut PrimitiveList, plane: &HalfSpace, pose: &Pose, region: &Aabb) {
    let n = plane.normal;
    let foot = region.center() - n * n.dot(region.center());
    let reach = PLANE_REACH * (region.half_extents().length() + n.dot(region.center()).abs());
    let u = n.any_orthonormal_vector() * reach;
    let v = n.cross(u);
    let at = |[x, y]: [Real; 2]| MedialSphere::new(pose * (foot + u * x + v * y), 0.0);
    primitives.push(&[[0.0, 2.0], [-1.75, -1.0], [1.75, -1.0]].map(at));
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d::shape::{Compound, SharedShape};

    /// 40 by 40 balls, a metre apart, in a plane, beside a box of a tenth of that in the middle of one.
    #[test]
    fn of_many_balls_only_those_near_a_body_become_parts() {
        let at = |k: usize| Vector::new((k % 40) as Real, 0.0, (k / 40) as Real);
        let balls = (0..1600).map(|k| (Pose::from_translation(at(k)), SharedShape::ball(0.5)));
        let ground = Compound::new(balls.collect());
        let place = Vector::new(17.0, 0.5, 23.0);
        let region = Aabb::from_half_extents(place, Vector::splat(0.05));
        let mut parts = SweptParts::default();
        assert!(add_shape(&mut parts, &ground, &region));
        assert_eq!(parts.primitives.len(), 1);
    }
}
