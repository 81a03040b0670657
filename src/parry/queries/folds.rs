//! Normals at the folds between the triangles of a ground.
//!
//! Where two triangles share an edge, what lies on the ground can be pushed along their normals only, or along one
//! between these where the edge is a ridge. But a solver lets bodies sink in a little. The nearest point of what slides
//! in a valley, just below the surface, is then the edge straight ahead, with a normal against the motion. A rounded
//! part has its middle above the surface and its normal is right, but for what the part has sunk in: only within a flat
//! surface is it corrected.

use super::sliding::ALIKE;
use super::swept_sphere_parts::SweptParts;
use crate::elementary::ToiStatus;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::PrimitiveTree;
use crate::pair::first_contact::ToiResult;
use crate::pair::met::Met;
use crate::parry::partners::shape_faces::Face;
use parry3d::query::NonlinearRigidMotion;

/// Distance of the corners of a side from the line of an edge within which the side is along it, in units of the edge's
/// length: height fields whose cells are no power of two have neighbours off by their rounding.
const ON_LINE: Real = 1.0e-3;

/// Cosine of the normals of neighbours up to which they make one flat surface (2.5°).
const FLAT: Real = 0.999;

/// Cosine of a normal and the one that takes its place from which the two are one (a quarter of a degree).
const SAME_NORMAL: Real = 0.99999;

/// How a mesh meets a triangle, in the ground's frame.
struct FoldContact {
    /// Nearest point of the triangle.
    point: Vector,
    /// Unit normal from there to the mesh.
    normal: Vector,
    /// Middle of the mesh.
    middle: Vector,
    /// Longest side of the mesh's box.
    size: Real,
}

impl FoldContact {
    /// Unit normal of a triangle to the side of the mesh: that of its nearest point, unless this is beside the
    /// triangle.
    fn facing(&self, [a, b, c]: [Vector; 3]) -> Vector {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let side = match normal.dot(self.normal) {
            along if along.abs() > BESIDE => along,
            _ => normal.dot(self.middle - self.point),
        };
        normal * side.signum()
    }

    /// Whether the mesh meets a face within a flat surface, of several triangles at most, and its normal is about
    /// `normal`.
    fn is_within(
        &self,
        face: [Vector; 3],
        normal: Vector,
        others: impl Iterator<Item = [Vector; 3]>,
    ) -> bool {
        let own = self.facing(face);
        let mut around = others.filter(|other| self.is_at(*other));
        self.normal.dot(normal) > ALIKE as Real
            && around.all(|other| self.facing(other).dot(own) > FLAT)
    }

    /// Whether the point is on a side of a triangle, or beside it by no more than counts as on an edge.
    fn is_at(&self, [a, b, c]: [Vector; 3]) -> bool {
        [[a, b], [b, c], [c, a]].into_iter().any(|[p, q]| {
            let along = q - p;
            let share = along.dot(self.point - p) / along.length_squared().max(Real::MIN_POSITIVE);
            let nearest = p + along * share.clamp(0.0, 1.0);
            nearest.distance(self.point) <= ON_EDGE[1] * self.size
        })
    }
}

/// Gives a hit on one of `parts` the normal along which the mesh can be thrown back there: where it lies on the plane
/// of a face, or, on surfaces, comes to lie there or meets it at a fold. The motions, over `seconds`, are those of the
/// mesh and of the ground.
pub fn correct_normal(
    found: &mut ToiResult,
    parts: &SweptParts,
    mesh: &MedialMesh,
    motions: [&NonlinearRigidMotion; 2],
    seconds: Real,
) {
    let toi = &mut found.toi;
    let Some(sliding) = parts.sliding.as_ref() else {
        return;
    };
    if toi.status == ToiStatus::Separated {
        return;
    }
    let poses = motions.map(|m| m.position_at_time(toi.lower * seconds));
    let (point, to_ground) = (toi.points[1], poses[1].inverse());
    let pose = to_ground * poses[0];
    let met = FoldContact {
        point: to_ground * point,
        normal: to_ground.rotation * -toi.normal,
        middle: pose * mesh.aabb().center(),
        size: mesh.aabb().extents().max_element(),
    };
    let corners = |k: u32| parts.primitives.primitive(k).0.map(|s| s.center);
    let face = corners(toi.primitives[1]);
    let others = || {
        let all = (0..parts.primitives.len() as u32).map(corners);
        all.chain(parts.left_out.iter().copied())
    };
    let known = parts.normals.iter().find(|(p, _)| *p == toi.primitives[1]);
    let primitive = mesh.primitive(toi.primitives[0] as usize);
    // A thick primitive has its centres above the surface, so that its normals are right but for the depth to which it
    // has sunk in.
    let at_fold = || match sliding.keeps_above(primitive.spheres()) {
        true => normal(face, others(), &met).filter(|n| met.is_within(face, *n, others())),
        false => normal(face, others(), &met),
    };
    let comes_to_lie = || sliding.comes_to_lie(Face::of_surface(&face), &pose);
    let normal = known.map(|(_, n)| *n).or_else(|| {
        let may_fold = !sliding.is_over_solids;
        may_fold.then(|| at_fold().or_else(comes_to_lie))?
    });
    if let Some(n) = normal {
        let turned = poses[1].rotation * -n;
        // The points stay below the sphere that meets the ground: beside it they would turn a ball that rolls.
        let by = (turned - toi.normal) * toi.spheres[0].radius;
        toi.normal = turned;
        toi.points = toi.points.map(|p| p + by);
        // The spheres that met tell of another normal. Where that of a face stays as it is they are kept, if a solid
        // has it or the body lies on it: heaps hand impulses on through them.
        let is_same = n.dot(met.normal) >= SAME_NORMAL;
        let is_kept = |met: &Met| is_same && (sliding.is_over_solids || met.is_of_faces());
        found.met = found.met.take().filter(is_kept);
    }
}

