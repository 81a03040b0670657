//! Contacts of a medial mesh with a flat face: a half-space, or a side of a cuboid, hull or cylinder that the mesh
//! cannot reach past. The point of a hull of spheres that is nearest to a plane lies on one of the spheres, so the
//! contacts are those of the spheres themselves, all with one normal. parry would run its iterative GJK algorithm for
//! each primitive.

use crate::math::lane::Vec3;
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::medial::tree::NodeKind;
use crate::pair::PrimitiveTree;
use crate::parry::partners::shape_faces::flat_sides;
use parry3d::bounding_volume::Aabb;
use parry3d::query::{ContactManifold, TrackedContact};
use parry3d::shape::{ConvexPolyhedron, PackedFeatureId, Shape, TypedShape};

/// A plane with all of a mesh that can touch it above it or in it, in the mesh's frame.
#[derive(Clone, Copy)]
pub struct SupportPlane {
    /// Unit normal, out of the other shape.
    normal: Vec3<f64>,
    /// Height of the plane along the normal.
    height: f64,
}

/// The face of `other`, at `pose` in the mesh's frame, that holds all contacts of `mesh` within
/// `prediction`; none where an edge may be nearer, or the way out may be through another side.
pub fn face(
    mesh: &MedialMesh,
    other: &dyn Shape,
    pose: &Pose,
    prediction: Real,
) -> Option<SupportPlane> {
    let region = || mesh.aabb().transform_by(&pose.inverse());
    let (normal, height) = match other.as_typed_shape() {
        TypedShape::HalfSpace(plane) => (plane.normal, 0.0),
        TypedShape::Cuboid(_) => {
            let sides = flat_sides(other);
            sides[side(&sides, &region(), (prediction, Real::MAX))?]
        }
        TypedShape::ConvexPolyhedron(hull) => {
            let sides = flat_sides(other);
            let face = side(&sides, &region(), (prediction, Real::MAX))?;
            is_flat(hull, face, sides[face]).then_some(sides[face])?
        }
        TypedShape::Cylinder(cylinder) => {
            let (sides, region) = (flat_sides(other), region());
            let farthest = region.mins.abs().max(region.maxs.abs());
            let room = cylinder.radius - (farthest * Vector::new(1.0, 0.0, 1.0)).length();
            sides[side(&sides, &region, (prediction, room))?]
        }
        _ => return None,
    };
    let [normal, origin] = [pose.rotation * normal, pose.translation].map(Vec3::from_vector);
    Some(SupportPlane {
        normal,
        height: f64::from(height) + normal.dot(origin),
    })
}

/// The side of a convex solid that `region` lies on: the region is deeper in the planes of all other sides, and farther
/// from what else bounds the solid (`room`, a length), than it is deep in the plane of this one. `None` if there is no
/// such side.
fn side(
    sides: &[(Vector, Real)],
    region: &Aabb,
    (prediction, room): (Real, Real),
) -> Option<usize> {
    let (at, size) = (region.center(), region.half_extents());
    let half = |n: Vector| n.abs().dot(size);
    let depths = sides
        .iter()
        .map(|(n, height)| height - (n.dot(at) - half(*n)));
    let (k, depth) = depths.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let others = sides.iter().enumerate().filter(|(i, _)| *i != k);
    let rooms = others.map(|(_, (n, height))| height - (n.dot(at) + half(*n)));
    let inside = rooms.fold(room, Real::min);
    // Not a number is not inside.
    (inside >= depth && inside >= prediction).then_some(k)
}

/// Whether a hull's face is flat, and nothing of the hull above it: parry merges faces that are nearly in a plane.
fn is_flat(hull: &ConvexPolyhedron, face: usize, (normal, height): (Vector, Real)) -> bool {
    let points = hull.points();
    let size = points.iter().map(|p| p.abs().max_element());
    let rounding = REAL_ROUNDING * size.fold(0.0, Real::max);
    let above = |p: &Vector| normal.dot(*p) - height;
    let face = &hull.faces()[face];
    let first = face.first_vertex_or_edge as usize;
    let ring = &hull.vertices_adj_to_face()[first..first + face.num_vertices_or_edges as usize];
    points.iter().all(|p| above(p) <= rounding)
        && ring
            .iter()
            .all(|i| above(&points[*i as usize]) >= -rounding)
}

