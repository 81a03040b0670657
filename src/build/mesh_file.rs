//! Triangle meshes from files: Wavefront OBJ, STL, PLY, OFF, and glTF with feature `gltf`.
//!
//! PLY is read by `ply-rs-bw` and glTF by `gltf`, behind a check of the counts they are asked to believe.
//! The other three are read here: the line formats are smaller than the guards that the crates for them
//! would need. `tobj` 4.0 names no line, stops at a comment that is not UTF-8 and overflows on a
//! texture index below its range; `stl_io` 0.11 names no line either and takes a binary file
//! whose header begins with `solid` for text.
//!
//! Every reader ends in `Polygons::finish`: indices are checked, polygons are cut into triangles,
//! and vertices at exactly the same place become one.

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
use std::path::{Path, PathBuf};

/// A triangle mesh as it came from a file, in the file's unit of length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Corners; no two are equal.
    pub vertices: Vec<Vector>,
    /// Three different vertices each, counter-clockwise from outside as the file has them.
    pub indices: Vec<[u32; 3]>,
}

/// The formats that [`read`] knows.
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
    /// glTF 2.0, JSON or binary: all triangles of its scene, moved by their nodes.
    #[cfg(feature = "gltf")]
    Gltf,
}

impl MeshFormat {
    /// The format that a file's ending names, in either case.
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

/// Reads a mesh file; its ending names the format.
///
/// Polygons are cut into triangles, equal vertices become one, triangles left with two equal
/// corners are dropped. Memory is bounded by the file's size, whatever counts it announces.
///
/// Fails on an unknown ending, on a file that cannot be read, and on content as
/// [`read_bytes`] does.
pub fn read(path: impl AsRef<Path>) -> Result<TriangleMesh, BuildError> {
    let path = path.as_ref();
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

/// As [`read`], from memory; `name` stands for the path in errors. Buffers of a glTF file that are files of
/// their own are read from beside it.
///
/// Fails with [`BuildError::Syntax`] (line, or byte offset of a binary file) on content that
/// breaks off or breaks the format, with [`BuildError::NotFinite`] or
/// [`BuildError::IndexOutOfRange`] on values of a binary file, with [`BuildError::Empty`] if no
/// triangle is left.
///
/// ```
/// use rapier3d_medial::build::mesh_file::{MeshFormat, read_bytes};
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

/// What a reader collects.
#[derive(Default)]
struct Polygons {
    vertices: Vec<Vector>,
    /// Vertices of all polygons, one after the other, as the file counts them less its first index.
    corners: Vec<u64>,
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
                            format!("vertex {value} (from 0) is not among the {count}"),
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
