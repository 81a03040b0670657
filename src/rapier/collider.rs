//! `ColliderBuilder::medial_mesh(mesh)`, `SharedShape::medial_mesh(mesh)`: as if rapier had them.

use crate::medial::MedialMesh;
use rapier3d::geometry::{ColliderBuilder, SharedShape};

/// Adds [`MedialColliderBuilder::medial_mesh`] to rapier's [`ColliderBuilder`].
pub trait MedialColliderBuilder {
    /// A collider with the shape of a medial mesh, in the collider's frame. Density, friction,
    /// sensors, groups: as for any collider.
    fn medial_mesh(mesh: MedialMesh) -> ColliderBuilder;
}

impl MedialColliderBuilder for ColliderBuilder {
    fn medial_mesh(mesh: MedialMesh) -> ColliderBuilder {
        ColliderBuilder::new(SharedShape::medial_mesh(mesh))
    }
}

/// Adds [`MedialSharedShape::medial_mesh`] to rapier's [`SharedShape`].
pub trait MedialSharedShape {
    /// A shape with an instance id of its own; the mesh's data is shared.
    fn medial_mesh(mesh: MedialMesh) -> SharedShape;
}

impl MedialSharedShape for SharedShape {
    fn medial_mesh(mesh: MedialMesh) -> SharedShape {
        SharedShape::new(mesh.instance())
    }
}