/// Cosine of a normal with that of the face up to which the nearest point is beside the face (6° from its plane).
const BESIDE: Real = 0.1;

/// Distance within which a point is on an edge, in units of the edge's length and of the mesh's size.
const ON_EDGE: [Real; 2] = [0.02, 0.01];

/// Whether a triangle has a side along an edge, at a point of it: the same side, or a part of it, or a longer one.
fn meets_at([a, b, c]: [Vector; 3], edge: [Vector; 2], at: Vector) -> bool {
    let along = edge[1] - edge[0];
    let length = along.length();
    let within = ON_LINE * length;
    let is_on_line = |p: Vector| along.cross(p - edge[0]).length() <= within * length;
    let place = |p: Vector| along.dot(p - edge[0]) / length;
    let sides = [[a, b], [b, c], [c, a]];
    sides.into_iter().any(|side| {
        let [p, q] = side.map(place);
        let holds = (p.min(q)..=p.max(q)).contains(&place(at).clamp(within, length - within));
        holds && side.into_iter().all(is_on_line)
    })
}

/// The normal nearest to that of `met` that is possible at its point of `face`: within the face its own, at an edge
/// between it and another of the triangles that faces about the same way one of both or between these. `None` at any
/// other edge.
fn normal(
    face: [Vector; 3],
    others: impl Iterator<Item = [Vector; 3]> + Clone,
    met: &FoldContact,
) -> Option<Vector> {
    let own = met.facing(face);
    let mut allowed: Option<Vector> = None;
    let mut ridges: Vec<Real> = Vec::new();
    for edge in [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]] {
        let along = edge[1] - edge[0];
        let length = along.length();
        let within = (ON_EDGE[0] * length).min(ON_EDGE[1] * met.size);
        if along.cross(met.point - edge[0]).length() > within * length {
            continue;
        }
        let meets = |other: &[Vector; 3]| *other != face && meets_at(*other, edge, met.point);
        let beyond = others
            .clone()
            .filter(meets)
            .map(|other| (other, met.facing(other)));
        let (other, normal) = beyond
            .filter(|(_, normal)| normal.dot(own) > ALIKE as Real)
            .max_by(|a, b| a.1.dot(own).total_cmp(&b.1.dot(own)))?;
        let across = met.normal - along * (along.dot(met.normal) / along.length_squared());
        // A ridge bends away from the face, and has all normals between both.
        let is_below = |p: &Vector| own.dot(*p - edge[0]) <= ON_LINE * length;
        let is_ridge = other.iter().all(is_below);
        let bend = own.cross(normal);
        let is_between = bend.dot(own.cross(across)) > 0.0 && bend.dot(across.cross(normal)) > 0.0;
        let nearest = match is_ridge && is_between {
            true => across.normalize_or_zero(),
            false if own.dot(across) < normal.dot(across) => normal,
            false => own,
        };
        ridges.extend(is_ridge.then_some(normal.dot(own)));
        let is_nearer = |n: &Vector| n.dot(met.normal) >= nearest.dot(met.normal);
        allowed = allowed.filter(is_nearer).or(Some(nearest));
    }
    // The top of a hill has all normals between those of its faces.
    let widest = ridges.iter().copied().fold(1.0, Real::min);
    let is_top = ridges.len() > 1 && own.dot(met.normal) >= widest;
    (!is_top).then(|| allowed.unwrap_or(own))
}
