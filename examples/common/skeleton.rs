//! Skeletons: segments with a radius at each end, the inner lines of a body. They come from the
//! formulas that made the shapes, not from the colliders under test.

use rapier3d::parry::query::details::closest_points_segment_segment_with_locations_nD;
use rapier3d::parry::shape::SegmentPointLocation;
use rapier3d::prelude::{Pose, Real, Vector};
use rapier3d_medial::MedialMesh;
use std::f32::consts::TAU;

/// Two spheres and all between them: a tapered capsule.
#[derive(Clone, Copy, Debug)]
pub struct Bone {
    /// Centres of the two spheres.
    pub ends: [Vector; 2],
    /// Their radii.
    pub radii: [Real; 2],
}

impl Bone {
    /// Signed distance to the surface, negative inside: the smallest ‖p − c(s)‖ − r(s) over the
    /// spheres between the ends. With k the taper per length, x and y the coordinates of `p` along
    /// and across the axis, the derivative vanishes at s = x − k y / √(1 − k²).
    pub fn signed_distance(&self, p: Vector) -> Real {
        let axis = self.ends[1] - self.ends[0];
        let length = axis.length();
        let k = (self.radii[0] - self.radii[1]) / length;
        let x = (p - self.ends[0]).dot(axis) / length;
        let y = (p - self.ends[0] - axis * (x / length)).length();
        let s = (x - k * y / (1.0 - k * k).sqrt()).clamp(0.0, length);
        let center = self.ends[0] + axis * (s / length);
        p.distance(center) - (self.radii[0] - k * s)
    }

    /// At most the distance from a point to the segment.
    fn gap_to(&self, p: Vector) -> Real {
        let half = (self.ends[1] - self.ends[0]) / 2.0;
        p.distance(self.ends[0] + half) - half.length()
    }

    fn moved(&self, pose: &Pose) -> Self {
        Self {
            ends: self.ends.map(|p| pose.transform_point(p)),
            radii: self.radii,
        }
    }
}

/// The bones of a body, in its frame.
#[derive(Clone, Debug)]
pub struct Skeleton {
    bones: Vec<Bone>,
    /// Distance from the body's origin to the furthest end of a bone.
    reach: Real,
    /// Largest radius.
    thickest: Real,
}

impl Skeleton {
    /// Takes the bones of a body.
    pub fn new(bones: Vec<Bone>) -> Self {
        let ends = bones.iter().flat_map(|b| b.ends);
        let radii = bones.iter().flat_map(|b| b.radii);
        Self {
            reach: ends.map(|p| p.length()).fold(0.0, Real::max),
            thickest: radii.fold(0.0, Real::max),
            bones,
        }
    }

    /// A ring round the y axis: its centre circle as a polygon of `sides`.
    pub fn ring(major: Real, minor: Real, sides: u32) -> Self {
        let corner = |i: u32| {
            let angle = TAU * i as Real / sides as Real;
            Vector::new(major * angle.cos(), 0.0, -major * angle.sin())
        };
        Self::tube(&(0..sides).map(corner).collect::<Vec<_>>(), minor)
    }

    /// A wire of one radius round a closed line.
    pub fn tube(line: &[Vector], radius: Real) -> Self {
        let side = |i| Bone {
            ends: [line[i], line[(i + 1) % line.len()]],
            radii: [radius; 2],
        };
        Self::new((0..line.len()).map(side).collect())
    }

    /// The bones' first ends: the corners of a tube's line.
    pub fn line(&self) -> Vec<Vector> {
        self.bones.iter().map(|bone| bone.ends[0]).collect()
    }

    /// The edges of a medial mesh where their spheres are at least `thinnest` in radius.
    pub fn of_medial(mesh: &MedialMesh, thinnest: Real) -> Self {
        let bone = |edge: &[u32; 2]| {
            let [start, end] = edge.map(|i| mesh.spheres()[i as usize]);
            Bone {
                ends: [start.center, end.center],
                radii: [start.radius, end.radius],
            }
        };
        let bones = mesh.edges().iter().map(bone);
        let thick = |bone: &Bone| bone.radii.iter().all(|r| *r >= thinnest);
        Self::new(bones.filter(thick).collect())
    }

