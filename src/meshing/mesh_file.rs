//! Reads triangle meshes from files: Wavefront OBJ, STL, PLY, OFF, and glTF (with feature `gltf`).
//!
//! PLY is read by the crate `ply-rs-bw` and glTF by `gltf`, after a check that the file is long enough for the
//! counts it announces. The other three formats are read here, since the crates for them would need more guards
//! around them than a reader has lines: `tobj` 4.0 names no line in its errors, stops at a comment that is not
//! UTF-8 and overflows on a texture index below its range; `stl_io` 0.11 names no line either and takes a
//! binary file whose header begins with `solid` for text.
//!
//! Every reader ends in `Polygons::finish`, which checks indices, cuts polygons into triangles, and makes vertices
//! at exactly the same place one.
//!
//! # Files
//! - Formats: `obj.rs`, `stl.rs`, `ply.rs`, `off.rs`, `gltf.rs`.
//! - Polygons cut into triangles: `polygon.rs`.

#[cfg(feature = "gltf")]
mod gltf;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::text::TextError;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A triangle mesh from a file, in the file's unit of length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Positions of the corners; no two are equal.
    pub vertices: Vec<Vector>,
    /// Three different vertices of each triangle, in the order of the file: usually counter-clockwise seen from
    /// outside.
    pub indices: Vec<[u32; 3]>,
}

/// A file format that [`read`] knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ: `v` and `f` lines; everything else is skipped.
    Obj,
    /// STL, text or binary.
    Stl,
    /// PLY, text or binary of either byte order.
    Ply,
    /// Object File Format, text.
    Off,
    /// glTF 2.0, JSON or binary (GLB): all triangles of the scene, each mesh placed by its nodes.
    #[cfg(feature = "gltf")]
    Gltf,
}

impl MeshFormat {
    /// The format that the ending of a file's name stands for, in capital or small letters; `None` if it is none of
    /// these.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            "off" => Some(Self::Off),
            #[cfg(feature = "gltf")]
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }
}

/// Reads a triangle mesh from a file; the ending of its name says the format.
///
/// Polygons are cut into triangles, vertices at the same place become one, and triangles with two equal
/// corners are dropped. Memory is bounded by the size of the file, whatever counts it announces.
///
/// # Errors
/// [`BuildError::UnknownFormat`] for an unknown ending, [`BuildError::File`] if the file cannot be read, and the errors
/// of [`read_bytes`].
///
/// ```no_run
/// use rapier3d_medial::{BuildOptions, MedialMesh, meshing::mesh_file};
/// let ring = mesh_file::read("ring.obj")?;
/// let options = BuildOptions { primitives: Some(50), ..Default::default() };
/// let (mesh, _) = MedialMesh::from_trimesh(&ring.vertices, &ring.indices, &options)?;
/// # Ok::<(), rapier3d_medial::BuildError>(())
/// ```
pub fn read(path: impl AsRef<Path>) -> Result<TriangleMesh, BuildError> {
    let path = path.as_ref();
    if path.is_dir() {
        return Err(BuildError::File {
            path: path.to_owned(),
            source: ErrorKind::IsADirectory.into(),
        });
    }
    let Some(format) = MeshFormat::of(path) else {
        let extension = path.extension().unwrap_or_default();
        return Err(BuildError::UnknownFormat {
            path: path.to_owned(),
            extension: extension.to_string_lossy().into_owned(),
        });
    };
    let bytes = std::fs::read(path).map_err(|source| BuildError::File {
        path: path.to_owned(),
        source,
    })?;
    read_bytes(&bytes, format, path)
}

