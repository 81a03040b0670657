//! A contact of two bodies as a pair of spheres.

use crate::math::{Real, Vector};

/// A contact of two bodies: a pair of interpolated spheres that touch or are near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpherePair {
    /// Index of the primitive of each body.
    pub primitives: [u32; 2],
    /// A number of the elementary test of the two primitives, and of the point of it: the same from step to step as
    /// long as the same features touch.
    pub feature: u32,
    /// Signed distance of the two spheres, a length, negative where they overlap.
    pub distance: Real,
    /// Unit normal from the first body to the second, in the first body's frame.
    pub normal: Vector,
    /// Nearest points on the surfaces, each in its own body's frame.
    pub points: [Vector; 2],
}
