//! How far two convex hulls of spheres are apart at fixed poses, or how deep in each other, and along which direction.
//!
//! Along any direction the gap of two hulls follows from their spheres, in double precision; it is never more than
//! their distance. The directions across faces, and across an edge of each, come first: of two polyhedra that overlap,
//! one of them has the largest gap (separating axes: Gottschalk, Lin and Manocha, "OBBTree", 1996). Else, where their
//! gap is not enough, parry's GJK and EPA algorithms propose one more, in single precision.

use super::primitive_tree::PrimitiveTree;
use crate::elementary::distance::Ball;
use crate::elementary::penetration::gap_along;
use crate::math::lane::Vec3;
use crate::math::tolerance::F64_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialSphere;
use crate::medial::convex_pieces::PieceFace;
use parry3d::query::details::contact_support_map_support_map;
use parry3d::shape::SupportMap;

/// A convex hull of spheres at a pose.
pub(super) struct PlacedHull<'a> {
    pub(super) spheres: Vec<Ball<f64>>,
    /// The flat faces of the hull in the frame of its body, and their outward normals at the pose. A primitive has
    /// none.
    pub(super) faces: &'a [PieceFace],
    pub(super) normals: Vec<Vec3<f64>>,
    /// Edges, one of each direction, and the radius of all corners; `None` unless the hull is a polyhedron grown by
    /// that radius.
    edges: Option<(&'a [[u32; 2]], f64)>,
}

impl<'a> PlacedHull<'a> {
    /// The convex piece or the primitive that a node holds; `point` and `direction` place what is given in its frame.
    pub(super) fn of_node(
        body: &'a impl PrimitiveTree,
        node: u32,
        point: impl Fn(Vector) -> Vec3<f64>,
        direction: impl Fn(Vector) -> Vec3<f64>,
    ) -> Self {
        let hull;
        let (spheres, faces, edges) = match body.convex_piece(node) {
            Some(piece) => {
                let edges = piece.edges.as_ref();
                let edges = edges.map(|edges| (&edges.ends[..], edges.radius));
                (&piece.spheres[..], &piece.faces[..], edges)
            }
            None => {
                hull = body.hull(node);
                let spheres = &hull.0[..hull.1];
                (spheres, &[][..], edges_of_simplex(spheres))
            }
        };
        let sphere = |s: &MedialSphere| (point(s.center), f64::from(s.radius));
        Self {
            spheres: spheres.iter().map(sphere).collect(),
            normals: faces.iter().map(|face| direction(face.normal)).collect(),
            faces,
            edges: edges.map(|(ends, radius)| (ends, f64::from(radius))),
        }
    }

    /// The ways along an edge of each direction, and the radius of all corners, if it is a polyhedron but for that.
    fn edges(&self) -> Option<(impl Iterator<Item = Vec3<f64>> + Clone, f64)> {
        let way = |[i, j]: &[u32; 2]| self.spheres[*j as usize].0 - self.spheres[*i as usize].0;
        self.edges
            .map(|(ends, radius)| (ends.iter().map(way), radius))
    }

    /// Whether it is a polyhedron but for the radius of its corners.
    pub(super) fn has_edges(&self) -> bool {
        self.edges.is_some()
    }

    /// The direction across a lone triangle, of which no face is known.
    pub(super) fn triangle(&self) -> Option<Vec3<f64>> {
        match self.spheres[..] {
            [a, b, c] if self.faces.is_empty() => Some((b.0 - a.0).cross(c.0 - a.0)),
            _ => None,
        }
    }

    fn middle(&self) -> Vec3<f64> {
        let sum = (self.spheres.iter()).fold(Vec3::zero(), |sum, s| sum + s.0);
        sum * (1.0 / self.spheres.len() as f64)
    }

    /// The centre of the farthest sphere along a unit direction, and the way to the next one, if that is about as far.
    fn farthest(&self, n: Vec3<f64>) -> [Vec3<f64>; 2] {
        let end = |s: &Ball<f64>| n.dot(s.0) + s.1;
        let most = self.spheres.iter().map(end).fold(f64::MIN, f64::max);
        let first = self
            .spheres
            .iter()
            .position(|s| end(s) >= most)
            .unwrap_or(0);
        let corner = self.spheres[first].0;
        let others = self.spheres.iter().enumerate().filter(|(k, _)| *k != first);
        let next = others.max_by(|a, b| end(a.1).total_cmp(&end(b.1)));
        let edge = next.map_or(Vec3::zero(), |(_, s)| s.0 - corner);
        let is_edge = next.is_some_and(|(_, s)| most - end(s) <= EDGE * edge.length());
        [corner, if is_edge { edge } else { Vec3::zero() }]
    }

    /// A bound of the coordinates of its spheres.
    pub(super) fn size(&self) -> f64 {
        let of_one = |s: &Ball<f64>| s.0.taxicab() + s.1.abs();
        self.spheres.iter().map(of_one).fold(0.0, f64::max)
    }

