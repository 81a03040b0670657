//! Flat faces of a ground over which a mesh slides: triangles, and faces of voxels, cuboids and hulls, in compounds
//! too.
//!
//! A flat ground is cut into triangles, and a body that lies on it is within the contact distance of each that it comes
//! over. Its nearest point is then on an edge in front of the body, with a normal against the motion, and a body
//! stopped there would trip over nothing. It would trip over the edge of a table that it slides off, too: it meets the
//! table's sides from inside. But what stays above a plane crosses no face in it, nor below it, as that of a cliff:
//! such faces are no obstacle, but for a solid's in the plane itself, which are met along its normal. And what sinks in
//! there is thrown back along the plane's normal. For another face on whose own plane the body lies this holds where it
//! faces about the same way as the ground: beside a ledge, with nothing below, a body may meet an edge from any side.
//!
//! Along a chord a height is linear in time, and a path of an acceleration up to `a` is off its chord by `a t² / 8` at
//! most. A point that turns with the mesh by `ω₁` at `r`, seen from a ground that turns by `ω₂`, `d` from its axis, has
//! up to `ω₁² r + ω₂² d + 2 ω₂ v`.

use super::clipped_part::{is_beside, spheres_below, within};
use crate::math::lane::Vec3;
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialSphere};
use crate::parry::partners::shape_faces::{Face, has_flat_faces};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::query::NonlinearRigidMotion;
use parry3d::shape::Shape;
use std::borrow::Cow;

/// How deep a mesh may be in the plane that it slides along, lengths.
#[derive(Clone, Copy, Debug)]
pub struct SinkLimits {
    /// Depth at the start up to which the mesh counts as lying on the plane.
    pub at_start: Real,
    /// A face is no obstacle only if the mesh gets no deeper in its plane than this within the step.
    pub at_most: Real,
    /// A face is no obstacle only if the mesh sinks in its plane by no more than this within the step. Not asked of
    /// faces of solids.
    pub change: Real,
}

/// A mesh at the start and at the end of a step, in the frame of the ground.
#[derive(Clone, Debug)]
pub struct Sliding<'a> {
    mesh: &'a MedialMesh,
    /// Spheres whose hulls hold all of the mesh that can get to the ground.
    spheres: Cow<'a, [MedialSphere]>,
    poses: [PlacedFrame; 2],
    /// A ball that holds the mesh at the start.
    bound: (Vec3<f64>, f64),
    /// How far paths are off their chords, rounding included, a length.
    bend: f64,
    /// Rounding of places, a length.
    rounding: f64,
    /// Height up to which the mesh counts as lying on a plane, a length: the query's target distance.
    target: f64,
    sinks: SinkLimits,
    /// Planes of the faces below the mesh on which it lies.
    grounds: Vec<Lying>,
    /// Whether only faces of solids were looked at. Folds are between faces of a surface (a mesh, height field or
    /// voxels).
    pub is_over_solids: bool,
}

/// The frame of the mesh in that of the ground.
#[derive(Clone, Copy, Debug)]
struct PlacedFrame {
    /// Columns of its rotation.
    columns: [Vec3<f64>; 3],
    origin: Vec3<f64>,
}

impl PlacedFrame {
    fn new(pose: &Pose) -> Self {
        let columns = [Vector::X, Vector::Y, Vector::Z];
        Self {
            columns: columns.map(|axis| Vec3::from_vector(pose.rotation * axis)),
            origin: Vec3::from_vector(pose.translation),
        }
    }

    /// Where a point of the mesh's frame is.
    fn place(&self, p: Vector) -> Vec3<f64> {
        let ([x, y, z], p) = (self.columns, Vec3::<f64>::from_vector(p));
        x * p.x + y * p.y + z * p.z + self.origin
    }

    /// A place of the ground's frame in the mesh's.
    fn local(&self, place: Vec3<f64>) -> Vector {
        let way = place - self.origin;
        let [x, y, z] = self.columns.map(|column| column.dot(way) as Real);
        Vector::new(x, y, z)
    }

