//! Flat faces of a ground over which a mesh slides: triangles, and faces of voxels, cuboids and hulls, in compounds too.
//!
//! A flat ground is cut into triangles, and a body that lies on it is within the contact distance of each that it comes
//! over. Its nearest point is then on an edge in front of the body, with a normal against the motion, and a body
//! stopped there would trip over nothing. It would trip over the edge of a table that it slides off, too: it meets the
//! table's sides from inside. But what stays above a plane crosses no face in it, nor below it, as that of a cliff:
//! such faces are no obstacle, but for a solid's in the plane itself, which are met along its normal. And what sinks in
//! there is thrown back along the plane's normal. For another face on whose own plane the body lies this holds where it
//! faces about the same way as the ground: beside a ledge, with nothing below, a body may meet an edge from any side.
//!
//! Along a chord a height is linear in time, and a path of an acceleration up to `a` is off its chord by `a t² / 8` at most.
//! A point that turns with the mesh by `ω₁` at `r`, seen from a ground that turns by `ω₂`, `d` from its axis, has up to
//! `ω₁² r + ω₂² d + 2 ω₂ v`.

use super::shape_faces::{Face, has_flat_faces};
use crate::math::lane::Vec3;
use crate::math::tolerance::ROUNDING_ULPS;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialSphere};
use parry3d::query::NonlinearRigidMotion;
use parry3d::shape::Shape;

/// How deep a mesh may be in the plane that it slides along, lengths.
#[derive(Clone, Copy, Debug)]
pub struct Sinks {
    /// Deepest at the start, if it is to count as lying on the plane.
    pub lies: Real,
    /// Deepest in the step, if the face is to be no obstacle.
    pub to: Real,
    /// The same, from the depth at the start on; not asked of solids.
    pub by: Real,
}

/// The spheres of a mesh at the start and at the end of a step, in the frame of the ground.
#[derive(Clone, Debug)]
pub struct Sliding {
    spheres: [Vec<(Vec3<f64>, f64)>; 2],
    /// A ball that holds the spheres at the start.
    bound: (Vec3<f64>, f64),
    /// How far paths are off their chords, rounding included, a length.
    bend: f64,
    /// Rounding of places, a length.
    rounding: f64,
    /// Height up to which the mesh counts as lying on a plane, a length: the query's target distance.
    target: f64,
    sinks: Sinks,
    /// Planes of the faces below the mesh on which it lies.
    grounds: Vec<Lying>,
    /// Whether no face of a surface (a mesh, height field or voxel) was looked at: folds are between those only.
    pub is_over_solids: bool,
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
    /// Whether the mesh is near the plane over the face itself, not only beside it.
    is_over: bool,
}

/// Rounding error of the heights of corners over a face, in units of their coordinates: eight ulps. More, and a fin may count
/// as part of the ground that it stands on; less only lets bodies stumble.
const CORNERS: Real = 8.0 * Real::EPSILON;

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

/// Cosine from which two faces face about the same way (60°).
pub const ALIKE: f64 = 0.5;

