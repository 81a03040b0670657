//! Contacts of two convex pieces at fixed poses: where a flat face of one lies about flat on the other, the corners of
//! the polygon in which the two faces overlap, as in other engines; else their nearest points. Each contact is a pair
//! of spheres, as those of two primitives are.

use super::hull_gap::{HullGap, PlacedHull, hull_gap, nearest_points};
use super::placement::Placement;
use super::sphere_pair::SpherePair;
use crate::math::Real;
use crate::math::clipping::part_below;
use crate::math::lane::Vec3;
use crate::math::tolerance::{ONE_DIRECTION, ROUNDING_ULPS};

/// How much better, in cosines, the face of the second has to lie to be the one that contacts are measured from. At 0
/// rounding decides, and contacts change from step to step.
const FACE_PREFERENCE: f64 = 1.0e-3;

/// Share of the depth of the hulls by which the deepest corner of two faces may be less deep. If it is missing more,
/// the nearest points of the hulls become a contact of their own.
const MISSED: f64 = 0.05;

/// Feature of the nearest points, which belong to no face.
const NEAREST: u32 = 1 << 18;

/// Added to the features of contacts that are measured from a face of the second.
const SECOND: u32 = 1 << 19;

/// Corners of faces and polygons that have features of their own; of more, some share them.
const NUMBERED: usize = 256;

/// A corner of a polygon, and its number: that of a corner, or of an edge and the edge that cuts it.
type Corner = (Vec3<f64>, u32);

/// Contacts of two pieces within `margin` (a length) of each other. `primitives` are those that the contacts are told
/// of; points of the second are given in its frame, of which `place` is the pose.
pub(super) fn face_contacts(
    hulls: [&PlacedHull; 2],
    primitives: [u32; 2],
    place: &Placement,
    margin: f64,
) -> Vec<SpherePair> {
    let hull = hull_gap(hulls, margin);
    if hull.gap > margin {
        return Vec::new();
    }
    let faces = facing_faces(hulls, hull.direction, margin);
    let contact = |normal: Vec3<f64>, c: &FacingCorner| SpherePair {
        primitives,
        feature: c.feature,
        distance: c.height as Real,
        normal: normal.to_vector(),
        points: [c.points[0].to_vector(), place.inverse_point(c.points[1])],
    };
    let contacts = faces.map(|f| f.corners.iter().map(|c| contact(f.normal, c)).collect());
    let mut found = contacts.unwrap_or_default();
    add_nearest(hulls, (hull, primitives), place, &mut found);
    found
}

/// Two faces that look at each other.
pub(super) struct FacingFaces {
    /// The body with the face that lies flattest, 0 or 1.
    pub(super) of: usize,
    /// The normal of that face, or its opposite: from the first body to the second.
    pub(super) normal: Vec3<f64>,
    /// The corners of the polygon in which the faces overlap, as far as they are near.
    pub(super) corners: Vec<FacingCorner>,
}

/// A corner of the polygon in which two faces overlap.
pub(super) struct FacingCorner {
    feature: u32,
    /// Height above the face that lies flattest, a length.
    height: f64,
    /// The corner on both bodies.
    pub(super) points: [Vec3<f64>; 2],
}

/// The faces of two hulls that look at each other, if one is about flat to a direction from the first to the second,
/// with the corners that are within `margin` of it.
pub(super) fn facing_faces(
    hulls: [&PlacedHull; 2],
    direction: Vec3<f64>,
    margin: f64,
) -> Option<FacingFaces> {
    let best = [(hulls[0], direction), (hulls[1], -direction)].map(|(hull, n)| flattest(hull, n));
    let cosines = best.map(|face| face.map_or(-1.0, |face| face.cosine));
    let of = usize::from(cosines[1] > cosines[0] + FACE_PREFERENCE);
    let face = best[of].filter(|face| face.cosine >= ONE_DIRECTION)?;
    let normal = face.normal;
    let (reference, other) = (hulls[of], hulls[1 - of]);
    let outline = polygon(reference, face.corners, normal);
    let (base, _) = *outline.first()?;
    let near = |(corner, number): Corner| {
        let height = normal.dot(corner - base);
        let foot = corner - normal * height;
        (height <= margin).then_some(FacingCorner {
            feature: if of == 0 { number } else { SECOND | number },
            height,
            points: if of == 0 {
                [foot, corner]
            } else {
                [corner, foot]
            },
        })
    };
    let corners = clipped(facing(other, -normal), &outline, normal).into_iter();
    Some(FacingFaces {
        of,
        normal: if of == 0 { normal } else { -normal },
        corners: corners.filter_map(near).collect(),
    })
}

