//! The other shapes: their faces, what they hold, and the closed forms of cylinders and cones.
//!
//! - Flat faces: `shape_faces.rs`. Children of a compound in a box: `compound_children.rs`.
//! - What a closed shape holds: `inside.rs`. Distances of bodies of revolution in closed form: `axisymmetric.rs`.

pub(crate) mod axisymmetric;
pub(crate) mod compound_children;
pub(crate) mod inside;
pub(crate) mod shape_faces;
