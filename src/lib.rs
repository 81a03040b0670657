//! Drop-in concave colliders for the rapier physics engine that never tunnel.

pub mod batch;
pub mod build;
pub mod elementary;
pub mod error;
pub mod math;
pub mod medial;
pub mod pair;
pub use build::{BuildOptions, BuildReport, Progress};
pub use error::{BuildError, MeshError};
pub use medial::{MedialMesh, MedialPrimitive, MedialSphere};
