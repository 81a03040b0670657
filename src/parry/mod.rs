//! L5: the medial mesh as a parry shape: shape traits, contact manifolds, shape casts.

pub mod advance;
pub mod answers;
pub mod bearing;
pub mod cast;
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
