//! L1: the data. Spheres joined by medial cones and slabs, their trees, mass and files.

pub mod boxes;
pub mod chord;
mod cover;
pub mod envelope;
pub mod exact;
pub mod ma_file;
pub mod mass;
pub mod mesh;
pub mod polygon;
pub mod primitive;
mod sheet;
pub mod solids;
pub(crate) mod text;
pub mod tree;

pub use mesh::MedialMesh;
pub use primitive::{MedialPrimitive, MedialSphere};
