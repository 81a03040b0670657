//! The medial mesh as a shape of parry, rapier's geometry library (layer 5): queries, contact manifolds and shape
//! casts, against medial meshes and all of parry's shapes.

pub(crate) mod axisymmetric;
pub(crate) mod axisymmetric_toi;
pub mod cast;
pub(crate) mod conservative_advancement;
mod contact_manifolds;
pub mod contact_reduction;
pub(crate) mod dispatcher;
pub(crate) mod distance;
pub(crate) mod flat_face;
mod initial_contacts;
pub(crate) mod inside;
pub(crate) mod manifolds;
pub(crate) mod medial_part;
pub(crate) mod narrow_phase_plan;
pub(crate) mod rays;
pub(crate) mod shape;
pub(crate) mod swept_sphere_parts;

pub use dispatcher::MedialDispatcher;
pub use swept_sphere_parts::Unsweepable;
