//! An impulse that two colliders gave each other in an impact within the step, in the form in which contact force
//! events report it.

use crate::math::{Real, Vector};
use crate::rapier::impacts::toi_query::Hit;
use crate::rapier::view::step_view::StepView;

/// Cosine from which the blows of a pair count as one (10°), as points of one manifold.
const SAME_NORMAL: Real = 0.985;

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
    /// Of a hit, with an impulse along its normal.
    pub fn new(view: &StepView, pair: [usize; 2], hit: &Hit, impulse: Real) -> Self {
        let poses = pair.map(|k| view.motion(k, hit.time).start);
        let [n1, n2] = poses.map(|pose| pose.rotation.inverse() * hit.normal);
        Self {
            points: poses.map(|pose| pose.inverse_transform_point(hit.point)),
            normals: [hit.normal, n1, -n2],
            distance: -hit.depth,
            impulse,
        }
    }

    /// Adds it to those of its pair: to the one of the same normal, if there is one.
    pub fn add_to(self, blows: &mut Vec<Self>) {
        let same = |b: &&mut Self| b.normals[0].dot(self.normals[0]) >= SAME_NORMAL;
        match blows.iter_mut().find(same) {
            Some(same) => same.impulse += self.impulse,
            None => blows.push(self),
        }
    }
}
