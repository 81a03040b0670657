//! The medial mesh as a shape of parry, rapier's geometry library (layer 5): queries, contact manifolds and shape
//! casts, against medial meshes and all of parry's shapes.

pub mod advance;
pub mod answers;
pub mod bearing;
pub mod cast;
mod contact_manifolds;
pub mod dispatcher;
pub mod flat;
pub mod follow;
pub mod foreign;
pub mod inside;
pub mod leaving;
pub mod manifolds;
pub mod near;
pub mod parts;
pub mod shape;
mod touching;
pub mod turned;

pub use answers::Answers;
pub use dispatcher::MedialDispatcher;
