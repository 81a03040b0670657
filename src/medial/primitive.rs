//! The primitives of a medial mesh: spheres, medial cones and medial slabs. Source: paper §3, Figure 1(a).
//!
//! A cone is the union of all spheres interpolated between two given ones, a slab of those between three:
//! centres and radii are interpolated linearly with the same weights. Both are the convex hull of the
//! given spheres.

use super::exact::{balls, nearest_to_point};
use super::sphere::MedialSphere;
use crate::math::lane::Vec3;
use crate::math::{Real, Vector};
use parry3d::bounding_volume::Aabb;

/// One convex part of a medial mesh: the convex hull of one, two or three spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MedialPrimitive {
    /// A sphere without an edge.
    Sphere(MedialSphere),
    /// A medial cone: all spheres interpolated between two (the paper's `C_ij`).
    Cone([MedialSphere; 2]),
    /// A medial slab: all spheres interpolated between three (the paper's `C_ijk`).
    Slab([MedialSphere; 3]),
}

/// Signed distance of a point to a primitive, and which interpolated sphere is nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointDistance {
    /// Distance to the surface of the nearest interpolated sphere, a length, negative inside. The depth of a point
    /// inside is that within the sphere, which is at most the depth within the primitive.
    pub distance: Real,
    /// Weights with which the primitive's spheres interpolate that sphere. They sum to 1; weights of spheres that
    /// the primitive does not have are 0.
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

    /// The primitive as three spheres: those of a slab, a cone with its second sphere repeated, or the same
    /// sphere three times.
    pub fn as_slab(&self) -> [MedialSphere; 3] {
        match *self {
            Self::Sphere(s) => [s; 3],
            Self::Cone([a, b]) => [a, b, b],
            Self::Slab(s) => s,
        }
    }

    /// Signed distance of `point`, in the body's frame, computed in double precision.
    pub fn signed_distance(&self, point: Vector) -> PointDistance {
        let nearest = nearest_to_point(&balls(self.as_slab()), Vec3::from_vector(point));
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

    /// The sphere interpolated with these weights, one for each of [`Self::spheres`].
    pub fn interpolate(&self, weights: [Real; 3]) -> MedialSphere {
        self.spheres()
            .iter()
            .zip(weights)
            .fold(MedialSphere::default(), |sum, (s, weight)| MedialSphere {
                center: sum.center + s.center * weight,
                radius: sum.radius + s.radius * weight,
            })
    }

    /// Axis-aligned bounding box, in the body's frame.
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
