//! [`Sphere`]: a centre and a radius, in any frame and precision.

use super::lane::Vec3;

/// A sphere; its length unit and frame are those of the user of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<S> {
    /// Centre.
    pub center: Vec3<S>,
    /// Radius, ≥ 0.
    pub radius: S,
}

impl<S> Sphere<S> {
    /// The sphere of this centre and radius.
    #[inline]
    pub fn new(center: Vec3<S>, radius: S) -> Self {
        Self { center, radius }
    }
}

/// A sphere in double precision.
pub type Ball = Sphere<f64>;

impl Ball {
    /// The ball interpolated between balls with weights of sum 1.
    pub fn interpolate(balls: [Self; 3], weights: [f64; 3]) -> Self {
        let [a, b, c] = balls;
        let [x, y, z] = weights;
        Self {
            center: a.center * x + b.center * y + c.center * z,
            radius: a.radius * x + b.radius * y + c.radius * z,
        }
    }
}
