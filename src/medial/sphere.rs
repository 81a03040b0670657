//! The medial sphere: a centre on the medial axis, and the radius up to the surface. Source: paper §3.

use crate::math::{Real, Vector};

/// A medial sphere, or any sphere interpolated between medial spheres.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct MedialSphere {
    /// Centre, in the body's frame, in the user's unit of length.
    pub center: Vector,
    /// Radius, ≥ 0, in the user's unit of length.
    pub radius: Real,
}

impl MedialSphere {
    /// A sphere from its centre and radius.
    pub fn new(center: Vector, radius: Real) -> Self {
        Self { center, radius }
    }
}