    /// The bones.
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// Largest share of the two radii by which a pair of bones overlaps: 0 for surfaces that touch,
    /// 1 for inner lines that meet; 0 also for bodies that are apart.
    pub fn overlap(&self, pose1: &Pose, other: &Self, pose2: &Pose) -> Real {
        let mut largest: Real = 0.0;
        let radii = self.thickest + other.thickest;
        self.for_each_pair(pose1, other, pose2, radii, |distance, radii| {
            largest = largest.max(1.0 - distance / radii);
        });
        largest
    }

    /// Calls `visit` for each two bones that may be within `limit` of each other, with their
    /// distance and the sum of the radii where they are nearest.
    fn for_each_pair(
        &self,
        pose1: &Pose,
        other: &Self,
        pose2: &Pose,
        limit: Real,
        mut visit: impl FnMut(Real, Real),
    ) {
        let pose12 = pose1.inv_mul(pose2);
        let near1 = |bone: &&Bone| bone.gap_to(pose12.translation) <= other.reach + limit;
        let bones1: Vec<&Bone> = self.bones.iter().filter(near1).collect();
        let moved = other.bones.iter().map(|bone| bone.moved(&pose12));
        for bone2 in moved.filter(|bone| bone.gap_to(Vector::ZERO) <= self.reach + limit) {
            for bone1 in &bones1 {
                let (distance, radii) = segment_distance(bone1, &bone2);
                visit(distance, radii);
            }
        }
    }

    /// Whether the inner lines of two bodies cross while each moves from its first pose to its
    /// second, position and rotation interpolated. Never misses a crossing.
    ///
    /// No point moves further than the path bound, so lines that are further apart than half of it
    /// in the middle of an interval do not meet in it; an interval that fails is halved, until its
    /// paths are shorter than a hundredth of a millimetre (in units of the bodies' metres), or than
    /// what `f32` resolves so far out.
    pub fn crosses(&self, poses1: [Pose; 2], other: &Self, poses2: [Pose; 2]) -> bool {
        let middle1 = poses1[0].lerp(&poses1[1], 0.5);
        let middle2 = poses2[0].lerp(&poses2[1], 0.5);
        let path = path_bound(poses1, self.reach) + path_bound(poses2, other.reach);
        let mut apart = true;
        self.for_each_pair(&middle1, other, &middle2, path / 2.0, |distance, _| {
            apart &= distance > path / 2.0;
        });
        if apart {
            return false;
        }
        let [out1, out2] = [middle1, middle2].map(|pose| pose.translation.length());
        path < 1.0e-5 * (1.0 + out1.max(out2))
            || self.crosses([poses1[0], middle1], other, [poses2[0], middle2])
            || self.crosses([middle1, poses1[1]], other, [middle2, poses2[1]])
    }
}

/// Distance between the segments of two bones, and the sum of the radii where they are nearest.
fn segment_distance(bone1: &Bone, bone2: &Bone) -> (Real, Real) {
    let [[a1, b1], [a2, b2]] = [bone1.ends, bone2.ends];
    let (at1, at2) = closest_points_segment_segment_with_locations_nD((&a1, &b1), (&a2, &b2));
    let nearest = |bone: &Bone, at: SegmentPointLocation| {
        let [share0, share1] = at.barycentric_coordinates();
        (
            bone.ends[0] * share0 + bone.ends[1] * share1,
            bone.radii[0] * share0 + bone.radii[1] * share1,
        )
    };
    let ((p1, r1), (p2, r2)) = (nearest(bone1, at1), nearest(bone2, at2));
    (p1.distance(p2), r1 + r2)
}

/// Upper bound on the path of any point within `reach` of a body's origin, from pose to pose.
fn path_bound(poses: [Pose; 2], reach: Real) -> Real {
    // Not by the angle's cosine: that resolves no turn below half a milliradian.
    let turn = poses[0].rotation.inverse() * poses[1].rotation;
    let turn = 2.0 * turn.xyz().length().atan2(turn.w.abs());
    poses[0].translation.distance(poses[1].translation) + turn * reach
}
