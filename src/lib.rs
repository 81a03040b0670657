//! Concave colliders for the [rapier](https://rapier.rs) physics engine, with certified continuous
//! collision detection: fast bodies do not tunnel.
//!
//! A triangle mesh describes the surface of a body. A [`MedialMesh`] describes its inside, by spheres whose centres
//! lie in the middle of the body (on its *medial axis*). Every two neighbouring spheres are joined by a *medial cone*
//! and every three by a *medial slab*; each is the convex hull of its spheres. These cones and slabs are the
//! *primitives* of the mesh. A few dozen follow a concave body (a ring, chain link, hook, gripper, creature) closely,
//! holes included. They are solid, and the time at which two of them first touch can be computed, with a proof that
//! there was no earlier contact: if a query answers that two bodies do not meet in a step, they do not.
//! `docs/guarantee.md` says for which inputs, and how rounding is accounted for.
//!
//! How to use it:
//! 1. [`MedialMesh::from_trimesh`] builds a medial mesh from your triangles, once, in seconds.
//!    [`MedialMesh::save_asset`] and [`MedialMesh::load_asset`] keep it in a file.
//! 2. [`ColliderBuilder::medial_mesh`](MedialColliderBuilder::medial_mesh) makes a collider of it.
//! 3. [`MedialPipeline::step`] takes the place of `world.step()`. After loading a saved world, call
//!    [`MedialPipeline::attach`].
//!
//! ```
//! use rapier3d::prelude::*;
//! use rapier3d_medial::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let (vertices, indices) = Cuboid::new(Vector::new(0.5, 0.2, 0.3)).to_trimesh();
//! let options = BuildOptions { primitives: Some(50), ..Default::default() };
//! let (mesh, report) = MedialMesh::from_trimesh(&vertices, &indices, &options)?;
//! let off = report.hausdorff.bound();
//! println!("at most {off} m from the triangle mesh");
//!
//! let mut world = PhysicsWorld::new();
//! let mut pipeline = MedialPipeline::new(MedialOptions::default());
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
//! Lengths are in your unit (metres in rapier). Times are fractions of the step, from 0 to 1, unless a name says
//! seconds. `docs/guide.md` goes on from here; `docs/notation.md` lists the symbols.
//!
//! The method comes from the paper "Continuous Collision Detection with Medial Axis Transform for Rigid Body
//! Simulation". Each file that departs from the paper says so at its beginning.
//!
//! # Layers
//! Each module imports only modules below it in this table; a test checks this. Most games need only
//! [`prelude`].
//!
//! | module | contents | to read first |
//! |---|---|---|
//! | [`rapier`] | the pipeline around rapier's step, traits for rapier's builders, the report of a step | `step.rs` |
//! | [`parry`] | the medial mesh as a shape of parry, rapier's geometry: queries, contacts, casts | `dispatcher.rs` |
//! | [`batch`] | contacts or first contacts of many pairs at once, on the CPU or a GPU | `backend.rs` |
//! | [`pair`] | two medial meshes: which primitives can meet, first contact, contacts | `search.rs`, `contacts.rs` |
//! | [`elementary`] | two primitives: certified distance and first contact; the paper's own method | `bracket.rs` |
//! | [`meshing`] | from a triangle mesh to a medial mesh | `recipe/pipeline.rs` |
//! | [`medial`] | the medial mesh itself, its trees, mass, surface and files | `mesh.rs` |
//! | [`math`] | SIMD lanes, closed forms, rigid motion, counters, constants | `nearest.rs`, `motion.rs` |
//!
//! Besides these, `error.rs` has the errors of this crate, and `bin/` the command line program `medial`.
//!
//! `CONTRIBUTING.md` in the repository has the map: which file has which of the paper's equations, which proof, and
//! which workaround for rapier. The first lines of each folder's `mod.rs` list its files.

// Limits are in clippy.toml.
#![warn(clippy::too_many_lines)]

pub mod batch;
pub mod elementary;
pub mod error;
pub mod math;
pub mod medial;
pub mod meshing;
pub mod pair;
pub mod parry;
pub mod rapier;

pub use batch::Backend;
pub use elementary::{AlternatingStart, InitialContact, Toi, ToiOptions, ToiStatus};
pub use error::{AssetError, BuildError, CalibrationError, GpuError, MeshError};
pub use medial::{MedialMesh, MedialPrimitive, MedialSphere};
pub use meshing::{BuildOptions, BuildReport, Creases, Progress, Quality, Variant};
pub use parry::MedialDispatcher;
pub use rapier::{
    Effect, Effects, MedialColliderBuilder, MedialIntegrationParameters, MedialOptions,
    MedialPipeline, MedialSharedShape, StepReport,
};

/// Everything that a game with rapier usually needs: `use rapier3d_medial::prelude::*;`. Saving of worlds
/// (`save_world`, feature `serde-serialize`) and drawing (`MedialDebugRender`, feature `debug-render`) are in
/// [`crate::rapier`], reading of mesh files in [`crate::meshing::mesh_file`].
pub mod prelude {
    pub use crate::{
        AssetError, Backend, BuildError, BuildOptions, BuildReport, Creases, Effect, Effects,
        MedialColliderBuilder, MedialIntegrationParameters, MedialMesh, MedialOptions,
        MedialPipeline, MedialSharedShape, MedialSphere, MeshError, Progress, Quality, StepReport,
        Variant,
    };
}

/// Runs the README's example as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// Runs the guide's examples as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide.md")]
pub struct Guide;

/// Runs the migration page's example as a test.
#[cfg(doctest)]
#[doc = include_str!("../docs/migration.md")]
pub struct Migration;
