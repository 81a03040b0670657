//! The medial mesh as a shape of parry, rapier's geometry library (layer 5): queries, contact manifolds and shape
//! casts, against medial meshes and all of parry's shapes.
//!
//! # Files
//! - The entry: `dispatcher.rs`. The shape: `shape.rs`, of convex parts (`medial_part.rs`). Rays: `rays.rs`. Distance:
//!   `distance.rs`; the contact of bodies that are deep in each other, `deep_contact.rs`; parry's own for
//!   bodies of any size, `scaled_contact.rs`.
//! - Contact manifolds: `contact_manifolds.rs` is what parry calls. It takes those of two meshes from `manifolds.rs`,
//!   those on a flat face from `flat_face.rs`, and others from parry (`by_parry.rs`), between the convex parts that
//!   `convex_parts.rs` lists. Points and normals of a manifold: `manifold_points.rs`.
//! - Contacts of parry that are wrong: with triangles, those without a normal or too deep (`false_contacts.rs`) and
//!   those that point into a convex piece (`inward_contacts.rs`); normals of edges that just touch a face
//!   (`touching_normals.rs`) or voxels (`voxel_normals.rs`); contacts of convex pieces deep in other shapes that push
//!   another way than the shortest (`deep_pieces.rs`). For callers of parry's own dispatcher, normals that point into a
//!   convex piece: `outward_normals.rs`.
//! - Which contacts stay: those of primitives that their neighbours hide go (`ghost_contacts.rs`), those that bear the
//!   load stay (`contact_reduction.rs`), and impulses of the step before are handed on (`previous_contacts.rs`).
//! - Casts: `cast.rs`, and the answer in parry's form `cast_answer.rs`. The other shape becomes swept spheres
//!   (`swept_sphere_parts.rs`, the place for a new shape), or has closed forms of its own (`axisymmetric.rs` for
//!   cylinders and cones; their casts `axisymmetric_toi.rs` and `conservative_advancement.rs`). What touches at the
//!   start: `inside.rs` and `initial_contacts.rs`. Only what is in `swept_region.rs` is looked at; of a compound, the
//!   children that `compound_children.rs` finds there.
//! - Flat ground: its faces `shape_faces.rs`, a body that slides over them `sliding.rs` (of it the part that is near,
//!   `clipped_part.rs`), normals at the folds between them `folds.rs`.
//! - What a pipeline tells the dispatcher for a step, muted pairs among it: `narrow_phase_plan.rs`.

pub(crate) mod axisymmetric;
pub(crate) mod axisymmetric_toi;
mod by_parry;
pub mod cast;
mod cast_answer;
mod clipped_part;
mod compound_children;
pub(crate) mod conservative_advancement;
mod contact_manifolds;
pub mod contact_reduction;
mod convex_parts;
mod deep_contact;
mod deep_pieces;
pub(crate) mod dispatcher;
pub(crate) mod distance;
mod false_contacts;
pub(crate) mod flat_face;
mod folds;
pub mod initial_contacts;
pub(crate) mod inside;
mod inward_contacts;
mod manifold_points;
pub(crate) mod manifolds;
pub(crate) mod medial_part;
pub(crate) mod narrow_phase_plan;
mod outward_normals;
pub mod previous_contacts;
pub(crate) mod rays;
mod scaled_contact;
pub(crate) mod shape;
mod shape_faces;
pub(crate) mod sliding;
mod swept_region;
pub(crate) mod swept_sphere_parts;
mod touching_normals;
mod voxel_normals;

pub use dispatcher::MedialDispatcher;
pub use swept_sphere_parts::Unsweepable;
