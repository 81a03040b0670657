//! Drop-in concave colliders for the [rapier](https://rapier.rs) physics engine, with certified
//! continuous collision detection.
//!
//! A triangle mesh of a concave body that moves (ring, chain link, hook, gripper, creature) becomes
//! a [`MedialMesh`]: spheres joined by medial cones and slabs, a simplified medial axis transform.
//! It is a solid, keeps its holes, and answers continuous collision queries with a certificate: what they
//! call free is free, for the inputs and by the bounds of `docs/guarantee.md`.
//! Source of the method: "Continuous Collision Detection with Medial Axis Transform for Rigid Body
//! Simulation"; where this crate departs from the paper, the file that does says so.
//!
//! ```
//! use rapier3d::prelude::*;
//! use rapier3d_medial::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let (vertices, indices) = Cuboid::new(Vector::new(0.5, 0.2, 0.3)).to_trimesh();
//! let options = BuildOptions { primitives: Some(50), ..Default::default() };
//! let (mesh, report) = MedialMesh::from_trimesh(&vertices, &indices, &options)?;
//! println!("off by at most {} m", report.hausdorff.error() + report.hausdorff.sampling);
//!
//! let mut world = PhysicsWorld::new();
//! let mut pipeline = MedialPipeline::new(MedialOptions::default());
//! pipeline.attach(&mut world);
//! world.insert_collider(ColliderBuilder::cuboid(9.0, 0.1, 9.0), None);
//! let body = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 1.0, 0.0));
//! world.insert(body, ColliderBuilder::medial_mesh(mesh));
//! for _ in 0..60 {
//!     pipeline.step(&mut world);
//! }
//! # assert!(world.bodies.iter().all(|(_, b)| (0.2..0.5).contains(&b.translation().y)));
//! # Ok(())
//! # }
//! ```
//!
//! # Layers
//! Imports go down only; a test checks it.
//!
//! | layer | what |
//! |---|---|
//! | [`rapier`] | the hook round rapier's step, builder traits, step report |
//! | [`parry`] | the medial mesh as a parry shape, dispatcher, manifolds, shape casts |
//! | [`batch`] | many pairs at once |
//! | [`pair`] | mesh against mesh: culling, first contact, contacts |
//! | [`elementary`] | the maths of one pair of primitives, certified; the paper's method beside it |
//! | [`build`] | triangle mesh → medial mesh |
//! | [`medial`] | the checked data, its trees, mass, envelope, files |
//! | [`math`] | lanes, closed forms at a fixed time, rigid motion, constants |
//!
//! Lengths are in the user's unit (metres in rapier), times fractions of the step in `[0, 1]`
//! unless named seconds. Symbols: `docs/notation.md`.

pub mod batch;
pub mod build;
pub mod elementary;
pub mod error;
pub mod math;
pub mod medial;
pub mod pair;
pub mod parry;
pub mod rapier;

pub use batch::Backend;
pub use build::{BuildOptions, BuildReport, Progress, Quality};
pub use elementary::{AlternatingStart, InitialContact, Toi, ToiOptions, ToiStatus};
pub use error::{AssetError, BuildError, CalibrationError, GpuError, MeshError};
pub use medial::{MedialMesh, MedialPrimitive, MedialSphere};
pub use parry::MedialDispatcher;
pub use rapier::{
    Effect, Effects, MedialColliderBuilder, MedialOptions, MedialPipeline, MedialSharedShape,
    StepReport,
};

/// What a rapier app needs: `use rapier3d_medial::prelude::*;`.
pub mod prelude {
    pub use crate::{
        Backend, BuildOptions, BuildReport, Effect, Effects, MedialColliderBuilder, MedialMesh,
        MedialOptions, MedialPipeline, MedialSharedShape, MedialSphere, Progress, Quality,
        StepReport,
    };
}

/// The README's example, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// The guide's examples, as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide.md")]
pub struct Guide;

/// The migration page's example, as a test.
#[cfg(doctest)]
#[doc = include_str!("../docs/migration.md")]
pub struct Migration;
