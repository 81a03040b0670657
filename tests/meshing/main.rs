//! Triangle mesh → medial mesh, against planted shapes and independent checks.

mod bad_input;
mod blocks;
mod broken;
mod cached;
mod combined;
mod concave;
mod corpus;
mod creases;
mod delaunay;
mod distance;
mod drums;
mod enclosure;
mod fitting;
mod hidden;
mod imperfect_blocks;
mod kits;
mod machine;
mod many;
mod meshes;
mod options;
#[path = "../medial/oracle.rs"]
#[allow(dead_code)] // Shared with `tests/medial`, which uses all of it.
mod oracle;
mod planted;
mod polyhedra;
mod prisms;
mod reduced;
mod scale;
mod shapes;
mod smallest;
mod thin;
mod threads;
mod topology;
mod touching;
mod walls;

use meshes::Mesh;
use rapier3d_medial::Quality;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh};

/// Builds with a number of primitives, with enclosure or without.
fn build(mesh: &Mesh, primitives: usize, enclose: bool) -> (MedialMesh, BuildReport) {
    let mut options = BuildOptions::default();
    options.quality = Quality::Fast;
    options.primitives = Some(primitives);
    options.enclose = enclose;
    MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)
        .expect("a planted mesh builds")
}

/// Signed distance to the union of all primitives, the slow way.
fn solid_distance(mesh: &MedialMesh, p: parry3d::math::Vector) -> f32 {
    mesh.primitives()
        .map(|primitive| primitive.signed_distance(p).distance)
        .fold(f32::MAX, f32::min)
}
