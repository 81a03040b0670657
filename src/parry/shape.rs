//! [`MedialMesh`] as a shape of parry: rays, points, boxes, mass, and a composite of convex parts for queries that this
//! crate does not answer itself.
//!
//! To rapier it is a custom shape (`TypedShape::Custom`). If it were one of parry's compounds, rapier would sweep
//! its convex parts itself instead of asking this crate's dispatcher, whose answers are certified.

use super::medial_part::MedialPart;
use super::rays;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialPrimitive};
use crate::parry::corrections::outward_normals::OutwardNormals;
use parry3d::bounding_volume::{Aabb, BoundingSphere, BoundingVolume};
use parry3d::mass_properties::MassProperties;
use parry3d::partitioning::Bvh;
use parry3d::query::details::NormalConstraints;
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry3d::shape::{
    Ball, Capsule, CompositeShape, CompositeShapeRef, FeatureId, Shape, ShapeType,
    TypedCompositeShape, TypedShape,
};

impl CompositeShape for MedialMesh {
    fn map_part_at(
        &self,
        shape_id: u32,
        f: &mut dyn FnMut(Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>),
    ) {
        if shape_id as usize >= self.primitive_count() {
            return;
        }
        let outward = match self.takes_any_normals() {
            true => None,
            false => OutwardNormals::of(self, shape_id),
        };
        let normals = outward.as_ref().map(|n| n as &dyn NormalConstraints);
        match self.primitive(shape_id as usize) {
            MedialPrimitive::Sphere(s) => {
                let pose = Pose::from_translation(s.center);
                f(Some(&pose), &Ball::new(s.radius), normals);
            }
            // parry's capsule panics at points that are no numbers where the square of its length is zero.
            MedialPrimitive::Cone([a, b])
                if a.radius == b.radius && a.center.distance_squared(b.center) > 0.0 =>
            {
                f(None, &Capsule::new(a.center, b.center, a.radius), normals);
            }
            primitive => f(None, &MedialPart::new(primitive), normals),
        }
    }

    fn bvh(&self) -> &Bvh {
        MedialMesh::bvh(self)
    }
}

impl TypedCompositeShape for MedialMesh {
    type PartShape = dyn Shape;
    type PartNormalConstraints = dyn NormalConstraints;

    fn map_typed_part_at<T>(
        &self,
        shape_id: u32,
        mut f: impl FnMut(Option<&Pose>, &Self::PartShape, Option<&Self::PartNormalConstraints>) -> T,
    ) -> Option<T> {
        let mut result = None;
        self.map_part_at(shape_id, &mut |pose, part, normals| {
            result = Some(f(pose, part, normals));
        });
        result
    }

    fn map_untyped_part_at<T>(
        &self,
        shape_id: u32,
        f: impl FnMut(Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>) -> T,
    ) -> Option<T> {
        self.map_typed_part_at(shape_id, f)
    }
}

impl RayCast for MedialMesh {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        if !solid && let Some(exit) = rays::exit(self, ray) {
            return (exit.time_of_impact <= max_time_of_impact).then_some(exit);
        }
        CompositeShapeRef(self)
            .cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)
            .map(|(part, mut hit)| {
                // From the centre of parry's ball it is no number.
                if !hit.normal.is_finite() {
                    hit.normal = Vector::ZERO;
                }
                hit.with_subshape(part)
            })
    }
}

impl PointQuery for MedialMesh {
    /// Nearest point of the solid. If the point is inside and `solid` is false, this is the point of the surface that
    /// is reached straight out of the primitive whose surface is nearest. Where primitives overlap, another point of
    /// the surface may be nearer.
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        if !solid && let Some((surface, part)) = rays::surface_point(self, point) {
            return PointProjection::new(true, surface).with_subshape(part);
        }
        CompositeShapeRef(self)
            .project_local_point(point, Real::MAX, solid)
            .map_or(PointProjection::new(false, point), |(part, p)| {
                p.with_subshape(part)
            })
    }
    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Face(0))
    }
}

impl Shape for MedialMesh {
    fn compute_local_aabb(&self) -> Aabb {
        self.aabb()
    }

    fn compute_aabb(&self, position: &Pose) -> Aabb {
        let ball = self.compute_bounding_sphere(position);
        let reach = Vector::splat(ball.radius());
        let boxed = self.aabb().transform_by(position);
        // Both hold the body; so does their intersection.
        Aabb::new(
            boxed.mins.max(ball.center() - reach),
            boxed.maxs.min(ball.center() + reach),
        )
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        let root = &self.tree().nodes()[0];
        BoundingSphere::new(root.center, root.radius)
    }

    /// A box that contains the mesh on its way between two poses, if it turns about its own centre of mass: however it
    /// turns, it stays in a ball around that centre. Two poses do not tell whether it turns about another point, as a
    /// collider with an offset in its body does, or one of several; then the box may be too small on the way. Neither
    /// rapier's step nor this crate calls this.
    fn compute_swept_aabb(&self, start_pos: &Pose, end_pos: &Pose) -> Aabb {
        let com = self.unit_mass_properties().local_com;
        let root = &self.tree().nodes()[0];
        let reach = Vector::splat((root.center - com).length() + root.radius);
        let (from, to) = (start_pos * com, end_pos * com);
        let ball = Aabb::new(from.min(to) - reach, from.max(to) + reach);
        ball.merged(&self.compute_aabb(start_pos))
            .merged(&self.compute_aabb(end_pos))
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// [`MedialMesh::scaled`].
    fn scale_dyn(&self, scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        self.scaled(scale).map(|mesh| Box::new(mesh) as _)
    }

    fn mass_properties(&self, density: Real) -> MassProperties {
        MedialMesh::mass_properties(self, density)
    }
    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }
    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }
    fn ccd_thickness(&self) -> Real {
        self.thickness()
    }
    fn ccd_angular_thickness(&self) -> Real {
        std::f32::consts::FRAC_PI_2
    }
    fn is_convex(&self) -> bool {
        false
    }
    fn as_composite_shape(&self) -> Option<&(dyn CompositeShape + Sync)> {
        Some(self)
    }
    fn feature_normal_at_point(
        &self,
        subshape: u32,
        _feature: FeatureId,
        point: Vector,
    ) -> Option<Vector> {
        if subshape as usize >= self.primitive_count() {
            return None;
        }
        let primitive = self.primitive(subshape as usize);
        let s = primitive.interpolate(primitive.signed_distance(point).weights);
        (point - s.center).try_normalize()
    }
}
