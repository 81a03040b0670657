//! Triangles of a ground along whose plane a mesh only slides in a step, which are no obstacle.
//!
//! A flat ground is cut into triangles, and a body that lies on it is within the contact distance of each that it comes
//! over. Its nearest point is then on an edge in front of the body, with a normal against the motion, and a body stopped
//! there would trip over nothing. But what stays above a triangle's plane crosses the triangle nowhere. Along a chord a
//! height is linear in time, and an arc of the angle `φ` is off its chord by `r φ² / 8` at most.

use crate::elementary::{InitialContact, ToiOptions};
use crate::math::tolerance::ROUNDING_ULPS;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialSphere};
use parry3d::query::NonlinearRigidMotion;

/// The spheres of a mesh at the start and at the end of a step, in the frame of a ground that does not turn.
#[derive(Clone, Debug)]
pub struct Sliding {
    spheres: [Vec<MedialSphere>; 2],
    /// How far paths are off their chords, rounding included, a length.
    bend: Real,
    /// Height up to which the mesh counts as lying on a plane, a length.
    target: Real,
    /// Depth to which it may sink in there, a length.
    by: Real,
}

impl Sliding {
    /// `None` where a first contact is asked for although the two touch, and where the ground turns.
    pub fn new(
        mesh: &MedialMesh,
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        seconds: Real,
        options: &ToiOptions,
    ) -> Option<Self> {
        let InitialContact::Deepen { by } = options.initial_contact else {
            return None;
        };
        if motion2.angvel != Vector::ZERO {
            return None;
        }
        let poses = [0.0, seconds].map(|t| {
            let [pose1, pose2] = [motion1, motion2].map(|m| m.position_at_time(t));
            pose2.inverse() * pose1
        });
        let placed = |pose: Pose| {
            let place = |s: &MedialSphere| MedialSphere::new(pose * s.center, s.radius);
            mesh.spheres().iter().map(place).collect::<Vec<_>>()
        };
        let arm = |s: &MedialSphere| s.center.distance(motion1.local_center);
        let arm = mesh.spheres().iter().map(arm).fold(0.0, Real::max);
        let angle = motion1.angvel.length() * seconds;
        let sizes = poses.map(|p| p.translation.abs().max_element());
        let rounding = ROUNDING_ULPS as Real * Real::EPSILON * (sizes[0] + sizes[1] + arm);
        Some(Self {
            spheres: poses.map(placed),
            bend: 0.125 * angle * angle * arm + rounding,
            target: options.target_distance,
            by,
        })
    }

    /// Whether the mesh lies on the plane of a triangle, on either side, and nowhere sinks in deeper than it may.
    pub fn is_along(&self, [a, b, c]: [Vector; 3]) -> bool {
        let across = (b - a).cross(c - a).normalize_or_zero();
        let lowest = |spheres: &[MedialSphere], n: Vector| {
            let heights = spheres.iter().map(|s| n.dot(s.center - a) - s.radius);
            heights.fold(Real::MAX, Real::min)
        };
        across != Vector::ZERO
            && [across, -across].into_iter().any(|n| {
                let start = lowest(&self.spheres[0], n);
                start <= self.target
                    && start >= self.bend - self.by
                    && lowest(&self.spheres[1], n) >= self.bend - self.by
            })
    }
}
