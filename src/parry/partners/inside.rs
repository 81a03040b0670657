//! Whether a medial mesh starts inside a closed shape, and which way out is the shortest.
//!
//! The way out of a convex body leads through one of its faces. If `n` is the face's outward normal and `h` its
//! offset, all spheres `(c, r)` are outside after moving by `max (h − n·c + r)` along `n`. The answer is the face
//! for which this is smallest. (For a body that is not entirely inside, the way over an edge may be shorter; but a
//! face is what a solver can push against.)

use super::compound_children::{children_in, least_over_children};
use crate::math::{Real, Vector};
use crate::medial::MedialSphere;
use parry3d::bounding_volume::Aabb;
use parry3d::query::PointQuery;
use parry3d::shape::{ConvexPolyhedron, Cuboid, Shape, Triangle, TypedShape};

/// Factor by which a distance may exceed the one that parry's projections give: they are off by less.
pub const PROJECTION_SLACK: Real = 1.01;

/// Whether a body given by its closed surface holds a point (in its own frame). Triangle meshes,
/// height fields and polylines are surfaces: they hold nothing. Balls, capsules, cylinders and cones are
/// swept as solids and need no such test, and parry's own fails where one has no size.
pub fn holds_point(shape: &dyn Shape, point: Vector) -> bool {
    match shape.as_typed_shape() {
        TypedShape::TriMesh(_)
        | TypedShape::HeightField(_)
        | TypedShape::Polyline(_)
        | TypedShape::Segment(_)
        | TypedShape::Triangle(_)
        | TypedShape::RoundTriangle(_)
        | TypedShape::Ball(_)
        | TypedShape::Capsule(_)
        | TypedShape::Cylinder(_)
        | TypedShape::Cone(_)
        | TypedShape::RoundCylinder(_)
        | TypedShape::RoundCone(_) => false,
        TypedShape::Compound(c) => children_in(c, &Aabb::new(point, point))
            .into_iter()
            .map(|child| &c.shapes()[child as usize])
            .any(|(pose, s)| holds_point(s.as_ref(), pose.inverse_transform_point(point))),
        // parry iterates for these, with tolerances that are as large as bodies of a centimetre.
        TypedShape::RoundCuboid(c) => beyond_cuboid(&c.inner_shape, point) <= c.border_radius,
        TypedShape::ConvexPolyhedron(hull) => {
            shape.contains_local_point(point) && !is_beyond_hull(hull, point, 0.0)
        }
        TypedShape::RoundConvexPolyhedron(c) => {
            shape.contains_local_point(point)
                && !is_beyond_hull(&c.inner_shape, point, c.border_radius)
        }
        _ => shape.contains_local_point(point),
    }
}

/// A length that is no less than the distance of a point to a shape, but for [`PROJECTION_SLACK`]: 0 inside.
pub fn most_distance(shape: &dyn Shape, point: Vector) -> Real {
    match shape.as_typed_shape() {
        TypedShape::RoundCuboid(c) => {
            let beyond = beyond_cuboid(&c.inner_shape, point);
            (beyond - c.border_radius).max(0.0)
        }
        TypedShape::ConvexPolyhedron(hull) => most_to_hull(shape, hull, point),
        TypedShape::RoundConvexPolyhedron(c) => most_to_hull(shape, &c.inner_shape, point),
        TypedShape::RoundTriangle(t) => t.inner_shape.distance_to_local_point(point, true),
        TypedShape::RoundCylinder(c) => c.inner_shape.distance_to_local_point(point, true),
        TypedShape::RoundCone(c) => c.inner_shape.distance_to_local_point(point, true),
        TypedShape::Compound(c) => {
            let to_child = |child: u32| {
                let (pose, s) = &c.shapes()[child as usize];
                most_distance(s.as_ref(), pose.inverse_transform_point(point))
            };
            least_over_children(c, point, PROJECTION_SLACK, to_child)
        }
        _ => shape.distance_to_local_point(point, true),
    }
}

/// Distance of a point to a cuboid.
fn beyond_cuboid(cuboid: &Cuboid, point: Vector) -> Real {
    let beyond = point.abs() - cuboid.half_extents;
    beyond.max(Vector::ZERO).length()
}

/// A length that is no less than the distance of a point to a hull or a rounded one.
fn most_to_hull(shape: &dyn Shape, hull: &ConvexPolyhedron, point: Vector) -> Real {
    let told = shape.distance_to_local_point(point, true);
    if told > 0.0 || holds_point(shape, point) {
        return told;
    }
    let distances = hull.points().iter().map(|p| p.distance(point));
    distances.fold(Real::MAX, Real::min)
}

/// Whether a point is proven to be farther from a hull than a distance, by a direction along which all corners are: the
/// normal of a face, or away from the hull's middle, or from the nearest point of a face. Of faces of round sides parry
/// keeps one for many, so that a normal is a direction to look along, not the side of a plane.
fn is_beyond_hull(hull: &ConvexPolyhedron, point: Vector, distance: Real) -> bool {
    let ring = hull.vertices_adj_to_face();
    let corner = |k: u32| hull.points()[ring[k as usize] as usize];
    let is_apart = |n: Vector| {
        let heights = hull.points().iter().map(|p| n.dot(point - *p));
        heights.fold(Real::MAX, Real::min) > distance
    };
    let away_from = |from: Vector| is_apart((point - from).normalize_or_zero());
    let count = hull.points().len() as Real;
    let middle = hull.points().iter().fold(Vector::ZERO, |sum, p| sum + *p) / count;
    if away_from(middle) {
        return true;
    }
    let mut is_inside = true;
    for face in hull.faces() {
        let height = face.normal.dot(point - corner(face.first_vertex_or_edge));
        if height > distance && is_apart(face.normal) {
            return true;
        }
        is_inside &= height <= 0.0;
    }
    if is_inside || distance <= 0.0 {
        return false;
    }
    // Beyond no face by more, it may still be farther from an edge or a corner.
    let triangles = hull.faces().iter().flat_map(|face| {
        let first = face.first_vertex_or_edge;
        let others = first + 2..first + face.num_vertices_or_edges;
        others.map(move |k| Triangle::new(corner(first), corner(k - 1), corner(k)))
    });
    let on = triangles.map(|t| t.project_local_point(point, true).point);
    let nearest = on.min_by(|a, b| a.distance(point).total_cmp(&b.distance(point)));
    nearest.is_some_and(away_from)
}

