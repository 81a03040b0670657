//! The flat faces of parry's shapes: of cuboids and hulls, rounded or not, also in compounds, and of triangle meshes,
//! height fields and voxels.

use super::compound_children::children_in;
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use parry3d::bounding_volume::Aabb;
use parry3d::shape::{ConvexPolyhedron, Cuboid, Shape, Triangle, TypedShape, VoxelState};

/// A flat face of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Face<'a> {
    /// Corners in their order around it; the first three make its plane.
    pub corners: &'a [Vector],
    /// Radius by which it is rounded, a length.
    pub border: Real,
    /// Whether it is one of a convex solid: a mesh lies on it only outside, from where its corners turn to the left.
    pub is_of_solid: bool,
}

impl<'a> Face<'a> {
    /// The face of a convex solid.
    pub fn of_solid(corners: &'a [Vector], border: Real) -> Self {
        Self {
            corners,
            border,
            is_of_solid: true,
        }
    }

    /// A face of a surface of many, each with two sides.
    pub fn of_surface(corners: &'a [Vector]) -> Self {
        Self {
            corners,
            border: 0.0,
            is_of_solid: false,
        }
    }
}

/// Whether a shape may have flat faces.
pub fn has_flat_faces(shape: &dyn Shape) -> bool {
    matches!(
        shape.as_typed_shape(),
        TypedShape::Cuboid(_)
            | TypedShape::RoundCuboid(_)
            | TypedShape::ConvexPolyhedron(_)
            | TypedShape::RoundConvexPolyhedron(_)
            | TypedShape::TriMesh(_)
            | TypedShape::HeightField(_)
            | TypedShape::Voxels(_)
            | TypedShape::Compound(_)
    )
}

/// The flat sides of a convex solid in its frame: outward unit normals, and heights along them.
pub fn flat_sides(shape: &dyn Shape) -> Vec<(Vector, Real)> {
    let of_cuboid = |cuboid: &Cuboid, border: Real| {
        let sides = all_faces().map(|(axis, sign)| {
            let mut normal = Vector::ZERO;
            normal[axis] = sign;
            (normal, cuboid.half_extents[axis] + border)
        });
        sides.collect()
    };
    let of_hull = |hull: &ConvexPolyhedron, border: Real| {
        let ring = hull.vertices_adj_to_face();
        let sides = hull.faces().iter().map(|face| {
            let corner = hull.points()[ring[face.first_vertex_or_edge as usize] as usize];
            (face.normal, face.normal.dot(corner) + border)
        });
        sides.collect()
    };
    match shape.as_typed_shape() {
        TypedShape::Cuboid(c) => of_cuboid(c, 0.0),
        TypedShape::RoundCuboid(c) => of_cuboid(&c.inner_shape, c.border_radius),
        TypedShape::ConvexPolyhedron(c) => of_hull(c, 0.0),
        TypedShape::RoundConvexPolyhedron(c) => of_hull(&c.inner_shape, c.border_radius),
        TypedShape::Cylinder(c) => [Vector::Y, Vector::NEG_Y]
            .map(|n| (n, c.half_height))
            .to_vec(),
        TypedShape::Cone(c) => vec![(Vector::NEG_Y, c.half_height)],
        _ => Vec::new(),
    }
}

