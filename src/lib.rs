//! Drop-in concave colliders for the rapier physics engine that never tunnel.

pub mod batch;
pub mod build;
pub mod elementary;
pub mod error;
pub mod math;
pub mod medial;
pub mod pair;
pub mod parry;
pub mod rapier;

pub use build::{BuildOptions, BuildReport, Progress};
pub use elementary::{InitialContact, Toi, ToiOptions, ToiStatus};
pub use error::{BuildError, MeshError};
pub use medial::{MedialMesh, MedialPrimitive, MedialSphere};
pub use parry::MedialDispatcher;
pub use rapier::{
    MedialColliderBuilder, MedialOptions, MedialPipeline, MedialSharedShape, StepReport,
};

/// What a rapier app needs: `use rapier3d_medial::prelude::*;`.
pub mod prelude {
    pub use crate::{
        BuildOptions, BuildReport, MedialColliderBuilder, MedialMesh, MedialOptions,
        MedialPipeline, MedialSharedShape, MedialSphere, StepReport,
    };
}
