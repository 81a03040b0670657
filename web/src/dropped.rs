//! A mesh file of the user's, built in a worker.

use crate::common::falling::SIZE;
use crate::common::mesh::Mesh;
use crate::flat;
use rapier3d::prelude::Vector;
use rapier3d_medial::meshing::mesh_file::{MeshFormat, read_bytes};
use rapier3d_medial::{BuildOptions, MedialMesh, Progress};
use std::ops::ControlFlow;
use std::path::Path;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// An object of JavaScript with a method `progress(stage, fraction)`.
    pub type Watcher;
    #[wasm_bindgen(method)]
    fn progress(this: &Watcher, stage: &str, fraction: f32);
}

/// A triangle mesh, as large as a ring, and its medial mesh.
#[wasm_bindgen]
pub struct Dropped {
    mesh: Mesh,
    /// The medial mesh, baked.
    medial: Vec<u8>,
    error: f32,
}

#[wasm_bindgen]
impl Dropped {
    /// Builds the medial mesh of a file, of so many primitives at most. `name` says its format.
    pub fn build(
        name: &str,
        bytes: &[u8],
        primitives: usize,
        watcher: &Watcher,
    ) -> Result<Dropped, JsError> {
        let name = Path::new(name);
        let format = MeshFormat::of(name)
            .ok_or_else(|| JsError::new("no mesh file: OBJ, GLB, STL, PLY and OFF are read"))?;
        let read = read_bytes(bytes, format, name)?;
        let mesh = Mesh {
            vertices: read.vertices,
            indices: read.indices,
        }
        .without_unused()
        .fitted(SIZE);
        let options = BuildOptions {
            primitives: Some(primitives),
            ..Default::default()
        };
        let mut show = |progress: Progress| {
            watcher.progress(progress.stage, progress.fraction);
            ControlFlow::Continue(())
        };
        let (medial, report) = MedialMesh::from_trimesh_with_progress(
            &mesh.vertices,
            &mesh.indices,
            &options,
            &mut show,
        )?;
        Ok(Self {
            mesh,
            medial: medial.to_bytes(),
            error: report.hausdorff.error() / report.longest_side,
        })
    }

    /// What a worker has sent.
    #[wasm_bindgen(constructor)]
    pub fn new(
        vertices: &[f32],
        indices: &[u32],
        medial: Vec<u8>,
        error: f32,
    ) -> Result<Dropped, JsError> {
        let (points, []) = vertices.as_chunks() else {
            return Err(JsError::new("vertices have three coordinates"));
        };
        let (triangles, []) = indices.as_chunks() else {
            return Err(JsError::new("triangles have three corners"));
        };
        let mesh = Mesh {
            vertices: points.iter().map(|p| Vector::from_array(*p)).collect(),
            indices: triangles.to_vec(),
        };
        Ok(Self {
            mesh,
            medial,
            error,
        })
    }

    /// Coordinates x, y, z of each vertex.
    pub fn vertices(&self) -> Vec<f32> {
        flat(&self.mesh.vertices)
    }

    /// Three vertices to a triangle.
    pub fn indices(&self) -> Vec<u32> {
        self.mesh.indices.as_flattened().to_vec()
    }

    /// The medial mesh, baked.
    pub fn baked(&self) -> Vec<u8> {
        self.medial.clone()
    }

    /// Largest distance between the surfaces of mesh and medial mesh (longest side 1).
    pub fn error(&self) -> f32 {
        self.error
    }
}

impl Dropped {
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    pub fn medial(&self) -> &[u8] {
        &self.medial
    }
}
