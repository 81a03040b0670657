//! Contacts of a single primitive with a triangle that parry finds wrongly: without a normal or deeper than the two are
//! (its EPA algorithm now and then ends without a direction for small spheres on triangles of about their size), or not
//! at all where they overlap. Where a cone's radii differ much, its tangent segment, which parry takes for what
//! touches, is far from its lowest point, and of triangles that allow some normals only parry leaves out the nearest
//! points. The nearest spheres take the place of such a contact. A single sphere's are those of parry's ball.

use super::inward_contacts::triangle;
use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::{MedialMesh, MedialSphere};
use crate::pair::PrimitiveList;
use crate::pair::distance::nearest_spheres;
use parry3d::query::details::NormalConstraints;
use parry3d::query::{ContactManifold, TrackedContact};
use parry3d::shape::{PackedFeatureId, Shape};

/// How much deeper than the nearest spheres a contact may be told to be, in units of the primitive's largest radius.
const DEEPER: Real = 0.01;

/// Cosine with the nearest normal that is allowed from which one is allowed (2.5°).
const ALLOWED: Real = 0.999;

/// Corrects the contacts of a mesh's primitives that belong to no convex piece. The mesh is body `side` (0 or 1) of the
/// manifolds; `ground` are the triangles, and where they are in the mesh's frame. Where rapier allows some normals
/// only, as with its flag for internal edges, nearest spheres of others are no contact.
pub fn correct<M, C: Default + Copy>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    (ground, pose): (&dyn Shape, &Pose),
    prediction: Real,
) {
    for m in manifolds {
        let of_mesh = [m.subshape1, m.subshape2][side];
        if mesh.convex_pieces().node_of(of_mesh).is_some() {
            continue;
        }
        let Some((corners, constraints)) =
            triangle((ground, pose), [m.subshape2, m.subshape1][side])
        else {
            continue;
        };
        let primitive = mesh.primitive(of_mesh as usize);
        if primitive.spheres().len() == 1 {
            continue;
        }
        let is_deep = m.points.iter().any(|point| point.dist < 0.0);
        let may_lack = m.points.is_empty() || constraints.is_some();
        if !(is_deep || may_lack && reaches_plane(primitive.spheres(), corners)) {
            continue;
        }
        let lists = [
            primitive.spheres().to_vec(),
            corners.map(|p| MedialSphere::new(p, 0.0)).to_vec(),
        ]
        .map(|spheres| {
            let mut list = PrimitiveList::default();
            list.push(&spheres);
            (list, spheres)
        });
        let [(a, spheres), (b, _)] = &lists;
        let Some(own) = nearest_spheres(a, b, &Pose::IDENTITY, prediction).0 else {
            continue;
        };
        let size = corners.map(Vector::length).into_iter().fold(0.0, Real::max);
        let thickest = spheres.iter().map(|s| s.radius).fold(0.0, Real::max);
        let slack = DEEPER * thickest + REAL_ROUNDING * size;
        let has_normal = m.points.is_empty() || m.local_n1.length_squared() > 0.5;
        let depths = m.points.iter().map(|point| point.dist);
        let deepest = depths.fold(Real::MAX, Real::min);
        let is_wrong = !has_normal || deepest < own.distance - slack;
        let is_missing = own.distance < 0.0 && deepest > own.distance + slack;
        if !(is_wrong || is_missing) {
            continue;
        }
        let to_mesh = pose.rotation.inverse() * -own.normal;
        let is_allowed = constraints.is_none_or(|cone| {
            let allowed = cone.project_local_normal(to_mesh);
            allowed.is_some_and(|n| n.dot(to_mesh) > ALLOWED)
        });
        let wrong = m.points.first().filter(|_| is_wrong);
        let data = wrong.map(|point| point.data);
        if is_wrong {
            m.points.clear();
        }
        if !is_allowed {
            continue;
        }
        let (normal, place) = (-(pose.rotation * to_mesh), own.points[0]);
        let on_ground = pose.inverse_transform_point(own.points[1]);
        let ([n1, p1], [n2, p2]) = match side {
            0 => ([normal, place], [to_mesh, on_ground]),
            _ => ([to_mesh, on_ground], [normal, place]),
        };
        if m.local_n1.dot(n1) < ALLOWED {
            m.points.clear();
        }
        [m.local_n1, m.local_n2] = [n1, n2];
        let feature = PackedFeatureId::face(0);
        let mut point = TrackedContact::new(p1, p2, feature, feature, own.distance);
        point.data = data.unwrap_or_default();
        m.points.push(point);
    }
}

/// Whether some of these spheres are not wholly on one side of a triangle's plane.
fn reaches_plane(spheres: &[MedialSphere], [a, b, c]: [Vector; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let length = normal.length();
    let ends = spheres.iter().map(|s| {
        let height = normal.dot(s.center - a);
        [height - length * s.radius, height + length * s.radius]
    });
    let [least, most] = ends.fold([Real::MAX, Real::MIN], |all, end| {
        [all[0].min(end[0]), all[1].max(end[1])]
    });
    least <= 0.0 && most >= 0.0
}
