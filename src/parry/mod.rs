//! The medial mesh as a shape of parry, rapier's geometry library (layer 5): queries, contact manifolds and shape
//! casts, against medial meshes and all of parry's shapes.
//!
//! # Files
//! - The entry: `dispatcher.rs`; the shape: `shape.rs`, of convex parts: `medial_part.rs`, with the normals that contacts of
//!   these have for callers of parry's own dispatcher: `outward_normals.rs`; rays: `rays.rs`.
//! - Contact manifolds: `contact_manifolds.rs` is what parry calls; it takes those of two meshes from `manifolds.rs`,
//!   those on a flat face from `flat_face.rs`, and others from parry. Contacts of primitives that their neighbours hide are
//!   left out (`ghost_contacts.rs`). Of parry's, those with triangles are replaced where they are wrong (`false_contacts.rs`)
//!   or left out (`inward_contacts.rs`), wrong normals are turned (`touching_normals.rs`, `voxel_normals.rs`), and of
//!   convex pieces deep in other shapes those are left out that push another way than the shortest (`deep_pieces.rs`).
//!   `contact_reduction.rs` leaves the ones that bear the load, and `previous_contacts.rs` hands on the impulses of those before. Between which convex parts: `convex_parts.rs`.
//!   Their points and normals: `manifold_points.rs`.
//! - Casts: `cast.rs`, parry's answer `cast_answer.rs`. The other shape becomes swept spheres (`swept_sphere_parts.rs`: the place for a new shape), or
//!   has closed forms of its own (`axisymmetric.rs` and its cast `axisymmetric_toi.rs`); `inside.rs` and
//!   `initial_contacts.rs` treat what touches at the start. Only what is in `swept_region.rs` is looked at; of
//!   a compound, the children that `compound_children.rs` finds there. Flat faces (`shape_faces.rs`) on whose plane a body lies are treated by `sliding.rs`,
//!   normals at their edges corrected by `folds.rs`.
//! - Distance: `distance.rs`.
//! - What a pipeline tells the dispatcher for a step, muted pairs among it: `narrow_phase_plan.rs`.

pub(crate) mod axisymmetric;
pub(crate) mod axisymmetric_toi;
pub mod cast;
mod cast_answer;
mod compound_children;
pub(crate) mod conservative_advancement;
mod contact_manifolds;
pub mod contact_reduction;
mod convex_parts;
mod deep_pieces;
pub(crate) mod dispatcher;
pub(crate) mod distance;
mod false_contacts;
pub(crate) mod flat_face;
mod folds;
mod ghost_contacts;
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
pub(crate) mod shape;
mod shape_faces;
pub(crate) mod sliding;
mod swept_region;
pub(crate) mod swept_sphere_parts;
mod touching_normals;
mod voxel_normals;

pub use dispatcher::MedialDispatcher;
pub use swept_sphere_parts::Unsweepable;
