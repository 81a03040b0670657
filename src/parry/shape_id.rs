//! [`ShapeId`]: which shape it is, among those alive.

use crate::medial::MedialMesh;
use parry3d::shape::Shape;

/// Which shape it is, among those alive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShapeId {
    /// Instance id of a medial mesh: one collider's.
    Medial(u64),
    /// Address of another shape: clones of a `SharedShape`, which are the same shape, have the same.
    Other(usize),
}

impl ShapeId {
    /// The id of a shape.
    pub fn new(shape: &dyn Shape) -> Self {
        match shape.as_shape::<MedialMesh>() {
            Some(mesh) => Self::Medial(mesh.instance_id()),
            None => Self::Other(std::ptr::from_ref(shape).addr()),
        }
    }
}
