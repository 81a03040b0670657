//! Distance by dense samples: interpolated spheres of each primitive, each measured with parry's point
//! projection. Independent of the casts: no directions, no bounds, no interpolation in time.
//!
//! # Error
//! A sampled sphere is part of the body, so the distance `D'` is never below the true `D`: `D' < 0`
//! proves contact. A point of an edge of length `e` cut in `N` is within `e/2N` of a sample, one of a
//! triangle within `e/(√3 N)` of its longest edge (its covering radius by the corners), and the radius
//! changes by at most the same share of its own slope, so `D' ≤ D + 0.6 (e + |Δr|)/N`: [`Samples::error`].
//! Rounding of parry's projections is in [`ROUNDING`].

use parry3d::math::{Pose, Real, Vector};
use parry3d::query::{NonlinearRigidMotion, PointQuery, ShapeCastHit};
use parry3d::shape::{Shape, SharedShape, TypedShape};
use rapier3d_medial::{MedialMesh, MedialSphere};

/// Error of a projection and of the pose it is seen from, both in `f32`: coordinates are below 8, so
/// that an ulp is 5e-7; parry's iterative projections stop at about 100 of these.
pub const ROUNDING: Real = 1.0e-4;

/// Parts that an edge of the mesh is cut in.
pub const CUTS: usize = 32;

/// The same for the distance at a hit, measured once.
pub const FINE_CUTS: usize = 256;

/// The same for a second mesh: every sphere of one is measured with every one of the other.
pub const COARSE_CUTS: usize = 10;

/// Spheres that fill a mesh.
pub struct Samples {
    /// Per primitive: a ball around it, and its spheres.
    primitives: Vec<(MedialSphere, Vec<MedialSphere>)>,
    /// How far a sampled distance exceeds the true one at most.
    pub error: Real,
}

impl Samples {
    pub fn new(mesh: &MedialMesh, cuts: usize) -> Self {
        let mut error: Real = 0.0;
        let n = cuts as Real;
        let primitives = mesh
            .primitives()
            .map(|p| {
                let s = p.as_slab();
                for (a, b) in [(0, 1), (1, 2), (0, 2)] {
                    let length = (s[a].center - s[b].center).length();
                    error = error.max(0.6 * (length + (s[a].radius - s[b].radius).abs()) / n);
                }
                let rows = if p.spheres().len() > 1 { cuts } else { 0 };
                let columns = if p.spheres().len() > 2 { cuts } else { 0 };
                let mut spheres = Vec::new();
                for i in 0..=rows {
                    for j in 0..=columns.min(rows - i) {
                        let (x, y) = (i as Real / n, j as Real / n);
                        spheres.push(p.interpolate([1.0 - x - y, x, y]));
                    }
                }
                let center = (s[0].center + s[1].center + s[2].center) / 3.0;
                let reach = |s: &MedialSphere| (s.center - center).length() + s.radius;
                let radius = s.iter().map(reach).fold(0.0, Real::max) + ROUNDING;
                (MedialSphere::new(center, radius), spheres)
            })
            .collect();
        Self { primitives, error }
    }

    /// Distance to a set given by its own distance function, exact up to the error where it is below
    /// `limit`.
    pub fn distance(&self, pose: &Pose, limit: Real, apart: &dyn Fn(Vector) -> Real) -> Real {
        let mut least = limit;
        for (ball, spheres) in &self.primitives {
            if apart(pose * ball.center) - ball.radius >= least {
                continue;
            }
            for s in spheres {
                least = least.min(apart(pose * s.center) - s.radius);
            }
        }
        least
    }

    /// Signed distance of a point.
    pub fn distance_to_point(&self, point: Vector) -> Real {
        // Any sphere's distance bounds the least one.
        let spheres = self.primitives.iter().filter_map(|(_, s)| s.first());
        let far = spheres.map(|s| (s.center - point).length() - s.radius);
        let far = far.fold(Real::MAX, Real::min);
        self.distance(&Pose::IDENTITY, far, &|p| (p - point).length())
    }
}

/// Distance of a point to a shape's volume or surface; 0, or minus a border radius, inside.
pub fn apart(shape: &dyn Shape, point: Vector) -> Real {
    let to =
        |inner: &dyn PointQuery, border: Real| inner.distance_to_local_point(point, true) - border;
    match shape.as_typed_shape() {
        TypedShape::RoundTriangle(s) => to(&s.inner_shape, s.border_radius),
        TypedShape::RoundCuboid(s) => to(&s.inner_shape, s.border_radius),
        TypedShape::RoundConvexPolyhedron(s) => to(&s.inner_shape, s.border_radius),
        TypedShape::RoundCylinder(s) => to(&s.inner_shape, s.border_radius),
        TypedShape::RoundCone(s) => to(&s.inner_shape, s.border_radius),
        TypedShape::Compound(c) => c
            .shapes()
            .iter()
            .map(|(pose, s)| apart(s.as_ref(), pose.inverse_transform_point(point)))
            .fold(Real::MAX, Real::min),
        _ => shape.distance_to_local_point(point, true),
    }
}

