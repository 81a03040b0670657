//! Ray casts: the point where a ray enters a medial primitive, and where a ray or a point inside a medial mesh leaves
//! it. What counts is leaving the whole solid, not one of the primitives, which overlap.
//!
//! Every primitive is convex, so a ray is inside it on one stretch ([`crate::medial::chord`], in closed form). The ray
//! leaves the solid at the end of the stretches that follow from the start without a gap. parry's iteration for convex
//! shapes, which would serve as well, is off by a few thousandths of the size on flat faces.

use crate::elementary::penetration::LOST;
use crate::math::lane::Vec3;
use crate::math::sphere::Ball;
use crate::math::{Real, Vector};
use crate::medial::chord::ChordSolver;
use crate::medial::exact;
use crate::medial::{MedialMesh, MedialPrimitive};
use parry3d::bounding_volume::Aabb;
use parry3d::query::{Ray, RayIntersection};
use parry3d::shape::FeatureId;

/// The point where a ray that starts inside the mesh leaves it; `None` if it starts outside. The normal points back
/// inside, as in parry, and the time is in units of the length of the ray's direction.
pub fn exit(mesh: &MedialMesh, ray: &Ray) -> Option<RayIntersection> {
    if !holds(mesh, ray.origin) {
        return None;
    }
    let length = f64::from(ray.dir.length());
    let mut stretches = stretches(mesh, ray);
    stretches.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut end: Option<Stretch> = None;
    for s in stretches {
        if s.from > end.as_ref().map_or(0.0, |e| e.to) {
            break;
        }
        if s.to > end.as_ref().map_or(0.0, |e| e.to) {
            end = Some(s);
        }
    }
    let Stretch { to, primitive, .. } = end?;
    let time = (to / length) as Real;
    let part = mesh.primitive(primitive as usize);
    let balls = exact::balls(part.as_slab());
    let [at, along] = [ray.point_at(time), ray.dir].map(Vec3::from_vector);
    let normal = -way_out(&balls, at, along).to_vector();
    Some(RayIntersection::new(time, normal, FeatureId::Face(0)).with_subshape(primitive))
}

/// A point of the surface near a point inside the mesh, and its primitive: the way leads straight out of the primitive
/// whose surface is nearest, as far as the union reaches. `None` for a point outside.
pub fn surface_point(mesh: &MedialMesh, point: Vector) -> Option<(Vector, u32)> {
    let inside = |i: &u32| mesh.primitive(*i as usize).signed_distance(point).distance <= 0.0;
    let ways = holding(mesh, point).filter(inside).filter_map(|i| {
        let balls = exact::balls(mesh.primitive(i as usize).as_slab());
        let out = way_out(&balls, Vec3::from_vector(point), Vec3::zero());
        let ray = Ray::new(point, out.to_vector());
        let hit = exit(mesh, &ray)?;
        Some((
            hit.time_of_impact,
            ray.point_at(hit.time_of_impact),
            hit.subshape,
        ))
    });
    let nearest = ways.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((nearest.1, nearest.2))
}

/// Unit direction straight out of a primitive from a point in it: away from the centre of the nearest sphere. Where the
/// point is that centre, to rounding, it is across a plane that touches the sphere and its neighbours, which on a sharp
/// rim or at a tip passes through the point; of several such planes it is one that faces `along` more.
fn way_out(balls: &[Ball; 3], point: Vec3<f64>, along: Vec3<f64>) -> Vec3<f64> {
    let nearest = exact::nearest_to_point(balls, point);
    let out = -nearest.y;
    let [a, b, c] = balls.map(|ball| ball.center);
    let size = (b - a).length().max((c - a).length());
    if out.length() > LOST * size {
        return out * (1.0 / out.length());
    }
    let of_slab = exact::tangent_normals(balls);
    let of_slab = of_slab.map(|[a, b]| if b.dot(along) > a.dot(along) { b } else { a });
    // A slab without such planes is the cones of its edges: that on which the point is.
    let weights = [
        1.0 - nearest.alpha - nearest.beta,
        nearest.alpha,
        nearest.beta,
    ];
    let mut without = [2, 0, 1];
    without.sort_by(|i: &usize, j| weights[*i].total_cmp(&weights[*j]));
    let of_cone = |k: usize| {
        let [near, far] = [balls[(k + 1) % 3], balls[(k + 2) % 3]];
        let normal = exact::cone_normal([near, far], along)?;
        let reach = |ball: Ball| normal.dot(ball.center) + ball.radius;
        (reach(balls[k]) <= reach(near) + LOST * size).then_some(normal)
    };
    of_slab
        .or_else(|| without.into_iter().find_map(of_cone))
        // A point alone is left any way.
        .unwrap_or_else(|| match along.length() > 0.0 {
            true => along * (1.0 / along.length()),
            false => Vec3::new(0.0, 1.0, 0.0),
        })
}

