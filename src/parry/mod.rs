//! The medial mesh as a shape of parry, rapier's geometry library (layer 5): queries, contact manifolds and shape
//! casts, against medial meshes and all of parry's shapes. Each folder (a room) uses only those listed before it.
//!
//! # Files
//! - Which shape it is: `shape_id.rs`. `partners/`: the other shapes.
//! - `queries/`: distances and casts.
//! - `contacts/`: contact manifolds, and `corrections/`: those of parry that are wrong.
//! - The shape: `shape.rs`, of convex parts (`medial_part.rs`). Rays: `rays.rs`.
//! - What a pipeline tells the dispatcher for a step, muted pairs among it: `narrow_phase_plan.rs`.
//! - The entry: `dispatcher.rs`. Its manifolds: `contact_manifolds.rs` is what parry calls; those of other shapes that
//!   parry computes are asked for by `by_parry.rs`. Contacts of primitives that their neighbours hide are left out
//!   (`pair/ghost_contacts.rs`).

mod by_parry;
mod contact_manifolds;
pub mod contacts;
pub(crate) mod corrections;
pub(crate) mod dispatcher;
pub(crate) mod medial_part;
pub(crate) mod narrow_phase_plan;
mod partners;
pub mod queries;
pub(crate) mod rays;
pub(crate) mod shape;
pub(crate) mod shape_id;

pub use dispatcher::MedialDispatcher;
pub use queries::swept_sphere_parts::Unsweepable;