/// Calls `see` on each flat face of `shape`, placed at `pose`. Of meshes, height fields and voxels those that `region`
/// (in the frame that it is placed in) meets; of compounds those of the children in or near it.
pub fn for_each_flat_face(
    shape: &dyn Shape,
    pose: &Pose,
    region: &Aabb,
    see: &mut dyn FnMut(Face),
) {
    let local = || seen_from(pose, region);
    let corners = |t: &Triangle| t.vertices().map(|p| pose * p);
    match shape.as_typed_shape() {
        TypedShape::Cuboid(c) => of_cuboid(c, pose, 0.0, see),
        TypedShape::RoundCuboid(c) => of_cuboid(&c.inner_shape, pose, c.border_radius, see),
        TypedShape::ConvexPolyhedron(c) => {
            for_each_triangle(c, pose, |corners| see(Face::of_solid(&corners, 0.0)));
        }
        TypedShape::RoundConvexPolyhedron(c) => {
            for_each_triangle(&c.inner_shape, pose, |corners| {
                see(Face::of_solid(&corners, c.border_radius))
            });
        }
        TypedShape::TriMesh(m) => {
            for i in m.bvh().intersect_aabb(&local()) {
                see(Face::of_surface(&corners(&m.triangle(i))));
            }
        }
        TypedShape::HeightField(h) => {
            h.map_elements_in_local_aabb(&local(), &mut |_, t| see(Face::of_surface(&corners(t))));
        }
        TypedShape::Voxels(v) => {
            let cube = Cuboid::new(v.voxel_size() * 0.5);
            for voxel in v.voxels_intersecting_local_aabb(&local()) {
                let pose = pose * Pose::from_translation(voxel.center);
                for face in free_faces(voxel.state) {
                    see(Face::of_surface(&face_corners(&cube, face, &pose)));
                }
            }
        }
        TypedShape::Compound(c) => {
            // A mesh counts as over a rectangle up to its radius beyond each side, so that past a corner, and above, it
            // is up to √3 radii off. The region holds the mesh, so that half its sides is a radius or more.
            let half = region.half_extents();
            let beyond = Aabb::new(region.mins - half, region.maxs + half);
            for i in children_in(c, &seen_from(pose, &beyond)) {
                let (child, s) = &c.shapes()[i as usize];
                for_each_flat_face(s.as_ref(), &(pose * child), region, see);
            }
        }
        _ => {}
    }
}

fn of_cuboid(cuboid: &Cuboid, pose: &Pose, border: Real, see: &mut dyn FnMut(Face)) {
    for face in all_faces() {
        see(Face::of_solid(&face_corners(cuboid, face, pose), border));
    }
}

/// Calls `see` on the corners of triangles that make the faces of a hull; from outside they turn to the left.
pub fn for_each_triangle(hull: &ConvexPolyhedron, pose: &Pose, mut see: impl FnMut([Vector; 3])) {
    let ring = hull.vertices_adj_to_face();
    for face in hull.faces() {
        let first = face.first_vertex_or_edge as usize;
        let n = face.num_vertices_or_edges as usize;
        let at = |k: usize| pose * hull.points()[ring[first + k] as usize];
        for k in 1..n.saturating_sub(1) {
            see([at(0), at(k), at(k + 1)]);
        }
    }
}

/// Axis and side (1 or -1) of each face of a cuboid.
pub fn all_faces() -> impl Iterator<Item = (usize, Real)> {
    (0..6).map(|k| (k / 2, if k % 2 == 0 { 1.0 } else { -1.0 }))
}

/// Axis and side of each face of a voxel that is not inside the solid; of an empty one there is none.
pub fn free_faces(state: VoxelState) -> impl Iterator<Item = (usize, Real)> {
    let bits = if state.is_empty() {
        0
    } else {
        state.free_faces().bits()
    };
    let all = all_faces().enumerate();
    all.filter_map(move |(k, face)| (bits & (1 << k) != 0).then_some(face))
}

/// The corners of a cuboid's face; from outside they turn to the left.
pub fn face_corners(cuboid: &Cuboid, (axis, sign): (usize, Real), pose: &Pose) -> [Vector; 4] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| {
        let mut local = Vector::splat(sign);
        (local[(axis + 1) % 3], local[(axis + 2) % 3]) = (x, y * sign);
        pose * (local * cuboid.half_extents)
    })
}

/// A box of the frame in which `pose` is placed, seen from the frame of `pose`, with what rounding may take from it.
pub fn seen_from(pose: &Pose, region: &Aabb) -> Aabb {
    let sizes = [pose.translation, region.mins, region.maxs].map(|p| p.abs().max_element());
    let size: Real = sizes.into_iter().sum();
    let seen = region.transform_by(&pose.inverse());
    Aabb::new(
        seen.mins - size * REAL_ROUNDING,
        seen.maxs + size * REAL_ROUNDING,
    )
}