/// Writes the contacts of `mesh` with a face within `prediction`: a manifold for each primitive that
/// holds some, each sphere once. The mesh is body `side` (0 or 1); `pose` is the other's in the
/// mesh's frame. Manifolds that were there keep their data, and contacts of a sphere their impulses.
pub fn write_manifolds<M, C>(
    mesh: &MedialMesh,
    face: &SupportPlane,
    pose: &Pose,
    side: usize,
    prediction: Real,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) where
    M: Default + Clone,
    C: Default + Copy,
{
    let old = std::mem::take(manifolds);
    let up = face.normal.to_vector();
    let into_other = pose.inverse();
    // From body to body: out of the first, into the second.
    let (of_mesh, of_other) = (-up, into_other.rotation * up);
    for [primitive, sphere] in near(mesh, face, prediction) {
        let ids = if side == 0 {
            [primitive, 0]
        } else {
            [0, primitive]
        };
        let same = |m: &&ContactManifold<M, C>| [m.subshape1, m.subshape2] == ids;
        if manifolds.last().filter(same).is_none() {
            let before = old.iter().find(same).map(|m| m.data.clone());
            let mut m = ContactManifold::with_data(ids[0], ids[1], before.unwrap_or_default());
            [m.local_n1, m.local_n2] = in_order([of_mesh, of_other], side);
            manifolds.push(m);
        }
        let ball = mesh.spheres()[sphere as usize];
        let lowest = ball.center - up * ball.radius;
        let gap = face.gap(ball.center, ball.radius) as Real;
        let points = in_order([lowest, into_other * (lowest - up * gap)], side);
        let features = [PackedFeatureId::vertex(sphere), FLAT];
        let [fid1, fid2] = in_order(features, side);
        let mut point = TrackedContact::new(points[0], points[1], fid1, fid2, gap);
        let mut before = old.iter().flat_map(|m| &m.points);
        if let Some(before) = before.find(|p| [p.fid1, p.fid2] == [fid1, fid2]) {
            point.data = before.data;
        }
        if let Some(last) = manifolds.last_mut() {
            last.points.push(point);
        }
    }
}

/// Feature id of the other side of a contact with a face: a face that no cuboid has. parry itself calls features
/// unknown where its search for the nearest points found the contact.
const FLAT: PackedFeatureId = PackedFeatureId(u32::MAX);

/// Whether a list, not empty, is of this file.
pub fn wrote<M, C>(manifolds: &[ContactManifold<M, C>]) -> bool {
    let flat = |m: &ContactManifold<M, C>| {
        m.points
            .first()
            .is_some_and(|p| p.fid1 == FLAT || p.fid2 == FLAT)
    };
    manifolds.iter().all(flat)
}

impl SupportPlane {
    /// Gap between the plane and a ball in the mesh's frame.
    fn gap(&self, center: Vector, radius: Real) -> f64 {
        self.normal.dot(Vec3::from_vector(center)) - self.height - f64::from(radius)
    }
}

/// Primitive and sphere of every contact, sorted, each sphere with the first of its primitives.
fn near(mesh: &MedialMesh, face: &SupportPlane, prediction: Real) -> Vec<[u32; 2]> {
    let within = |center: Vector, radius: Real| face.gap(center, radius) <= f64::from(prediction);
    let mut found = Vec::new();
    let mut open: Vec<u32> = (0..mesh.roots()).collect();
    while let Some(node) = open.pop() {
        let (center, radius) = mesh.bound(node);
        if !within(center, radius) {
            continue;
        }
        match mesh.kind(node) {
            NodeKind::Nodes(i, j) => open.extend([i, j]),
            NodeKind::Primitive(i) => {
                let simplex = &mesh.simplices()[i as usize];
                let ends = &simplex.vertices[..simplex.len as usize];
                let near = ends.iter().filter(|&&v| {
                    let s = mesh.spheres()[v as usize];
                    within(s.center, s.radius)
                });
                found.extend(near.map(|&v| [v, i]));
            }
        }
    }
    found.sort_unstable();
    found.dedup_by_key(|[sphere, _]| *sphere);
    found.iter_mut().for_each(|pair| pair.reverse());
    found.sort_unstable();
    found
}

/// Puts the mesh's value and the other shape's in the order of the two bodies, of which the mesh is body `side` (0 or
/// 1).
fn in_order<T: Copy>([mesh, other]: [T; 2], side: usize) -> [T; 2] {
    if side == 0 {
        [mesh, other]
    } else {
        [other, mesh]
    }
}