    /// Height of points of the mesh's frame over a place of the ground's, along `n`.
    fn heights(&self, n: Vec3<f64>, place: Vec3<f64>) -> impl Fn(Vector) -> f64 + use<> {
        let [x, y, z] = self.columns.map(|column| column.dot(n));
        let (n, offset) = (Vec3::new(x, y, z), n.dot(self.origin - place));
        move |p| n.dot(Vec3::from_vector(p)) + offset
    }
}

/// How a mesh lies on the plane of a face.
#[derive(Clone, Copy, Debug)]
pub struct Lying {
    /// Unit normal, to the side of the mesh.
    pub normal: Vec3<f64>,
    /// A point of the plane.
    place: Vec3<f64>,
    /// Rounding of the face's corners, a length.
    rounding: f64,
    /// Whether what is in the plane or below it is no obstacle; of a solid what is below.
    pub slides: bool,
}

/// Rounding error of the heights of corners over a face, in units of their coordinates: eight ulps. More, and a fin may
/// count as part of the ground that it stands on; less only lets bodies stumble.
const CORNER_ROUNDING: Real = 8.0 * Real::EPSILON;

impl Lying {
    /// Whether a face that is in the plane or below it is in the plane, rounding apart.
    fn is_in_plane(&self, face: Face) -> bool {
        let height = |p: &Vector| self.normal.dot(Vec3::from_vector(*p) - self.place);
        let least = -self.rounding - f64::from(face.border);
        face.corners.iter().all(|p| height(p) >= least)
    }

    /// Whether a ball is in the plane or below it, rounding apart.
    fn is_above(&self, center: Vector, radius: Real) -> bool {
        let way = Vec3::from_vector(center) - self.place;
        self.normal.dot(way) + f64::from(radius) <= self.rounding
    }
}

/// The unit normal of a face about which its corners turn to the left; `None` of a face without area.
fn unit_normal(face: Face) -> Option<Vec3<f64>> {
    let corner = |k: usize| Vec3::<f64>::from_vector(face.corners[k]);
    let across = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    let length = across.length();
    (length > 0.0).then(|| across * (1.0 / length))
}

/// Cosine from which two faces face about the same way (60°).
pub const ALIKE: f64 = 0.5;

