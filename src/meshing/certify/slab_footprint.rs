//! The outline in which a slab touches a plane: the triangle of the points at which its three balls touch it. A
//! piece of a flat face is cut along the sides of that triangle, so that each part lies in one slab. Halving pieces
//! would never end those that cross from one slab to the next.

use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::quadric::slab_normals;

/// A slab touches a face when its points of contact are within this of the face's plane (longest side 1).
const TOUCHES: f64 = 1e-6;

/// A part that is beyond an outline by less than this (longest side 1) is not cut off: it is of rounding. By as
/// much the slab grows there. A share of the area says less: a millionth of it may be a thousandth long.
const LEAST_HEIGHT: f64 = 1e-9;

/// A cut that leaves the slab less than this share of a piece gets nowhere.
const LEAST_SHARE: f64 = 1e-6;

/// Parts of a piece: those in a slab's triangle of contact, and the others.
pub struct Cut {
    /// Parts that the slab covers, up to rounding and its distance from the plane.
    pub inner: Vec<[Point; 3]>,
    /// The rest.
    pub outer: Vec<[Point; 3]>,
}

/// Cuts a piece of a face of unit normal `normal` along the outline of what a slab touches of its plane; `None`
/// where that is nothing of the piece, or all. The normal is the whole face's: a needle's own is of rounding.
pub fn cut_along_outline(piece: &[Point; 3], normal: Point, slab: [Ball; 3]) -> Option<Cut> {
    let touching = slab_normals(slab)?;
    let [one, other] = touching;
    let outward = if one.dot(normal) > other.dot(normal) {
        one
    } else {
        other
    };
    let contact = slab.map(|ball| ball.center + outward * ball.radius);
    if contact
        .iter()
        .any(|p| (*p - piece[0]).dot(normal).abs() > TOUCHES)
    {
        return None;
    }
    let turn = match normal_of(&contact).dot(normal) > 0.0 {
        true => normal,
        false => -normal,
    };
    let mut inside = piece.to_vec();
    let mut outer = Vec::new();
    for k in 0..3 {
        let (from, to) = (contact[k], contact[(k + 1) % 3]);
        let inward = direction(turn.cross(to - from));
        let height = |p: &Point| (*p - from).dot(inward);
        if inside.iter().any(|p| height(p) < -LEAST_HEIGHT) {
            outer.extend(fan(&clip(&inside, |p| -height(p))));
            inside = clip(&inside, height);
        }
    }
    let inner: Vec<[Point; 3]> = fan(&inside).collect();
    let covered: f64 = inner.iter().map(area).sum();
    (covered > LEAST_SHARE * area(piece) && !outer.is_empty()).then_some(Cut { inner, outer })
}

/// The part of a convex polygon where `height`, which is linear, is not negative.
fn clip(polygon: &[Point], height: impl Fn(&Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (at_p, at_q) = (height(p), height(q));
        if at_p >= 0.0 {
            kept.push(*p);
        }
        if (at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0) {
            kept.push(*p + (*q - *p) * (at_p / (at_p - at_q)));
        }
    }
    kept
}

/// The triangles of a convex polygon, from its first corner.
fn fan(polygon: &[Point]) -> impl Iterator<Item = [Point; 3]> + '_ {
    let pairs = polygon.get(1..).unwrap_or(&[]).windows(2);
    pairs.map(|pair| [polygon[0], pair[0], pair[1]])
}

fn normal_of([a, b, c]: &[Point; 3]) -> Point {
    (*b - *a).cross(*c - *a)
}

fn area(triangle: &[Point; 3]) -> f64 {
    0.5 * normal_of(triangle).length()
}
