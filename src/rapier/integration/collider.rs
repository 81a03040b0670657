//! Traits that add `ColliderBuilder::medial_mesh(mesh)` and `SharedShape::medial_mesh(mesh)` to rapier, so that medial
//! colliders are made as all others are.

use crate::medial::MedialMesh;
use rapier3d::geometry::{ColliderBuilder, SharedShape};

/// Adds [`MedialColliderBuilder::medial_mesh`] to rapier's [`ColliderBuilder`].
pub trait MedialColliderBuilder {
    /// A collider with the shape of a medial mesh, whose frame becomes the collider's. Density, friction,
    /// restitution, sensor, groups and all other settings work as for any collider. The mesh's data is shared, so a
    /// clone of one mesh for each collider costs no memory.
    ///
    /// ```
    /// use rapier3d::prelude::*;
    /// use rapier3d_medial::prelude::*;
    /// let ring = MedialMesh::torus(0.5, 0.1, 16)?;
    /// let collider = ColliderBuilder::medial_mesh(ring.clone()).density(700.0).friction(0.6);
    /// # let _ = collider;
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    fn medial_mesh(mesh: MedialMesh) -> ColliderBuilder;
}

impl MedialColliderBuilder for ColliderBuilder {
    fn medial_mesh(mesh: MedialMesh) -> ColliderBuilder {
        ColliderBuilder::new(SharedShape::medial_mesh(mesh))
    }
}

/// Adds [`MedialSharedShape::medial_mesh`] to rapier's [`SharedShape`].
pub trait MedialSharedShape {
    /// A shape of rapier from a medial mesh, with an [`MedialMesh::instance_id`] of its own. The mesh's data is shared.
    fn medial_mesh(mesh: MedialMesh) -> SharedShape;
}

impl MedialSharedShape for SharedShape {
    fn medial_mesh(mesh: MedialMesh) -> SharedShape {
        SharedShape::new(mesh.instance())
    }
}
