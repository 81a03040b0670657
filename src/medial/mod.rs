//! The medial mesh itself (layer 1): spheres joined by medial cones and slabs, their trees, mass, surface and
//! files.

pub mod asset;
pub mod boxes;
pub(crate) mod check;
pub mod chord;
mod cover;
pub mod envelope;
pub mod exact;
mod files;
pub(crate) mod leaf_order;
pub mod ma_file;
pub mod mass;
pub mod mesh;
pub mod polygon;
pub mod primitive;
pub mod proxy_hull;
pub mod rectangle;
#[cfg(feature = "serde")]
mod saved;
pub(crate) mod scaled;
mod sheet;
pub mod simplex;
pub mod solids;
pub mod sphere;
pub(crate) mod text;
pub mod thickness;
pub mod tree;

pub use mesh::MedialMesh;
pub use primitive::MedialPrimitive;
pub use sphere::MedialSphere;
