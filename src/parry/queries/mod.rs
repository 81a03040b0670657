//! Distances and casts of a medial mesh and another shape, by certified queries.
//!
//! - Casts: `cast.rs`, and the answer in parry's form `cast_answer.rs`. The other shape becomes swept spheres
//!   (`swept_sphere_parts.rs`, the place for a new shape), or is a cylinder or a cone (`axisymmetric_toi.rs` with
//!   `conservative_advancement.rs`). Only what is in the box of `swept_region.rs` is looked at. What touches at the
//!   start: `initial_contacts.rs`.
//! - Flat ground: a body that slides over its faces, `sliding.rs` (`clipped_part.rs`: the part of it that is near), and
//!   normals at the folds between them, `folds.rs`.
//! - Distance: `distance.rs`.

pub(crate) mod axisymmetric_toi;
pub mod cast;
pub(crate) mod cast_answer;
pub(crate) mod clipped_part;
pub(crate) mod conservative_advancement;
pub(crate) mod distance;
pub(crate) mod folds;
pub mod initial_contacts;
pub(crate) mod sliding;
pub(crate) mod swept_region;
pub(crate) mod swept_sphere_parts;