/// Shortest translation out of a closed body.
#[derive(Clone, Copy, Debug)]
pub struct MinTranslation {
    /// Child of a compound that it leads out of; 0 of other shapes.
    pub child: u32,
    /// Index of the sphere that has the longest way.
    pub sphere: usize,
    /// Unit direction, in the closed body's frame.
    pub direction: Vector,
    /// Distance from that sphere's centre to the surface, a length.
    pub to_surface: Real,
    /// Distance to move, a length.
    pub depth: Real,
}

/// The way out for spheres given in the shape's frame, if one of their centres is inside. Of a
/// compound's children it is that of the one they are deepest in; of shapes without faces (voxels) that
/// of the centre furthest from the surface.
pub fn min_translation(shape: &dyn Shape, spheres: &[MedialSphere]) -> Option<MinTranslation> {
    if let TypedShape::Compound(c) = shape.as_typed_shape() {
        let of_child = |k: u32| {
            let (pose, child) = &c.shapes()[k as usize];
            let local = |s: &MedialSphere| {
                MedialSphere::new(pose.inverse_transform_point(s.center), s.radius)
            };
            let local: Vec<_> = spheres.iter().map(local).collect();
            let way = min_translation(child.as_ref(), &local)?;
            Some(MinTranslation {
                child: k,
                direction: pose.rotation * way.direction,
                ..way
            })
        };
        let mut centers = Aabb::new_invalid();
        spheres.iter().for_each(|s| centers.take_point(s.center));
        let children = children_in(c, &centers).into_iter();
        let ways = children.filter_map(of_child);
        return ways.max_by(|a, b| a.depth.total_cmp(&b.depth));
    }
    if !spheres.iter().any(|s| holds_point(shape, s.center)) {
        return None;
    }
    let mut best: Option<MinTranslation> = None;
    let through = |n: Vector, offset: Real| {
        let to_surface = |s: &MedialSphere| offset - n.dot(s.center);
        let depth = |s: &MedialSphere| to_surface(s) + s.radius;
        let deepest = spheres
            .iter()
            .enumerate()
            .max_by(|a, b| depth(a.1).total_cmp(&depth(b.1)));
        if let Some((sphere, s)) = deepest
            && best.is_none_or(|old| depth(s) < old.depth)
        {
            best = Some(MinTranslation {
                child: 0,
                sphere,
                direction: n,
                to_surface: to_surface(s),
                depth: depth(s),
            });
        }
    };
    match shape.as_typed_shape() {
        TypedShape::Cuboid(c) => cuboid_faces(c, 0.0, through),
        TypedShape::RoundCuboid(c) => cuboid_faces(&c.inner_shape, c.border_radius, through),
        TypedShape::ConvexPolyhedron(c) => hull_faces(c, 0.0, through),
        TypedShape::RoundConvexPolyhedron(c) => {
            hull_faces(&c.inner_shape, c.border_radius, through);
        }
        TypedShape::HalfSpace(plane) => {
            let mut through = through;
            through(plane.normal, 0.0);
        }
        _ => best = by_projection(shape, spheres),
    }
    best
}

fn cuboid_faces(cuboid: &Cuboid, border: Real, mut face: impl FnMut(Vector, Real)) {
    let h = cuboid.half_extents;
    for (axis, half) in [(Vector::X, h.x), (Vector::Y, h.y), (Vector::Z, h.z)] {
        face(axis, half + border);
        face(-axis, half + border);
    }
}

fn hull_faces(hull: &ConvexPolyhedron, border: Real, mut face: impl FnMut(Vector, Real)) {
    let ring = hull.vertices_adj_to_face();
    for f in hull.faces() {
        let corner = hull.points()[ring[f.first_vertex_or_edge as usize] as usize];
        face(f.normal, f.normal.dot(corner) + border);
    }
}

fn by_projection(shape: &dyn Shape, spheres: &[MedialSphere]) -> Option<MinTranslation> {
    let way = |(sphere, s): (usize, &MedialSphere)| {
        if !holds_point(shape, s.center) {
            return None;
        }
        let out = shape.project_local_point(s.center, false).point - s.center;
        // On a voxel's face any side that is free is as near.
        let aside = match shape.as_typed_shape() {
            TypedShape::Voxels(voxels) => 0.5 * voxels.voxel_size().min_element(),
            _ => 0.0,
        };
        let is_free = |way: &Vector| !holds_point(shape, s.center + *way * aside);
        let free = || Vector::AXES.into_iter().flat_map(|a| [a, -a]).find(is_free);
        Some(MinTranslation {
            child: 0,
            sphere,
            direction: out.try_normalize().or_else(free)?,
            to_surface: out.length(),
            depth: out.length() + s.radius,
        })
    };
    let ways = spheres.iter().enumerate().filter_map(way);
    ways.max_by(|a, b| a.depth.total_cmp(&b.depth))
}
