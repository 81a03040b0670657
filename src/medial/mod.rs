//! The medial mesh itself (layer 1): spheres joined by medial cones and slabs, their trees, mass, surface and
//! files.
//!
//! # Files
//! - The mesh: `mesh.rs`, of `sphere.rs`, `primitive.rs` and `simplex.rs`; what is refused: `check.rs`.
//! - Trees for queries: `tree.rs`, `rectangle.rs` and `proxy_hull.rs` (bounds), `leaf_order.rs`, `convex_pieces.rs`.
//! - Geometry: `mass.rs`, in closed form `cone_mass.rs` and `polyhedron_mass.rs`; `thickness.rs`, `chord.rs` (rays), `exact.rs`, `scaled.rs`; the surface as triangles:
//!   `envelope.rs`.
//! - Files: `asset.rs` (the layout of a baked mesh), `saved.rs` (serde), `ma_file.rs`.
//! - Meshes that need no build: `solids.rs`, `boxes.rs`, `polygon.rs`.

pub mod asset;
pub(crate) mod boxes;
pub(crate) mod check;
pub(crate) mod chord;
mod cone_mass;
pub mod convex_pieces;
mod cover;
pub(crate) mod envelope;
pub(crate) mod exact;
mod files;
pub(crate) mod leaf_order;
pub(crate) mod ma_file;
pub(crate) mod mass;
pub(crate) mod mesh;
pub(crate) mod polygon;
mod polyhedron_mass;
pub(crate) mod primitive;
pub mod proxy_hull;
pub(crate) mod rectangle;
#[cfg(feature = "serde")]
mod saved;
pub(crate) mod scaled;
mod sheet;
pub(crate) mod simplex;
pub(crate) mod solids;
pub(crate) mod sphere;
pub(crate) mod text;
pub(crate) mod thickness;
pub mod tree;

pub use mesh::MedialMesh;
pub use primitive::{MedialPrimitive, PointDistance};
pub use simplex::Simplex;
pub use sphere::MedialSphere;
