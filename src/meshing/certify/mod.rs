//! Certificates of a result: that it covers the surface, how far it is off, its mass.

pub(crate) mod enclose;
pub mod hausdorff;
pub(crate) mod inside;
pub(crate) mod largest;
pub(crate) mod mass;
pub(crate) mod prepared_primitives;
pub(crate) mod primitive_tree;
pub(crate) mod slab_footprint;
