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
        let v = Vec3::<f64>::from_vector(local);
        let [x, y, z] = self.rotation;
        self.translation + x * v.x + y * v.y + z * v.z
    }
    /// A direction of the second body.
    pub(super) fn direction(&self, local: Vector) -> Vec3<f64> {
        self.point(local) - self.translation
    }
    pub(super) fn inverse_point(&self, p: Vec3<f64>) -> Vector {
        let v = p - self.translation;
        let [x, y, z] = self.rotation;
        Vec3::new(x.dot(v), y.dot(v), z.dot(v)).to_vector()
    }
}