/// Adds the nearest points of two pieces, where none of the contacts found is as deep as the pieces are. Corners of the
/// facing polygon need not be the deepest of their hull: that may be where other faces meet.
pub(super) fn add_nearest(
    hulls: [&PlacedHull; 2],
    (hull, primitives): (HullGap, [u32; 2]),
    place: &Placement,
    found: &mut Vec<SpherePair>,
) {
    let deepest = found.iter().map(|c| f64::from(c.distance));
    if deepest.fold(f64::MAX, f64::min) <= hull.gap + least_missed(hulls, hull.gap) {
        return;
    }
    let HullGap {
        gap,
        direction,
        nearest,
    } = nearest_points(hulls, hull);
    if let Some(points) = nearest {
        let middle = (points[0] + points[1]) * 0.5;
        let half = direction * (0.5 * gap);
        let second = place.inverse_point(middle + half);
        found.push(SpherePair {
            primitives,
            feature: NEAREST,
            distance: gap as Real,
            normal: direction.to_vector(),
            points: [(middle - half).to_vector(), second],
        });
    }
}

/// Length by which the deepest corner must be less deep than the hulls, whose gap this is, to count as missing: more
/// than rounding.
fn least_missed([a, b]: [&PlacedHull; 2], gap: f64) -> f64 {
    MISSED * gap.abs() + ROUNDING_ULPS * f64::from(Real::EPSILON) * (a.size() + b.size())
}

/// A face of a hull that looks along a direction.
#[derive(Clone, Copy)]
struct FlatFace<'a> {
    /// Its unit normal, outward.
    normal: Vec3<f64>,
    /// Cosine of the angle between its normal and the direction.
    cosine: f64,
    /// Its corners, numbers of spheres, counterclockwise around the normal.
    corners: &'a [u32],
}

/// The face whose normal is nearest to a direction. A lone triangle, of corners of one radius, has two faces.
fn flattest<'a>(hull: &PlacedHull<'a>, n: Vec3<f64>) -> Option<FlatFace<'a>> {
    if let Some(across) = hull.triangle().filter(|across| across.length() > 0.0)
        && hull.has_edges()
    {
        let normal = across * (1.0 / across.length());
        let (normal, corners): (_, &[u32]) = match normal.dot(n) >= 0.0 {
            true => (normal, &[0, 1, 2]),
            false => (-normal, &[0, 2, 1]),
        };
        let cosine = normal.dot(n);
        return Some(FlatFace {
            normal,
            cosine,
            corners,
        });
    }
    let cosines = hull.normals.iter().map(|normal| normal.dot(n)).enumerate();
    let best = cosines.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    best.map(|(face, cosine)| FlatFace {
        normal: hull.normals[face],
        cosine,
        corners: &hull.faces[face].corners,
    })
}

/// The corners of a face where its spheres end along a direction.
fn polygon(hull: &PlacedHull, corners: &[u32], n: Vec3<f64>) -> Vec<Corner> {
    let end = |k: &u32| {
        let (center, radius) = hull.spheres[*k as usize];
        (center + n * radius, *k)
    };
    corners.iter().map(end).collect()
}

/// The polygon of a hull that looks along a direction: of its flattest face, or of all corners of a hull that has no
/// more than one face could have.
fn facing(hull: &PlacedHull, n: Vec3<f64>) -> Vec<Corner> {
    match flattest(hull, n) {
        Some(face) => polygon(hull, face.corners, n),
        None if hull.spheres.len() <= 3 => polygon(hull, &[0, 1, 2][..hull.spheres.len()], n),
        None => Vec::new(),
    }
}

/// The part of a polygon that is inside the edges of another, seen along its normal.
fn clipped(polygon: Vec<Corner>, outline: &[Corner], normal: Vec3<f64>) -> Vec<Corner> {
    let mut polygon = polygon;
    for (k, (from, _)) in outline.iter().enumerate() {
        let edge = outline[(k + 1) % outline.len()].0 - *from;
        let outward = edge.cross(normal);
        polygon = part_below(
            &polygon,
            |c| outward.dot(c.0 - *from),
            |i, p, q, share| {
                let number = NUMBERED * (1 + k % NUMBERED) + i.min(NUMBERED - 1);
                (p.0 + (q.0 - p.0) * share, number as u32)
            },
        );
    }
    polygon
}
