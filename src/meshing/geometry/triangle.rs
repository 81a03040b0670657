//! A triangle and a point: the nearest point of it, and how it is seen from there; and points inside a triangle.
//!
//! Nearest point: Ericson, Real-Time Collision Detection (2005), §5.1.5. Solid angle: Van Oosterom and
//! Strackee, "The solid angle of a plane triangle" (1983).

use crate::meshing::geometry::bounds::Point;

/// Signed solid angle of a triangle seen from `p`: positive from behind its normal (Van Oosterom
/// and Strackee 1983).
pub fn solid_angle_of(p: Point, t: &[Point; 3]) -> f64 {
    let [a, b, c] = t.map(|v| v - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * numerator.atan2(denominator)
}

/// The middle of a triangle, and points near its corners and the middles of its sides: by a share of the way from these
/// to the middle.
pub fn points_inside(corners: &[Point; 3], share: f64) -> [Point; 7] {
    let [a, b, c] = *corners;
    let middle = (a + b + c) * (1.0 / 3.0);
    let border = [a, (a + b) * 0.5, b, (b + c) * 0.5, c, (c + a) * 0.5];
    let [a, ab, b, bc, c, ca] = border.map(|p| p * (1.0 - share) + middle * share);
    [middle, a, ab, b, bc, c, ca]
}

/// The point of a triangle that is nearest to `p`.
pub fn closest_on_triangle(p: Point, &[a, b, c]: &[Point; 3]) -> Point {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 {
        return b + (c - b) * (e / (e + f));
    }
    let sum = va + vb + vc;
    if sum > 0.0 {
        a + ab * (vb / sum) + ac * (vc / sum)
    } else {
        a
    }
}