    /// About `origin`, in units of `unit`.
    fn support(&self, origin: Vec3<f64>, unit: f64) -> Support {
        let inverse = 1.0 / unit;
        let local = |s: &Ball<f64>| {
            let center = (s.0 - origin) * inverse;
            (center.to_vector(), (s.1 * inverse) as Real)
        };
        Support(self.spheres.iter().map(local).collect())
    }
}

/// The edges of one to three spheres of one radius.
fn edges_of_simplex(spheres: &[MedialSphere]) -> Option<(&'static [[u32; 2]], Real)> {
    /// The edges of a triangle, as indices of its corners.
    const TRIANGLE: [[u32; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
    let radius = spheres.first()?.radius;
    let edges = match spheres.len() {
        1 => &[],
        2 => &TRIANGLE[..1],
        3 => &TRIANGLE[..],
        _ => return None,
    };
    (spheres.iter().all(|s| s.radius == radius)).then_some((edges, radius))
}

/// The largest gap of two hulls along the directions tried.
#[derive(Clone, Copy)]
pub(super) struct HullGap {
    /// The largest gap along the directions tried, less its rounding: a lower bound of the distance.
    pub(super) gap: f64,
    /// Unit direction of the gap, from the first to the second.
    pub(super) direction: Vec3<f64>,
    /// The nearest points of the two, or those where they are deepest in each other, as parry found them, if it was
    /// asked.
    pub(super) nearest: Option<[Vec3<f64>; 2]>,
}

/// The largest gap of two hulls along directions. No more are tried as soon as it is more than `enough`.
pub(super) fn hull_gap(hulls: [&PlacedHull; 2], enough: f64) -> HullGap {
    let [a, b] = hulls;
    let y = b.middle() - a.middle();
    let mut best = BestDirection::new(hulls);
    let faces = (a.normals.iter().copied()).chain(b.normals.iter().map(|n| -*n));
    let is_found = faces.chain([y]).any(|n| best.attempt(n) > enough);
    if is_found || best.attempt_edges() || best.gap > enough {
        return best.found(None);
    }
    let Some(unit) = unit(hulls, y) else {
        return best.found(None);
    };
    let mut nearest = None;
    if let Some((n, points)) = proposed(hulls, y, unit) {
        best.attempt_about(n);
        nearest = Some(points);
    }
    let moved = best.attempt_moved(enough);
    best.found(moved.or(nearest))
}

/// Adds the nearest points of the two hulls, and takes a direction of a larger gap if there is one.
pub(super) fn nearest_points(hulls: [&PlacedHull; 2], found: HullGap) -> HullGap {
    if found.nearest.is_some() {
        return found;
    }
    let mut best = BestDirection {
        gap: found.gap,
        direction: found.direction,
        ..BestDirection::new(hulls)
    };
    let nearest = best.attempt_moved(f64::MAX);
    best.found(nearest)
}

/// Shift, in units of the larger hull's extent, by which hulls are moved apart along the best direction known before
/// GJK is asked for a better one. EPA errs where hulls just touch, and GJK has no more than single precision; hulls
/// that are apart by this much are not hard for it. The gap along the direction that it gives is no smaller than the
/// best known: of all directions it has the largest gap of the moved hulls, and no direction gained more by the move
/// than the best known.
const SHIFT: f64 = 0.02;

/// Gain of a direction over the one before, in units of the gap, from which hulls are moved apart once more along it.
const MIN_GAIN: f64 = 1.0e-3;

/// Largest number of times that hulls are moved apart.
const ROUNDS: usize = 4;

/// Directions across edges that are tried at most, times the spheres looked at for each: two boxes have about 200.
/// Larger, and pieces of many edges take long; smaller, and fewer do without GJK and EPA. Where it is best was not
/// measured.
const MOST_EDGES: usize = 2048;

/// The direction of the largest gap of two hulls among those tried.
struct BestDirection<'a> {
    hulls: [&'a PlacedHull<'a>; 2],
    rounding: f64,
    gap: f64,
    direction: Vec3<f64>,
}

impl<'a> BestDirection<'a> {
    fn new(hulls: [&'a PlacedHull<'a>; 2]) -> Self {
        Self {
            hulls,
            rounding: 4.0 * F64_ROUNDING * (hulls[0].size() + hulls[1].size()),
            gap: f64::MIN,
            direction: Vec3::new(1.0, 0.0, 0.0),
        }
    }

    fn found(&self, nearest: Option<[Vec3<f64>; 2]>) -> HullGap {
        HullGap {
            gap: self.gap,
            direction: self.direction,
            nearest,
        }
    }

    /// Tries the directions across edges, if both are polyhedra with few. True if no other direction can have a larger
    /// gap than the best tried, because they overlap; directions across faces were tried before. Two flat ones may lie
    /// in one plane, in which others keep them apart.
    fn attempt_edges(&mut self) -> bool {
        let [a, b] = self.hulls;
        let (Some((of_a, first)), Some((of_b, second))) = (a.edges(), b.edges()) else {
            return false;
        };
        let spheres = a.spheres.len() + b.spheres.len();
        if of_a.clone().count() * of_b.clone().count() * spheres > MOST_EDGES {
            return false;
        }
        let triangles = [a.triangle(), b.triangle()].into_iter().flatten();
        let across = of_a.flat_map(|e| of_b.clone().map(move |f| e.cross(f)));
        for n in across.chain(triangles) {
            self.attempt(n);
            self.attempt(-n);
        }
        self.attempt_about(self.direction);
        let is_solid = |hull: &PlacedHull| hull.faces.len() > 2;
        (is_solid(a) || is_solid(b)) && self.gap + first + second < 0.0
    }

    /// Moves the hulls apart along the best direction, and tries those along which they are nearest then; no more as
    /// soon as the gap is more than `enough`. The nearest points found last.
    fn attempt_moved(&mut self, enough: f64) -> Option<[Vec3<f64>; 2]> {
        let [a, b] = self.hulls;
        let y = b.middle() - a.middle();
        let unit = unit(self.hulls, y)?;
        let mut nearest = None;
        for _ in 0..ROUNDS {
            if self.gap > enough {
                break;
            }
            let (before, along) = (self.gap, self.direction);
            let way = along * (SHIFT * unit - before);
            let Some((n, [p, q])) = proposed(self.hulls, y + way, unit) else {
                break;
            };
            self.attempt_about(n);
            nearest = Some([p, q - way]);
            if self.gap - before <= MIN_GAIN * before.abs() {
                break;
            }
        }
        nearest
    }

    /// Tries a direction of any length; returns the largest gap so far.
    fn attempt(&mut self, n: Vec3<f64>) -> f64 {
        let length = n.length();
        if length > 0.0 {
            let n = n * (1.0 / length);
            let [a, b] = self.hulls;
            let gap = gap_along(&a.spheres, &b.spheres, n) - self.rounding;
            if gap > self.gap {
                (self.gap, self.direction) = (gap, n);
            }
        }
        self.gap
    }

    /// Tries a direction in single precision, and those near it.
    fn attempt_about(&mut self, n: Vec3<f64>) {
        let near = across(self.hulls, n).into_iter().flatten();
        for n in [n].into_iter().chain(near) {
            self.attempt(n);
        }
    }
}

/// The larger extent of two hulls, `y` from middle to middle; `None` where numbers are bad.
fn unit(hulls: [&PlacedHull; 2], y: Vec3<f64>) -> Option<f64> {
    let extent = |hull: &PlacedHull| {
        let middle = hull.middle();
        let reaches = hull.spheres.iter().map(|s| (s.0 - middle).length() + s.1);
        reaches.fold(0.0, f64::max)
    };
    let unit = extent(hulls[0]).max(extent(hulls[1]));
    (unit.is_normal() && y.length().is_finite()).then_some(unit)
}

/// How much less far than its farthest sphere another of a hull reaches along a direction, in units of the way between
/// them, to be at the other end of an edge that is nearest.
const EDGE: f64 = 1.0e-3;

/// Directions near `n` that the corners and edges farthest along it decide, in double precision: from corner to corner,
/// across one edge, across both.
fn across([a, b]: [&PlacedHull; 2], n: Vec3<f64>) -> [Option<Vec3<f64>>; 4] {
    let ([p, e], [q, f]) = (a.farthest(n), b.farthest(-n));
    let y = q - p;
    let beside = |e: Vec3<f64>| {
        let ee = e.length_sq();
        (ee > 0.0).then(|| y - e * (e.dot(y) / ee))
    };
    let along = |m: Vec3<f64>| if m.dot(n) < 0.0 { -m } else { m };
    [Some(y), beside(e), beside(f), Some(e.cross(f))].map(|m| m.map(along))
}

/// The direction along which parry finds two hulls apart, or least deep in each other, and the points where they are,
/// if the way from middle to middle is `y`. `unit`: their extent.
fn proposed(
    [a, b]: [&PlacedHull; 2],
    y: Vec3<f64>,
    unit: f64,
) -> Option<(Vec3<f64>, [Vec3<f64>; 2])> {
    let origin = a.middle();
    let pose = Pose::from_translation((y * (1.0 / unit)).to_vector());
    let (first, second) = (a.support(origin, unit), b.support(b.middle(), unit));
    let contact = contact_support_map_support_map(&pose, &first, &second, Real::MAX)?;
    let points = [(contact.point1, origin), (contact.point2, origin + y)];
    let points = points.map(|(p, origin)| origin + Vec3::from_vector(p) * unit);
    Some((Vec3::from_vector(contact.normal1), points))
}

/// Spheres in single precision, as parry's algorithms see their hull.
pub struct Support(pub Vec<(Vector, Real)>);

impl SupportMap for Support {
    fn local_support_point(&self, direction: Vector) -> Vector {
        let n = direction.normalize_or_zero();
        let (mut farthest, mut most) = (Vector::ZERO, Real::MIN);
        for (center, radius) in &self.0 {
            let end = n.dot(*center) + radius;
            if end >= most {
                (farthest, most) = (*center + n * *radius, end);
            }
        }
        farthest
    }
}