/// The shape to measure in place of another: voxels, whose own projection is slow, as their cuboids.
pub fn stand_in(shape: &SharedShape) -> SharedShape {
    let Some(voxels) = shape.as_voxels() else {
        return shape.clone();
    };
    let half = voxels.voxel_size() * 0.5;
    let full = voxels.voxels().filter(|v| !v.state.is_empty());
    let cube = |center| {
        let cuboid = SharedShape::cuboid(half.x, half.y, half.z);
        (Pose::from_translation(center), cuboid)
    };
    SharedShape::compound(full.map(|v| cube(v.center)).collect())
}

/// A cast as the oracle sees it.
pub struct Scene<'a> {
    pub samples: &'a Samples,
    /// The same mesh, for the distance at the hit.
    pub fine: &'a Samples,
    pub other: &'a dyn Shape,
    /// The other's samples where it is a medial mesh.
    pub other_samples: Option<&'a Samples>,
    pub motions: [&'a NonlinearRigidMotion; 2],
    pub target: Real,
    pub end: Real,
    pub moments: usize,
}

impl Scene<'_> {
    fn apart(&self, point: Vector) -> Real {
        match self.other_samples {
            Some(s) => s.distance_to_point(point),
            None => apart(self.other, point),
        }
    }

    fn error(&self) -> Real {
        self.fine.error + self.other_samples.map_or(0.0, |s| s.error)
    }

    /// Sampled distance less the target at a time, exact where below `limit`.
    pub fn distance(&self, time: Real, limit: Real) -> Real {
        self.sampled(self.samples, time, limit)
    }

    fn sampled(&self, samples: &Samples, time: Real, limit: Real) -> Real {
        let [pose1, pose2] = self.motions.map(|m| m.position_at_time(time));
        let pose = pose2.inverse() * pose1;
        let far = limit + self.target;
        samples.distance(&pose, far, &|p| self.apart(p)) - self.target
    }

    /// Fails unless a hit (mesh first), or its absence, agrees with the samples. `tolerance` is the
    /// contact distance asked for.
    pub fn judge(&self, hit: Option<&ShapeCastHit>, tolerance: Real) -> Result<(), String> {
        let until = hit.map_or(self.end, |h| h.time_of_impact.min(self.end));
        for k in 0..=self.moments {
            let time = self.end * k as Real / self.moments as Real;
            if time >= until && hit.is_some() {
                break;
            }
            let distance = self.distance(time, 0.0);
            if distance < -ROUNDING {
                return Err(format!("{distance} deep at {time}, but {hit:?}"));
            }
        }
        let Some(hit) = hit else { return Ok(()) };
        let most = tolerance + self.error() + ROUNDING;
        let distance = self.sampled(self.fine, hit.time_of_impact, 1.0);
        if distance > most {
            return Err(format!("{distance} apart, over {most}, at {hit:?}"));
        }
        if hit.time_of_impact > 0.0 {
            self.judge_witness(hit, tolerance)?;
        }
        Ok(())
    }

    fn judge_witness(&self, hit: &ShapeCastHit, tolerance: Real) -> Result<(), String> {
        let [pose1, pose2] = self.motions.map(|m| m.position_at_time(hit.time_of_impact));
        let (n1, n2) = (pose1.rotation * hit.normal1, pose2.rotation * hit.normal2);
        let (w1, w2) = (pose1 * hit.witness1, pose2 * hit.witness2);
        let on1 = self.fine.distance_to_point(hit.witness1);
        let on2 = self.apart(hit.witness2);
        let gap = (w2 - w1).dot(n1) - self.target;
        let off = tolerance + ROUNDING;
        let sound = (n1.length() - 1.0).abs() < 1.0e-4
            && (n1 + n2).length() < 1.0e-4
            && (-off..self.fine.error + off).contains(&on1)
            && on2.abs() < self.error() + off
            && gap.abs() < off
            && (w2 - w1).cross(n1).length() < off * 4.0;
        if sound {
            return Ok(());
        }
        Err(format!(
            "witness: {on1} and {on2} off, {gap} apart, {} aside, normals {n1} {n2}, {hit:?}",
            (w2 - w1).cross(n1).length()
        ))
    }
}
