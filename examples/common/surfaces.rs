//! What a collider is, as triangles.

use super::mesh::Mesh;
use rapier3d::prelude::{Real, Shape, TypedShape};
use rapier3d_medial::{MedialMesh, MedialPrimitive};

/// The surface of a hull or a triangle mesh, of all parts of a compound, or of all primitives of a medial
/// mesh; parts and primitives overlap. Empty for other shapes.
pub fn surface(shape: &dyn Shape) -> Mesh {
    let (vertices, indices) = match shape.as_typed_shape() {
        TypedShape::ConvexPolyhedron(hull) => hull.to_trimesh(),
        TypedShape::TriMesh(mesh) => (mesh.vertices().to_vec(), mesh.indices().to_vec()),
        TypedShape::Compound(parts) => {
            let moved = parts.shapes().iter().map(|(pose, part)| {
                let mut part = surface(&**part);
                for v in &mut part.vertices {
                    *v = pose.transform_point(*v);
                }
                part
            });
            return joined(moved);
        }
        _ => match shape.as_shape::<MedialMesh>() {
            Some(mesh) => {
                let spacing = mesh.aabb().extents().max_element() / 64.0;
                return joined(primitive_surfaces(mesh, spacing));
            }
            None => return Mesh::default(),
        },
    };
    Mesh { vertices, indices }
}

/// The surface of each primitive of a medial mesh, in triangles of `spacing`. Drawn together they have no seams, which
/// the surface of the whole mesh has: its pieces share curves, but no vertices.
pub fn primitive_surfaces(mesh: &MedialMesh, spacing: Real) -> impl Iterator<Item = Mesh> {
    mesh.primitives().filter_map(move |primitive| {
        let spheres = primitive.spheres().to_vec();
        let alone = match primitive {
            MedialPrimitive::Sphere(_) => MedialMesh::new(spheres, vec![], vec![]),
            MedialPrimitive::Cone(_) => MedialMesh::new(spheres, vec![[0, 1]], vec![]),
            MedialPrimitive::Slab(_) => MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]),
        };
        // A primitive of a mesh is a mesh.
        let (vertices, indices) = alone.ok()?.envelope(spacing);
        Some(Mesh { vertices, indices })
    })
}

/// Many meshes as one.
fn joined(meshes: impl Iterator<Item = Mesh>) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let first = all.vertices.len() as u32;
        all.vertices.extend(mesh.vertices);
        let shifted = mesh.indices.iter().map(|t| t.map(|i| i + first));
        all.indices.extend(shifted);
    }
    all
}
