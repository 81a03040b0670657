//! The medial mesh itself (layer 1): spheres joined by medial cones and slabs, their trees, mass, surface and
//! files.
//!
//! # Files
//! - The mesh: `mesh.rs`, of spheres (`sphere.rs`) and primitives (`primitive.rs`; as indices of spheres `simplex.rs`);
//!   what is refused: `check.rs`. A mesh scaled by a factor: `scaled.rs`.
//! - Trees for queries: `tree.rs` (bounding spheres), `rectangle.rs` and `proxy_hull.rs` (other bounds),
//!   `leaf_order.rs` (below which child a primitive is), `convex_pieces.rs` (parts that fill their convex hull).
//! - Mass: `mass.rs`, in closed form `cone_mass.rs` and `polyhedron_mass.rs`.
//! - Geometry of primitives: `thickness.rs` (how thin a mesh is; where pieces overlap: `hidden_tips.rs`), `chord.rs`
//!   (where a line enters and leaves), `exact.rs` (spheres and tangent planes in double precision).
//! - The surface as triangles: `envelope.rs`, of the sheets of `sheet.rs`, less what `cover.rs` finds hidden.
//! - Files: `asset.rs` (the layout of a baked mesh), `saved.rs` (serde), `ma_file.rs` (the text format of Q-MAT);
//!   reading text: `text.rs`, writing safely: `files.rs`.
//! - Meshes that need no build: `solids.rs` (round bodies and frames), `boxes.rs`, `polygon.rs` (flat ones with a round
//!   rim).

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
mod hidden_tips;
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
