//! Built once, loaded from then on: a folder of baked medial meshes, each named by a hash of what decides a build.

use crate::error::{BuildError, MeshError};
use crate::math::Vector;
use crate::medial::MedialMesh;
use crate::meshing::BuildOptions;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

impl MedialMesh {
    /// Loads from `folder` what [`MedialMesh::from_trimesh`] makes of the same triangles and options, if it was built
    /// before; otherwise builds it and saves it there, so that a game builds in its first run only. The folder is
    /// created if it is missing. Other triangles, options or versions of this crate make other files (16 hexadecimal
    /// digits and `.medial`). Files are never deleted; a damaged one is built and written again.
    /// Versions are told apart by the version number in this crate's `Cargo.toml`: if you depend on
    /// a clone of the repository, delete the folder to get what a newer state of it builds.
    ///
    /// # Errors
    /// The same as of [`MedialMesh::from_trimesh`], and [`MeshError::File`] within [`BuildError::Mesh`] if the
    /// folder or file cannot be written.
    ///
    /// ```
    /// use rapier3d::prelude::*;
    /// use rapier3d_medial::prelude::*;
    ///
    /// let folder = std::env::temp_dir().join("rapier3d_medial_doc");
    /// let (vertices, indices) = Cuboid::new(Vector::new(0.5, 0.2, 0.3)).to_trimesh();
    /// let options = BuildOptions { primitives: Some(50), ..Default::default() };
    /// let mesh = MedialMesh::from_trimesh_cached(&folder, &vertices, &indices, &options)?;
    /// assert!(mesh.primitive_count() <= 50);
    /// # Ok::<(), rapier3d_medial::BuildError>(())
    /// ```
    pub fn from_trimesh_cached(
        folder: impl AsRef<Path>,
        vertices: &[Vector],
        indices: &[[u32; 3]],
        options: &BuildOptions,
    ) -> Result<MedialMesh, BuildError> {
        let folder = folder.as_ref();
        let path = folder.join(format!("{:016x}.medial", key(vertices, indices, options)));
        if let Ok(mesh) = MedialMesh::load_asset(&path) {
            return Ok(mesh);
        }
        // Before the build, which is lost if there is no folder.
        std::fs::create_dir_all(folder).map_err(|source| MeshError::File {
            path: folder.to_owned(),
            source,
        })?;
        let (mesh, _) = MedialMesh::from_trimesh(vertices, indices, options)?;
        mesh.save_asset(&path)?;
        Ok(mesh)
    }
}

/// Hash of all that decides what is built.
fn key(vertices: &[Vector], indices: &[[u32; 3]], options: &BuildOptions) -> u64 {
    let mut hasher = DefaultHasher::new();
    env!("CARGO_PKG_VERSION").hash(&mut hasher);
    vertices.len().hash(&mut hasher);
    for vertex in vertices {
        vertex.to_array().map(f32::to_bits).hash(&mut hasher);
    }
    indices.hash(&mut hasher);
    format!("{options:?}").hash(&mut hasher);
    hasher.finish()
}