fn holds(mesh: &MedialMesh, point: Vector) -> bool {
    holding(mesh, point).any(|i| mesh.primitive(i as usize).signed_distance(point).distance <= 0.0)
}

/// Primitives whose boxes hold a point.
fn holding(mesh: &MedialMesh, point: Vector) -> impl Iterator<Item = u32> + '_ {
    let at = Aabb::new(point, point);
    mesh.bvh()
        .intersect_aabb(&at)
        .collect::<Vec<_>>()
        .into_iter()
}

/// Stretch of the ray inside a primitive: lengths from its origin.
struct Stretch {
    from: f64,
    to: f64,
    primitive: u32,
}

fn stretches(mesh: &MedialMesh, ray: &Ray) -> Vec<Stretch> {
    let Some(frame) = RayFrame::new(ray) else {
        return Vec::new();
    };
    let met = |node: &parry3d::partitioning::BvhNode| node.cast_ray(ray, Real::MAX) < Real::MAX;
    mesh.bvh()
        .leaves(met)
        .filter_map(|primitive| {
            let balls = frame.seen(&mesh.primitive(primitive as usize));
            let [from, to] = ChordSolver::new(balls).chord(0.0, 0.0)?;
            Some(Stretch {
                from,
                to,
                primitive,
            })
        })
        .collect()
}

/// The frame of a ray: its origin, and its direction as the z-axis.
struct RayFrame {
    origin: Vec3<f64>,
    axes: [Vec3<f64>; 3],
}

impl RayFrame {
    /// `None` for a ray without direction.
    fn new(ray: &Ray) -> Option<Self> {
        let along = ray.dir.try_normalize()?;
        let z = Vec3::<f64>::from_vector(along);
        let z = z * (1.0 / z.length());
        let across = Vec3::<f64>::from_vector(along.any_orthonormal_vector());
        let x = across - z * across.dot(z);
        let x = x * (1.0 / x.length());
        Some(Self {
            origin: Vec3::from_vector(ray.origin),
            axes: [x, z.cross(x), z],
        })
    }

    /// A direction of this frame as a unit vector in the body's.
    fn unit(&self, v: Vec3<f64>) -> Vec3<f64> {
        let [x, y, z] = self.axes;
        (x * v.x + y * v.y + z * v.z) * (1.0 / v.length())
    }

    /// The spheres of a primitive.
    fn seen(&self, primitive: &MedialPrimitive) -> [Ball; 3] {
        exact::balls(primitive.as_slab()).map(|ball| {
            let c = ball.center - self.origin;
            let [x, y, z] = self.axes.map(|axis| c.dot(axis));
            Ball {
                center: Vec3::new(x, y, z),
                ..ball
            }
        })
    }
}

/// The point where a ray enters one primitive: the time in units of the length of the ray's direction, up to `most`,
/// and the outward normal. A ray that starts inside enters at once, with no normal, if the primitive is `solid`; else
/// it is where it leaves, with the normal that points back inside, as in parry. A ray without direction enters only
/// what is solid and holds it.
pub fn enter(
    primitive: &MedialPrimitive,
    ray: &Ray,
    most: Real,
    solid: bool,
) -> Option<RayIntersection> {
    let within = || RayIntersection::new(0.0, Vector::ZERO, FeatureId::Face(0));
    let Some(frame) = RayFrame::new(ray) else {
        // It is a point.
        let holds = primitive.signed_distance(ray.origin).distance <= 0.0;
        return (holds && solid).then(within);
    };
    let balls = frame.seen(primitive);
    let [from, to] = ChordSolver::new(balls).chord(0.0, 0.0)?;
    let inside = from <= 0.0;
    if to < 0.0 {
        return None;
    }
    if inside && solid {
        return Some(within());
    }
    let at = if inside { to } else { from };
    let time = (at / f64::from(ray.dir.length())) as Real;
    if time > most {
        return None;
    }
    let point = Vec3::new(0.0, 0.0, at);
    // Outward along the ray where it leaves, against it where it enters.
    let along = Vec3::new(0.0, 0.0, if inside { 1.0 } else { -1.0 });
    let out = way_out(&balls, point, along);
    let out = frame.unit(out);
    let normal = if inside { -out } else { out };
    Some(RayIntersection::new(
        time,
        normal.to_vector(),
        FeatureId::Face(0),
    ))
}
