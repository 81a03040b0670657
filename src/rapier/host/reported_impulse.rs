//! An impulse that two colliders gave each other in an impact within the step, in the form in which contact force
//! events report it.

use crate::math::tolerance::ONE_DIRECTION;
use crate::math::{Pose, Real, Vector};
use rapier3d::geometry::ColliderHandle;

/// Cosine from which the blows of a pair count as one, as points of one manifold.
const SAME_NORMAL: Real = ONE_DIRECTION as Real;

/// Impulses that two colliders gave each other in the impacts of a step.
#[derive(Clone, Debug)]
pub struct Impulse {
    /// Both colliders, in the narrow phase's order.
    pub colliders: [ColliderHandle; 2],
    /// Impulses, one a normal.
    pub blows: Vec<ReportedImpulse>,
}

/// An impulse between two colliders, as an event tells it.
#[derive(Clone, Copy, Debug)]
pub struct ReportedImpulse {
    /// Contact point in the frame of each collider.
    pub points: [Vector; 2],
    /// Unit normal from the first to the second: in the world, and in the frame of each.
    pub normals: [Vector; 3],
    /// Distance of the surfaces, < 0 where they overlap.
    pub distance: Real,
    /// Impulse along the normal.
    pub impulse: Real,
}

impl ReportedImpulse {
    /// The impulse of two colliders at these poses, with a contact at a point, of a unit normal from the first to the
    /// second and a distance, all in the world.
    pub fn new(
        poses: [Pose; 2],
        (point, normal, distance): (Vector, Vector, Real),
        impulse: Real,
    ) -> Self {
        let [n1, n2] = poses.map(|pose| pose.rotation.inverse() * normal);
        Self {
            points: poses.map(|pose| pose.inverse_transform_point(point)),
            normals: [normal, n1, -n2],
            distance,
            impulse,
        }
    }

    /// Adds it to those of its pair: to the one of about the same normal, if there is one.
    pub fn add_to(self, blows: &mut Vec<Self>) {
        let same = |b: &&mut Self| b.normals[0].dot(self.normals[0]) >= SAME_NORMAL;
        match blows.iter_mut().find(same) {
            Some(same) => same.add(&self),
            None => blows.push(self),
        }
    }

    /// Adds another: impulse and normal are those of the sum of both vectors, points and distance stay those of the
    /// first.
    fn add(&mut self, other: &Self) {
        let sum = |k: usize| self.normals[k] * self.impulse + other.normals[k] * other.impulse;
        let sums = [0, 1, 2].map(sum);
        self.impulse = sums[0].length();
        if self.impulse > 0.0 {
            self.normals = sums.map(Vector::normalize);
        }
    }
}