impl Sliding {
    /// For a mesh over a ground. It counts as lying on a plane up to the distance `target`. `None` for shapes without flat
    /// faces.
    pub fn new(
        (mesh, ground): (&MedialMesh, &dyn Shape),
        [motion1, motion2]: [&NonlinearRigidMotion; 2],
        seconds: Real,
        target: Real,
        sinks: Sinks,
    ) -> Option<Self> {
        if !has_flat_faces(ground) {
            return None;
        }
        let poses = [0.0, seconds].map(|t| {
            let [pose1, pose2] = [motion1, motion2].map(|m| m.position_at_time(t));
            pose2.inverse() * pose1
        });
        let farthest = |pose: &Pose, from: Vector| {
            let distances = mesh.spheres().iter();
            let distances = distances.map(|s| (pose * s.center).distance(from) + s.radius);
            distances.fold(0.0, Real::max)
        };
        let arm = farthest(&Pose::IDENTITY, motion1.local_center);
        let [w1, w2] = [motion1, motion2].map(|m| m.angvel.length());
        let v = (motion1.linvel - motion2.linvel).length() + w1 * arm;
        let from_axis = farthest(&poses[0], motion2.local_center) + v * seconds;
        let acceleration = w1 * w1 * arm + w2 * w2 * from_axis + 2.0 * w2 * v;
        let sizes = poses.map(|p| p.translation.abs().max_element());
        let rounding = ROUNDING_ULPS as Real * Real::EPSILON * (sizes[0] + sizes[1] + arm);
        let middle = poses[0] * mesh.aabb().center();
        let bound = (
            Vec3::from_vector(middle),
            farthest(&poses[0], middle).into(),
        );
        Some(Self {
            spheres: poses.map(|pose| placed(mesh, &pose)),
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
        self.is_over_solids = face.is_of_solid;
        if self.ground_above(face).is_none() {
            self.grounds
                .extend(self.lies_on(face).filter(|l| l.is_over));
        }
    }

    /// How the mesh lies on the plane of a face, or on that of a ground above it, where it can meet the face along the plane's
    /// normal only, or not at all. A ground of a solid stays an obstacle, met along its normal: others are left out for it.
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

    /// The normal of a face's plane, to the side of the mesh, if the mesh lies on it once it is at `pose` in the ground's frame,
    /// and it faces about the same way as a ground on which the mesh lies now. There the mesh comes from a ground up a
    /// slope, and its nearest point is on the fold between the two, straight ahead.
    pub fn comes_to_lie(&self, face: Face, mesh: &MedialMesh, pose: &Pose) -> Option<Vector> {
        let spheres = placed(mesh, pose);
        let there = Self {
            spheres: [spheres.clone(), spheres],
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
        spheres.iter().all(|s| s.radius >= self.sinks.lies)
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
        let corner = |k: usize| Vec3::<f64>::from_vector(face.corners[k]);
        let across = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        let length = across.length();
        if length <= 0.0 {
            return None;
        }
        let across = across * (1.0 / length);
        let sides = if face.is_of_solid {
            &[1.0][..]
        } else {
            &[1.0, -1.0]
        };
        let mut sides = sides.iter();
        sides.find_map(|side| self.lies_on_side(face, across, *side))
    }

    /// The same on one side: that of the normal (1), about which the corners turn to the left, or the other (-1).
    fn lies_on_side(&self, face: Face, across: Vec3<f64>, side: f64) -> Option<Lying> {
        let corners = face.corners;
        let corner = |k: usize| Vec3::<f64>::from_vector(corners[k % corners.len()]);
        let n = across * side;
        let a = corner(0) + n * f64::from(face.border);
        let height = |(center, radius): &(Vec3<f64>, f64)| n.dot(*center - a) - radius;
        // The lowest point of the mesh, unless one is below `least`; of most triangles one of the first spheres is.
        let lowest = |k: usize, least: f64| {
            let mut heights = self.spheres[k].iter().map(height);
            heights.try_fold(f64::MAX, |low, h| (h >= least).then_some(low.min(h)))
        };
        let [lies, to, by] = [self.sinks.lies, self.sinks.to, self.sinks.by].map(f64::from);
        if height(&self.bound) > self.target {
            return None;
        }
        let start = lowest(0, -lies).filter(|h| *h <= self.target)?;
        // A solid's own face stays an obstacle, so that how far the mesh sinks in does not matter for what is below.
        let by = if face.is_of_solid { to } else { by };
        let least = (start.min(0.0) - by).max(-to) + self.bend;
        let is_over = self.spheres[0].iter().any(|sphere| {
            let is_left_of = |k: usize| {
                let along = corner(k + 1) - corner(k);
                let beyond = across.dot(along.cross(sphere.0 - corner(k)));
                beyond >= -sphere.1 * along.length()
            };
            height(sphere) <= self.target && (0..corners.len()).all(is_left_of)
        });
        let coordinates = corners.iter().map(|p| p.abs().max_element());
        Some(Lying {
            normal: n,
            place: a,
            rounding: f64::from(CORNERS * coordinates.fold(0.0, Real::max)),
            slides: start >= least && lowest(1, least).is_some(),
            is_over,
        })
    }
}

/// The spheres of a mesh at a pose.
fn placed(mesh: &MedialMesh, pose: &Pose) -> Vec<(Vec3<f64>, f64)> {
    let place = |s: &MedialSphere| (Vec3::from_vector(pose * s.center), s.radius.into());
    mesh.spheres().iter().map(place).collect()
}
