//! Spheres, medial cones and medial slabs. Source: paper §3, Figure 1(a).
//!
//! A cone is the union of the spheres interpolated between two, a slab between three: centres and
//! radii are interpolated linearly with the same weights. Both are convex: the convex hull of
//! their spheres.

use super::exact::{balls, nearest_to_point};
use crate::math::lane::Vec3;
use crate::math::{Real, Vector};
use parry3d::bounding_volume::Aabb;

/// A medial sphere, or any sphere interpolated between medial spheres.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct MedialSphere {
    /// Centre, in the body's frame, in the user's unit of length.
    pub center: Vector,
    /// Radius, ≥ 0, in the user's unit of length.
    pub radius: Real,
}

impl MedialSphere {
    /// A sphere from its centre and radius.
    pub fn new(center: Vector, radius: Real) -> Self {
        Self { center, radius }
    }
}

/// One convex volume of a medial mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MedialPrimitive {
    /// A sphere that no edge joins.
    Sphere(MedialSphere),
    /// Two spheres interpolated: the paper's `C_ij`.
    Cone([MedialSphere; 2]),
    /// Three spheres interpolated: the paper's `C_ijk`.
    Slab([MedialSphere; 3]),
}

/// Signed distance of a point to a primitive, and the sphere that gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointDistance {
    /// Distance to the nearest interpolated sphere's surface; negative inside. Inside it is the
    /// depth within that sphere, a lower bound of the depth within the primitive.
    pub distance: Real,
    /// Weights of the primitive's spheres that interpolate that sphere; sum 1, unused are 0.
    pub weights: [Real; 3],
}

impl MedialPrimitive {
    /// The spheres that span it: 1, 2 or 3.
    pub fn spheres(&self) -> &[MedialSphere] {
        match self {
            Self::Sphere(s) => std::slice::from_ref(s),
            Self::Cone(s) => s,
            Self::Slab(s) => s,
        }
    }

    /// The three spheres of the slab it degenerates from: a sphere thrice, a cone's end twice.
    pub fn as_slab(&self) -> [MedialSphere; 3] {
        match *self {
            Self::Sphere(s) => [s; 3],
            Self::Cone([a, b]) => [a, b, b],
            Self::Slab(s) => s,
        }
    }

    /// Signed distance of `point` (body frame), computed in double precision.
    pub fn signed_distance(&self, point: Vector) -> PointDistance {
        let nearest = nearest_to_point(&balls(self), Vec3::from_vector(point));
        let (x, y) = (nearest.alpha as Real, nearest.beta as Real);
        let weights = match self {
            Self::Sphere(_) => [1.0, 0.0, 0.0],
            Self::Cone(_) => [1.0 - (x + y), x + y, 0.0],
            Self::Slab(_) => [1.0 - (x + y), x, y],
        };
        PointDistance {
            distance: nearest.distance as Real,
            weights,
        }
    }

    /// The sphere interpolated with these weights.
    pub fn interpolate(&self, weights: [Real; 3]) -> MedialSphere {
        self.spheres()
            .iter()
            .zip(weights)
            .fold(MedialSphere::default(), |sum, (s, weight)| MedialSphere {
                center: sum.center + s.center * weight,
                radius: sum.radius + s.radius * weight,
            })
    }

    /// Axis-aligned box of the volume, in the body's frame.
    pub fn aabb(&self) -> Aabb {
        self.spheres()
            .iter()
            .map(|s| {
                Aabb::new(
                    s.center - Vector::splat(s.radius),
                    s.center + Vector::splat(s.radius),
                )
            })
            .reduce(|a, b| Aabb::new(a.mins.min(b.mins), a.maxs.max(b.maxs)))
            .unwrap_or(Aabb::new_invalid())
    }
}
