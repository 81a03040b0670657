//! How far a shape of parry is from the mesh that it was made of, at sampled points: what the
//! builder says of its medial meshes, for the peers.

use super::mesh::Mesh;
use super::surface_error::spread_points;
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{Compound, Shape};
use rapier3d::prelude::{Pose, TriMesh, Vector};

/// Points on the source, and on the boundary of the shape.
const POINTS: usize = 20_000;

/// The larger of two: how far the shape's boundary leaves the source's surface, and how far the
/// source sticks out of the shape.
pub fn shape_error(shape: &dyn Shape, source: &Mesh) -> f64 {
    let surface = source.to_parry();
    let parts: Vec<(Pose, &dyn Shape)> = match shape.as_shape::<Compound>() {
        Some(compound) => compound.shapes().iter().map(|(p, s)| (*p, &**s)).collect(),
        None => vec![(Pose::IDENTITY, shape)],
    };
    let boundaries: Vec<TriMesh> = parts
        .iter()
        .filter_map(|(pose, part)| boundary(*pose, *part))
        .collect();
    let points = |mesh: &TriMesh, count| -> Vec<Vector> {
        let vertices = mesh.vertices().iter().copied();
        spread_points(mesh, count).chain(vertices).collect()
    };
    let each = POINTS.div_ceil(boundaries.len().max(1));
    let mut off = 0.0f32;
    for (number, mesh) in boundaries.iter().enumerate() {
        // What lies within another part is inside of the shape.
        let hidden = |p: Vector| {
            let others = parts.iter().enumerate().filter(|(k, _)| *k != number);
            let mut others = others.map(|(_, part)| part);
            others.any(|(pose, part)| part.contains_point(pose, p))
        };
        for p in points(mesh, each).into_iter().filter(|p| !hidden(*p)) {
            off = off.max(surface.project_local_point(p, false).point.distance(p));
        }
    }
    for p in points(&surface, POINTS) {
        off = off.max(shape.distance_to_local_point(p, true));
    }
    off.into()
}

fn boundary(pose: Pose, part: &dyn Shape) -> Option<TriMesh> {
    if let Some(triangles) = part.as_trimesh() {
        return Some(triangles.clone());
    }
    let (mut vertices, indices) = match (part.as_convex_polyhedron(), part.as_voxels()) {
        (Some(hull), _) => hull.to_trimesh(),
        (_, Some(voxels)) => voxels.to_trimesh(),
        _ => return None,
    };
    for vertex in &mut vertices {
        *vertex = pose.transform_point(*vertex);
    }
    TriMesh::new(vertices, indices).ok()
}