impl<'a> Sliding<'a> {
    /// For a mesh over a ground. It counts as lying on a plane up to the distance `target`. `None` for shapes without
    /// flat faces.
    pub fn new(
        (mesh, ground): (&'a MedialMesh, &dyn Shape),
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        seconds: Real,
        target: Real,
        sinks: SinkLimits,
    ) -> Option<Self> {
        if !has_flat_faces(ground) {
            return None;
        }
        let poses = [0.0, seconds].map(|t| {
            let [pose1, pose2] = [motion1, motion2].map(|m| m.position_at_time(t));
            pose2.inverse() * pose1
        });
        let ball = mesh.compute_local_bounding_sphere();
        let farthest = |pose: &Pose, from, spheres: &[MedialSphere]| {
            let far = spheres
                .iter()
                .map(|s| (pose * s.center).distance(from) + s.radius);
            far.fold(0.0, Real::max)
        };
        let whole = [MedialSphere::new(ball.center, ball.radius)];
        let [w1, w2] = [motion1, motion2].map(|m| m.angvel.length());
        let travel = |spheres: &[MedialSphere]| {
            let arm = farthest(&Pose::IDENTITY, motion1.local_center, spheres);
            let v = (motion1.linvel - motion2.linvel).length() + w1 * arm;
            let from_axis = farthest(&poses[0], motion2.local_center, spheres) + v * seconds;
            [arm, v, from_axis]
        };
        let [_, v, from_axis] = travel(&whole);
        let margin = target + (v + w2 * from_axis) * seconds;
        let aabb = ground.compute_local_aabb().loosened(margin);
        let spheres = match aabb.contains(&Aabb::from_half_extents(
            poses[0] * ball.center,
            Vector::splat(ball.radius),
        )) {
            true => Cow::Borrowed(mesh.spheres()),
            false => Cow::Owned(within(mesh, &poses[0], &aabb)),
        };
        let [arm, v, from_axis] = match spheres {
            Cow::Borrowed(_) => travel(&whole),
            Cow::Owned(_) => travel(&spheres),
        };
        let acceleration = w1 * w1 * arm + w2 * w2 * from_axis + 2.0 * w2 * v;
        let sizes = poses.map(|p| p.translation.abs().max_element());
        let rounding = REAL_ROUNDING * (sizes[0] + sizes[1] + arm);
        let bound = (
            Vec3::from_vector(poses[0] * ball.center),
            (ball.radius + rounding).into(),
        );
        Some(Self {
            mesh,
            spheres,
            poses: poses.map(|pose| PlacedFrame::new(&pose)),
            bound,
            bend: (0.125 * acceleration * seconds * seconds + rounding).into(),
            rounding: rounding.into(),
            target: target.into(),
            sinks,
            grounds: Vec::new(),
            is_over_solids: true,
        })
    }

    /// Remembers a face if it is a ground of the mesh. All faces have to be looked at before [`Self::treats`].
    pub fn look(&mut self, face: Face) {
        self.is_over_solids &= face.is_of_solid;
        if self.ground_above(face).is_none() {
            self.grounds
                .extend(self.lies_on(face).filter(|l| self.is_over(face, l)));
        }
    }

    /// How the mesh lies on the plane of a face, or on that of a ground above it, where it can meet the face along the
    /// plane's normal only, or not at all. A ground of a solid stays an obstacle, met along its normal: others are left
    /// out for it.
    pub fn treats(&self, face: Face) -> Option<Lying> {
        let Some(ground) = self.ground_above(face) else {
            let lying = self.lies_on(face);
            return lying.filter(|l| l.slides || self.is_like_a_ground(l));
        };
        let is_ground = face.is_of_solid && ground.is_in_plane(face);
        Some(Lying {
            slides: ground.slides && !is_ground,
            ..*ground
        })
    }

    fn is_like_a_ground(&self, lying: &Lying) -> bool {
        let is_alike = |g: &Lying| g.normal.dot(lying.normal) > ALIKE;
        self.grounds.iter().any(is_alike)
    }

    /// The normal of a face's plane, to the side of the mesh, if the mesh lies on it once it is at `pose` in the
    /// ground's frame, and it faces about the same way as a ground on which the mesh lies now. There the mesh comes
    /// from a ground up a slope, and its nearest point is on the fold between the two, straight ahead.
    pub fn comes_to_lie(&self, face: Face, pose: &Pose) -> Option<Vector> {
        let there = Self {
            spheres: self.spheres.clone(),
            poses: [PlacedFrame::new(pose); 2],
            bound: (self.bound.0, f64::MAX),
            bend: self.rounding,
            grounds: Vec::new(),
            ..*self
        };
        let lying = there.lies_on(face)?;
        self.is_like_a_ground(&lying)
            .then(|| lying.normal.to_vector())
    }

    /// Whether the centres of spheres stay above a plane on which they lie.
    pub fn keeps_above(&self, spheres: &[MedialSphere]) -> bool {
        spheres.iter().all(|s| s.radius >= self.sinks.at_start)
    }

    /// A ground in or below whose plane a face is, one along which the mesh slides if there is one.
    fn ground_above(&self, face: Face) -> Option<&Lying> {
        let is_below = |p: &Vector, g: &Lying| g.is_above(*p, face.border);
        let above = self.grounds.iter();
        let above = above.filter(|g| face.corners.iter().all(|p| is_below(p, g)));
        above.max_by_key(|g| g.slides)
    }

    /// How the mesh lies on the plane of a face, if it does. The face is convex.
    fn lies_on(&self, face: Face) -> Option<Lying> {
        let across = unit_normal(face)?;
        let sides = if face.is_of_solid {
            &[1.0][..]
        } else {
            &[1.0, -1.0]
        };
        let mut sides = sides.iter();
        sides.find_map(|side| self.lies_on_side(face, across, *side))
    }

    /// How the mesh lies on one side of a face, if it does: the side of the normal (1), about which the corners turn to
    /// the left, or the other (-1).
    fn lies_on_side(&self, face: Face, across: Vec3<f64>, side: f64) -> Option<Lying> {
        let corners = face.corners;
        let n = across * side;
        let a = Vec3::from_vector(corners[0]) + n * f64::from(face.border);
        // The lowest point of the mesh, unless one is below `least`; of most triangles one of the first spheres is.
        let spheres = self.spheres.iter();
        let height = self.poses.map(|pose| pose.heights(n, a));
        let lowest = |k: usize, least: f64| {
            let mut heights = spheres
                .clone()
                .map(|s| height[k](s.center) - f64::from(s.radius));
            heights.try_fold(f64::MAX, |low, h| (h >= least).then_some(low.min(h)))
        };
        let [lies, to, by] =
            [self.sinks.at_start, self.sinks.at_most, self.sinks.change].map(f64::from);
        let (center, radius) = self.bound;
        if n.dot(center - a) - radius > self.target {
            return None;
        }
        let start = lowest(0, -lies).filter(|h| *h <= self.target)?;
        // A solid's own face stays an obstacle, so that how far the mesh sinks in does not matter for what is below.
        let by = if face.is_of_solid { to } else { by };
        let least = (start.min(0.0) - by).max(-to) + self.bend;
        let coordinates = corners.iter().map(|p| p.abs().max_element());
        Some(Lying {
            normal: n,
            place: a,
            rounding: f64::from(CORNER_ROUNDING * coordinates.fold(0.0, Real::max)),
            slides: start >= least && lowest(1, least).is_some(),
        })
    }

    /// Whether the mesh, which lies on the plane of a face, is near the plane over the face itself, not only beside it.
    fn is_over(&self, face: Face, lying: &Lying) -> bool {
        let Some(across) = unit_normal(face) else {
            return false;
        };
        let pose = &self.poses[0];
        let corners: Vec<Vec3<f64>> = face.corners.iter().map(|p| Vec3::from_vector(*p)).collect();
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        let sides: Vec<_> = sides
            .map(|(a, b)| {
                let along = *b - *a;
                (pose.heights(across.cross(along), *a), along.length())
            })
            .collect();
        let height = pose.heights(lying.normal, lying.place);
        let above = |s: &MedialSphere| height(s.center) - f64::from(s.radius) - self.target;
        let is_within = |s: &MedialSphere| {
            let radius = f64::from(s.radius);
            let mut sides = sides.iter();
            sides.all(|(inward, l)| inward(s.center) >= -radius * l)
        };
        let mut spheres = self.spheres.iter();
        if spheres.any(|s| above(s) <= 0.0 && is_within(s)) {
            return true;
        }
        let local = corners.iter().map(|p| pose.local(*p)).collect::<Vec<_>>();
        let margin = self.target as Real + self.sinks.at_start + face.border;
        let around = Aabb::from_points(local).loosened(margin);
        let mut near = self.mesh.bvh().intersect_aabb(&around);
        near.any(|primitive| {
            let primitive = self.mesh.primitive(primitive as usize);
            let low = spheres_below(primitive.spheres(), above);
            let mut sides = sides.iter();
            let places = low.iter().map(|s| pose.place(s.center));
            !low.is_empty()
                && sides.all(|(inward, _)| low.iter().any(|s| inward(s.center) >= 0.0))
                && !is_beside(&places.collect::<Vec<_>>(), &corners, lying.normal)
        })
    }
}
