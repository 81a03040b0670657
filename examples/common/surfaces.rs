//! What a collider is, as triangles.

use super::mesh::Mesh;
use rapier3d::prelude::{Shape, TypedShape};
use rapier3d_medial::MedialMesh;

/// The surface of a medial mesh, a hull, a triangle mesh, or of all parts of a compound, which may
/// overlap; empty for other shapes.
pub fn surface(shape: &dyn Shape) -> Mesh {
    let (vertices, indices) = match shape.as_typed_shape() {
        TypedShape::ConvexPolyhedron(hull) => hull.to_trimesh(),
        TypedShape::TriMesh(mesh) => (mesh.vertices().to_vec(), mesh.indices().to_vec()),
        TypedShape::Compound(parts) => {
            let mut all = Mesh::default();
            for (pose, part) in parts.shapes() {
                let part = surface(&**part);
                let first = all.vertices.len() as u32;
                let moved = part.vertices.iter().map(|v| pose.transform_point(*v));
                all.vertices.extend(moved);
                let shifted = part.indices.iter().map(|t| t.map(|i| i + first));
                all.indices.extend(shifted);
            }
            return all;
        }
        _ => match shape.as_shape::<MedialMesh>() {
            Some(mesh) => mesh.envelope(mesh.aabb().extents().max_element() / 64.0),
            None => return Mesh::default(),
        },
    };
    Mesh { vertices, indices }
}
