//! The medial mesh as a shape of parry, rapier's geometry library (layer 5): queries, contact manifolds and shape
//! casts, against medial meshes and all of parry's shapes.

pub mod answers;
pub mod axisymmetric;
pub mod axisymmetric_toi;
pub mod cast;
pub mod conservative_advancement;
mod contact_manifolds;
pub mod contact_reduction;
pub mod dispatcher;
pub mod distance;
pub mod flat_face;
mod initial_contacts;
pub mod inside;
pub mod manifolds;
pub mod medial_part;
pub mod rays;
pub mod shape;
pub mod swept_sphere_parts;

pub use answers::Answers;
pub use dispatcher::MedialDispatcher;
