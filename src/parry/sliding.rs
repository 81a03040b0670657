//! Triangles of a ground, and faces of voxels, on whose plane a mesh lies: it can meet them from above only.
//!
//! A flat ground is cut into triangles, and a body that lies on it is within the contact distance of each that it comes
//! over. Its nearest point is then on an edge in front of the body, with a normal against the motion, and a body stopped
//! there would trip over nothing. But what stays above a triangle's plane crosses the triangle nowhere: such a triangle is no
//! obstacle. And what sinks in there is thrown back along the triangle's normal.
//!
//! Along a chord a height is linear in time, and a path of an acceleration up to `a` is off its chord by `a t² / 8` at most.
//! A point that turns with the mesh by `ω₁` at `r`, seen from a ground that turns by `ω₂`, `d` from its axis, has up to
//! `ω₁² r + ω₂² d + 2 ω₂ v`.

use crate::math::tolerance::ROUNDING_ULPS;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialSphere};
use parry3d::query::NonlinearRigidMotion;
use parry3d::shape::{Shape, TypedShape};

/// How deep a mesh may be in the plane that it slides along, lengths.
#[derive(Clone, Copy, Debug)]
pub struct Sinks {
    /// Deepest at the start, if it is to count as lying on the plane.
    pub lies: Real,
    /// Deepest in the step, if the triangle is to be no obstacle.
    pub to: Real,
    /// The same, from the depth at the start on.
    pub by: Real,
}

/// The spheres of a mesh at the start and at the end of a step, in the frame of the ground.
#[derive(Clone, Debug)]
pub struct Sliding {
    spheres: [Vec<MedialSphere>; 2],
    /// How far paths are off their chords, rounding included, a length.
    bend: Real,
    /// Height up to which the mesh counts as lying on a plane, a length.
    target: Real,
    sinks: Sinks,
}

impl Sliding {
    /// For a mesh over a ground of triangles or voxels. It counts as lying on a plane up to the distance `target`. `None` for other
    /// shapes.
    pub fn new(
        (mesh, ground): (&MedialMesh, &dyn Shape),
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        seconds: Real,
        target: Real,
        sinks: Sinks,
    ) -> Option<Self> {
        if !matches!(
            ground.as_typed_shape(),
            TypedShape::TriMesh(_) | TypedShape::HeightField(_) | TypedShape::Voxels(_)
        ) {
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
        let spheres = poses.map(placed);
        let farthest = |spheres: &[MedialSphere], from: Vector| {
            let distances = spheres.iter().map(|s| s.center.distance(from));
            distances.fold(0.0, Real::max)
        };
        let arm = farthest(mesh.spheres(), motion1.local_center);
        let [w1, w2] = [motion1, motion2].map(|m| m.angvel.length());
        let v = (motion1.linvel - motion2.linvel).length() + w1 * arm;
        let from_axis = farthest(&spheres[0], motion2.local_center) + v * seconds;
        let acceleration = w1 * w1 * arm + w2 * w2 * from_axis + 2.0 * w2 * v;
        let sizes = poses.map(|p| p.translation.abs().max_element());
        let rounding = ROUNDING_ULPS as Real * Real::EPSILON * (sizes[0] + sizes[1] + arm);
        Some(Self {
            spheres,
            bend: 0.125 * acceleration * seconds * seconds + rounding,
            target,
            sinks,
        })
    }

    /// The normal of a triangle on whose plane the mesh lies, on that side, and whether the triangle is no obstacle.
    pub fn lies_on(&self, [a, b, c]: [Vector; 3]) -> Option<(Vector, bool)> {
        let across = (b - a).cross(c - a).normalize_or_zero();
        // The lowest point of the mesh, unless one is below `least`; of most triangles one of the first spheres is.
        let lowest = |spheres: &[MedialSphere], n: Vector, least: Real| {
            let mut heights = spheres.iter().map(|s| n.dot(s.center - a) - s.radius);
            heights.try_fold(Real::MAX, |low, h| (h >= least).then_some(low.min(h)))
        };
        let sides = [across, -across].into_iter().filter(|n| *n != Vector::ZERO);
        let Sinks { lies, to, by } = self.sinks;
        let on = |n: Vector| {
            let start = lowest(&self.spheres[0], n, -lies).filter(|h| *h <= self.target)?;
            let least = (start.min(0.0) - by).max(-to) + self.bend;
            let slides = start >= least && lowest(&self.spheres[1], n, least).is_some();
            Some((n, slides))
        };
        sides.filter_map(on).next()
    }
}
