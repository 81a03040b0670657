//! Placement of the second body of a pair in the frame of the first, in double precision.

use crate::math::lane::Vec3;
use crate::math::motion::rotation_columns;
use crate::math::{Pose, Vector};

/// A relative pose in double precision, its rotation normalised.
pub(super) struct Placement {
    rotation: [Vec3<f64>; 3],
    translation: Vec3<f64>,
}

impl Placement {
    pub(super) fn new(pose: &Pose) -> Self {
        Self {
            rotation: rotation_columns(pose.rotation),
            translation: Vec3::from_vector(pose.translation),
        }
    }
    #[inline]
    pub(super) fn point(&self, local: Vector) -> Vec3<f64> {
        self.placed(Vec3::from_vector(local))
    }
    /// A point of the second body in double precision.
    #[inline]
    pub(super) fn placed(&self, v: Vec3<f64>) -> Vec3<f64> {
        let [x, y, z] = self.rotation;
        self.translation + x * v.x + y * v.y + z * v.z
    }
    /// A direction of the second body.
    pub(super) fn direction(&self, local: Vector) -> Vec3<f64> {
        self.turned(Vec3::from_vector(local))
    }
    /// A direction of the second body in double precision.
    pub(super) fn turned(&self, n: Vec3<f64>) -> Vec3<f64> {
        self.placed(n) - self.translation
    }
    pub(super) fn inverse_point(&self, p: Vec3<f64>) -> Vector {
        let v = p - self.translation;
        let [x, y, z] = self.rotation;
        Vec3::new(x.dot(v), y.dot(v), z.dot(v)).to_vector()
    }
}