/// Reads a triangle mesh from the bytes of a file, as [`read`] does. Errors call it `name`; if a glTF file keeps
/// its buffers in files of their own, they are read from the folder of `name`.
///
/// # Errors
/// - [`BuildError::Syntax`] with the line (or byte offset, in a binary file) if the content ends early or
///   breaks the format.
/// - [`BuildError::NotFinite`] for a coordinate that is not finite, [`BuildError::IndexOutOfRange`] for a vertex that
///   is not there, in a binary file.
/// - [`BuildError::Empty`] if no triangle is left.
///
/// ```
/// use rapier3d_medial::meshing::mesh_file::{MeshFormat, read_bytes};
/// let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
/// let square = read_bytes(text, MeshFormat::Obj, "square.obj".as_ref())?;
/// assert_eq!(square.indices.len(), 2);
/// # Ok::<(), rapier3d_medial::BuildError>(())
/// ```
pub fn read_bytes(
    bytes: &[u8],
    format: MeshFormat,
    name: &Path,
) -> Result<TriangleMesh, BuildError> {
    let source = Source { name, bytes };
    let polygons = match format {
        MeshFormat::Obj => obj::read(&source),
        MeshFormat::Stl => stl::read(&source),
        MeshFormat::Ply => ply::read(&source),
        MeshFormat::Off => off::read(&source),
        #[cfg(feature = "gltf")]
        MeshFormat::Gltf => gltf::read(&source),
    }?;
    polygons.finish(&source)
}

/// A file's content, and its name for errors.
struct Source<'a> {
    name: &'a Path,
    bytes: &'a [u8],
}

impl Source<'_> {
    fn path(&self) -> PathBuf {
        self.name.to_owned()
    }

    fn at_line(&self, line: usize, message: impl Into<String>) -> BuildError {
        BuildError::Syntax {
            path: self.path(),
            location: format!("line {line}"),
            message: message.into(),
        }
    }

    fn at_byte(&self, byte: usize, message: impl Into<String>) -> BuildError {
        BuildError::Syntax {
            path: self.path(),
            location: format!("byte {byte}"),
            message: message.into(),
        }
    }

    fn text_error(&self, error: TextError) -> BuildError {
        match error {
            TextError::Io(source) => BuildError::File {
                path: self.path(),
                source,
            },
            TextError::Syntax { line, message } => self.at_line(line, message),
        }
    }
}

/// Vertices and triangles that a reader collects.
#[derive(Default)]
struct Polygons {
    vertices: Vec<Vector>,
    /// Vertices of all polygons, one after the other, counted from 0.
    corners: Vec<u64>,
    /// The index by which the file calls its first vertex.
    first_index: u64,
    /// End of each polygon in `corners`, and its line in a text file.
    ends: Vec<(usize, Option<usize>)>,
}

impl Polygons {
    /// Takes the corners pushed since the last call as a polygon.
    fn close_polygon(&mut self, line: Option<usize>) {
        self.ends.push((self.corners.len(), line));
    }

    fn finish(self, source: &Source) -> Result<TriangleMesh, BuildError> {
        for (index, v) in self.vertices.iter().enumerate() {
            if !v.is_finite() {
                return Err(BuildError::NotFinite {
                    index,
                    position: v.to_array(),
                });
            }
        }
        let (vertices, welded) = weld(&self.vertices);
        let mut indices = Vec::with_capacity(self.ends.len());
        let mut start = 0;
        let count = self.vertices.len();
        let mut corners: Vec<u32> = Vec::new();
        for (index, &(end, line)) in self.ends.iter().enumerate() {
            corners.clear();
            for &value in &self.corners[start..end] {
                let Some(&vertex) = welded.get(value as usize) else {
                    return Err(match line {
                        Some(line) => source.at_line(
                            line,
                            format!(
                                "vertex {} (from {}) is not among the {count}",
                                value.saturating_add(self.first_index),
                                self.first_index
                            ),
                        ),
                        None => BuildError::IndexOutOfRange {
                            index,
                            value,
                            count,
                        },
                    });
                };
                corners.push(vertex);
            }
            polygon::triangulate(&mut corners, &vertices, &mut indices);
            start = end;
        }
        indices.retain(|[a, b, c]| a != b && b != c && c != a);
        if indices.is_empty() {
            return Err(BuildError::Empty { vertices: count });
        }
        Ok(TriangleMesh { vertices, indices })
    }
}

/// The different vertices, in order of first use, and where each given one went.
fn weld(vertices: &[Vector]) -> (Vec<Vector>, Vec<u32>) {
    let mut kept = Vec::new();
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(vertices.len());
    let moved = vertices
        .iter()
        .map(|v| {
            // Adding 0 makes −0 equal to 0.
            let key = v.to_array().map(|c: Real| (c + 0.0).to_bits());
            *places.entry(key).or_insert_with(|| {
                kept.push(*v);
                kept.len() as u32 - 1
            })
        })
        .collect();
    (kept, moved)
}
