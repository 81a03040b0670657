//! Cones and slabs as convex shapes of parry: support map, support feature, ray cast, projection. With them every query
//! and contact manifold of parry works between a medial mesh and any shape.
//!
//! The smallest radius of a part becomes a border, as in parry's rounded shapes, and what remains is the core: parry's
//! manifold code runs on the core and adds the border. A support feature in a direction is the facet of the convex hull
//! of the core's spheres that is tangent there: a triangle on a slab's flat side, a segment along a cone. Its
//! normal `n` satisfies `n·(c_j − c_i) = r_i − r_j` along the facet, as in [`crate::math::nearest`].

use super::rays;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialPrimitive, MedialSphere};
use parry3d::bounding_volume::{Aabb, BoundingSphere};
use parry3d::mass_properties::MassProperties;
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry3d::shape::{
    FeatureId, PackedFeatureId, PolygonalFeature, PolygonalFeatureMap, Segment, Shape, ShapeType,
    SupportMap, Triangle, TypedShape,
};

/// Cosine between the direction asked for and a slab's flat side above which that side is the
/// support feature (45°); below it, an edge is.
const FLAT_SIDE: Real = 0.7;

/// The convex hull of 1 to 3 spheres, as a parry shape.
#[derive(Clone, Debug)]
pub struct MedialPart {
    core: Core,
    border: Real,
    primitive: MedialPrimitive,
}

/// The hull of the spheres with the border taken off.
#[derive(Clone, Debug)]
pub struct Core {
    spheres: [MedialSphere; 3],
    len: usize,
}

impl MedialPart {
    /// The part of one primitive, in the body's frame.
    pub fn new(primitive: MedialPrimitive) -> Self {
        let len = primitive.spheres().len();
        let border = primitive
            .spheres()
            .iter()
            .map(|s| s.radius)
            .fold(Real::MAX, Real::min);
        let spheres = primitive
            .as_slab()
            .map(|s| MedialSphere::new(s.center, s.radius - border));
        Self {
            core: Core { spheres, len },
            border,
            primitive,
        }
    }
}

impl Core {
    fn spheres(&self) -> &[MedialSphere] {
        &self.spheres[..self.len]
    }

    /// Height of a sphere's far point along a unit direction.
    fn height(s: &MedialSphere, n: Vector) -> Real {
        s.center.dot(n) + s.radius
    }

    fn support(&self, n: Vector) -> Vector {
        let best = self.spheres().iter().copied().reduce(|a, b| {
            if Self::height(&b, n) > Self::height(&a, n) {
                b
            } else {
                a
            }
        });
        best.map_or(Vector::ZERO, |s| s.center + n * s.radius)
    }

    /// Normal of the slab's tangent plane on the side of `dir`, if there is one.
    fn flat_normal(&self, dir: Vector) -> Option<Vector> {
        let [a, b, c] = &self.spheres;
        let (u, v) = (b.center - a.center, c.center - a.center);
        let normal = u.cross(v);
        let area_sq = normal.length_squared();
        if self.len < 3 || area_sq <= 1.0e-12 * u.length_squared() * v.length_squared() {
            return None;
        }
        let (du, dv) = (a.radius - b.radius, a.radius - c.radius);
        let g = (v.cross(normal) * du + normal.cross(u) * dv) / area_sq;
        let height_sq = 1.0 - g.length_squared();
        let side = if normal.dot(dir) < 0.0 {
            -normal
        } else {
            normal
        };
        (height_sq > 0.0).then(|| g + side * (height_sq / area_sq).sqrt())
    }

    /// Tangent segment of the cone between two spheres, in the half plane of `dir`.
    fn tangent_segment(a: &MedialSphere, b: &MedialSphere, dir: Vector) -> Segment {
        let along = b.center - a.center;
        let length = along.length();
        if length <= (a.radius - b.radius).abs() {
            // One contains the other: no flank, a point.
            let s = if a.radius >= b.radius { a } else { b };
            let p = s.center + dir * s.radius;
            return Segment::new(p, p);
        }
        let axis = along / length;
        let sine = (a.radius - b.radius) / length;
        let flank = (dir - axis * dir.dot(axis))
            .try_normalize()
            .unwrap_or_else(|| axis.any_orthonormal_vector());
        let n = flank * (1.0 - sine * sine).max(0.0).sqrt() + axis * sine;
        Segment::new(a.center + n * a.radius, b.center + n * b.radius)
    }
}

impl SupportMap for Core {
    fn local_support_point(&self, dir: Vector) -> Vector {
        self.support(dir.try_normalize().unwrap_or(Vector::Y))
    }
    fn local_support_point_toward(&self, dir: Vector) -> Vector {
        self.support(dir)
    }
}

impl PolygonalFeatureMap for Core {
    fn local_support_feature(&self, dir: Vector, out: &mut PolygonalFeature) {
        let [a, b, c] = &self.spheres;
        if let Some(n) = self.flat_normal(dir).filter(|n| n.dot(dir) > FLAT_SIDE) {
            let corner = |s: &MedialSphere| s.center + n * s.radius;
            *out = PolygonalFeature::from(Triangle::new(corner(a), corner(b), corner(c)));
            return;
        }
        // The edge that reaches furthest along `dir`: all but the lowest sphere, in index order.
        let lowest = (0..3)
            .min_by(|&i, &j| {
                let [x, y] = [i, j].map(|k| Self::height(&self.spheres[k], dir));
                x.total_cmp(&y)
            })
            .unwrap_or(2);
        let (i, j) = match (self.len, lowest) {
            (3, 0) => (1, 2),
            (3, 1) => (0, 2),
            (1, _) => (0, 0),
            _ => (0, 1),
        };
        let segment = Self::tangent_segment(&self.spheres[i], &self.spheres[j], dir);
        *out = PolygonalFeature::from(segment);
        let (i, j) = (i as u32, j as u32);
        out.vids = [i, j, j, j].map(PackedFeatureId::vertex);
        out.eids = [PackedFeatureId::edge(i + j); 4];
    }
}

impl SupportMap for MedialPart {
    fn local_support_point(&self, dir: Vector) -> Vector {
        self.local_support_point_toward(dir.try_normalize().unwrap_or(Vector::Y))
    }
    fn local_support_point_toward(&self, dir: Vector) -> Vector {
        self.core.support(dir) + dir * self.border
    }
}

impl RayCast for MedialPart {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        rays::enter(&self.primitive, ray, max_time_of_impact, solid)
    }
}

impl PointQuery for MedialPart {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let nearest = self.primitive.signed_distance(point);
        let inside = nearest.distance <= 0.0;
        if inside && solid {
            return PointProjection::new(true, point);
        }
        let s = self.primitive.interpolate(nearest.weights);
        let n = (point - s.center).try_normalize().unwrap_or_else(|| {
            // On the medial surface itself: any tangent facet is nearest.
            self.core.flat_normal(Vector::Y).unwrap_or_else(|| {
                let [a, b, _] = &self.core.spheres;
                (b.center - a.center)
                    .try_normalize()
                    .map_or(Vector::Y, |axis| axis.any_orthonormal_vector())
            })
        });
        PointProjection::new(inside, s.center + n * s.radius)
    }
    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Face(0))
    }
}

impl Shape for MedialPart {
    fn compute_local_aabb(&self) -> Aabb {
        self.primitive.aabb()
    }
    fn compute_aabb(&self, position: &Pose) -> Aabb {
        let moved = |s: MedialSphere| MedialSphere::new(position * s.center, s.radius);
        MedialPrimitive::Slab(self.primitive.as_slab().map(moved)).aabb()
    }
    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        let aabb = self.primitive.aabb();
        BoundingSphere::new(aabb.center(), aabb.half_extents().length())
    }
    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }
    fn scale_dyn(&self, scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        let factor = crate::medial::scaled::uniform_factor(scale)?;
        let scaled = |s: MedialSphere| MedialSphere::new(s.center * scale, s.radius * factor);
        let primitive = match self.primitive {
            MedialPrimitive::Sphere(s) => MedialPrimitive::Sphere(scaled(s)),
            MedialPrimitive::Cone(s) => MedialPrimitive::Cone(s.map(scaled)),
            MedialPrimitive::Slab(s) => MedialPrimitive::Slab(s.map(scaled)),
        };
        Some(Box::new(Self::new(primitive)))
    }
    /// Mass properties of the ball around the core's first sphere: parts are never colliders of their own; the mesh's
    /// mass is [`crate::MedialMesh::mass_properties`].
    fn mass_properties(&self, density: Real) -> MassProperties {
        MassProperties::from_ball(density, self.border)
    }
    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }
    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }
    fn ccd_thickness(&self) -> Real {
        self.border
    }
    fn ccd_angular_thickness(&self) -> Real {
        std::f32::consts::FRAC_PI_2
    }
    fn is_convex(&self) -> bool {
        true
    }
    fn as_support_map(&self) -> Option<&dyn SupportMap> {
        Some(self)
    }
    fn as_polygonal_feature_map(&self) -> Option<(&dyn PolygonalFeatureMap, Real)> {
        Some((&self.core, self.border))
    }
}
