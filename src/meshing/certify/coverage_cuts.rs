//! Cuts a piece of a face where the part that one primitive covers ends.
//!
//! The signed distance to a primitive is the least `|p − c| − r` over its balls. That is convex in the point and the
//! ball's weights together, so its minimum over the weights is convex in the point (Boyd and Vandenberghe, *Convex
//! Optimization*, 2004, §3.2.5). What a primitive covers of an edge of a piece is therefore one interval, and the
//! polygon through the ends of the intervals is covered whole. Halves of halves would go on along the whole line at
//! which one primitive's part ends and the next one's begins.

use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::subdivide::longest_edge_sq;

/// Distance (longest side 1) by which a point may stick out of a primitive and still count as covered: where a slab
/// touches a flat face, distances are rounding errors.
const TOLERANCE: f64 = 1e-9;

/// Depth in the primitive (longest side 1) at which a point counts as the end of the covered interval. The point
/// found is always covered; a deeper one leaves more of the piece uncovered.
const EXACT: f64 = 1e-10;

/// Largest number of steps in the search for that end. With fewer it may be deeper.
const MAX_STEPS: usize = 16;

/// Steps of the search for a covered point between two that are not; each leaves .62 of the edge.
const SEARCH: usize = 12;

/// Share of a piece's area that a primitive has to cover for a cut along it: less gets nowhere. It bounds the number of
/// cuts.
const LEAST_SHARE: f64 = 0.1;

/// Height of a piece over its longest edge (longest side of the body 1) below which it is not cut. It bounds the number
/// of cuts too.
const LEAST_HEIGHT: f64 = 1e-4;

/// Parts of a piece: those that the primitive covers, and the others.
pub struct Cut {
    /// Parts that are covered, up to the tolerance.
    pub inner: Vec<[Point; 3]>,
    /// The rest.
    pub outer: Vec<[Point; 3]>,
}

/// Cuts a piece along what the primitive of this signed distance covers of its edges; `None` where that is hardly
/// anything of the piece.
pub fn cut_covered(t: &[Point; 3], distance: impl Fn(Point) -> f64) -> Option<Cut> {
    if 2.0 * area(t) < LEAST_HEIGHT * longest_edge_sq(t).sqrt() {
        return None;
    }
    let beyond = |p: Point| distance(p) - TOLERANCE;
    let at_corners = t.map(&beyond);
    // The polygon of what is covered, and for each of its corners the edge on which it is.
    let mut polygon: Vec<(usize, Point)> = Vec::with_capacity(6);
    for k in 0..3 {
        let j = (k + 1) % 3;
        let at = |x: f64| {
            if x == 1.0 {
                t[j]
            } else {
                t[k] + (t[j] - t[k]) * x
            }
        };
        if let Some((start, end)) = interval(at_corners[k], at_corners[j], |x| beyond(at(x))) {
            polygon.extend([(k, at(start)), (k, at(end))]);
        }
    }
    let mut inner: Vec<[Point; 3]> = fan(polygon.iter().map(|corner| corner.1).collect());
    if inner.iter().map(area).sum::<f64>() < LEAST_SHARE * area(t) {
        return None;
    }
    let mut outer = Vec::new();
    for pair in 0..polygon.len() / 2 {
        let (from, end) = polygon[2 * pair + 1];
        let (to, start) = polygon[(2 * pair + 2) % polygon.len()];
        let corners = (0..(to + 3 - from) % 3).map(|step| t[(from + 1 + step) % 3]);
        outer.extend(fan([end]
            .into_iter()
            .chain(corners)
            .chain([start])
            .collect()));
    }
    inner.retain(|part| area(part) > 0.0);
    outer.retain(|part| area(part) > 0.0);
    Some(Cut { inner, outer })
}

/// The interval of `x`, from 0 to 1, in which a convex function is at most 0, given its values at 0 and 1; `None` if
/// there is none.
fn interval(at_0: f64, at_1: f64, f: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let inside = match (at_0 <= 0.0, at_1 <= 0.0) {
        (true, true) => return Some((0.0, 1.0)),
        (true, false) => (0.0, at_0),
        (false, true) => (1.0, at_1),
        (false, false) => below_zero(&f)?,
    };
    // A cut that comes from deep inside ends where the primitive does, and not by the tolerance farther on.
    let spare = if inside.1 < -2.0 * TOLERANCE {
        TOLERANCE
    } else {
        0.0
    };
    let lifted = |(x, at): (f64, f64)| (x, at + spare);
    let end = |x: f64, at: f64| match at <= 0.0 {
        true => x,
        false => crossing(lifted(inside), lifted((x, at)), |x| f(x) + spare),
    };
    Some((end(0.0, at_0), end(1.0, at_1)))
}

/// A place between 0 and 1 where a convex function is at most 0, and its value there, by golden sections (Kiefer,
/// "Sequential minimax search for a maximum", 1953).
fn below_zero(f: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    /// The golden ratio less 1: with it one of the two inner places serves again in the next step.
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut from, mut to) = (0.0, 1.0);
    let value = |x: f64| (x, f(x));
    let (mut a, mut b) = (value(1.0 - GOLDEN), value(GOLDEN));
    for _ in 0..SEARCH {
        let least = if a.1 < b.1 { a } else { b };
        if least.1 <= 0.0 {
            return Some(least);
        }
        if a.1 < b.1 {
            (to, b) = (b.0, a);
            a = value(to - GOLDEN * (to - from));
        } else {
            (from, a) = (a.0, b);
            b = value(from + GOLDEN * (to - from));
        }
    }
    None
}

/// The last place, from `inside` on, where a convex function is at most 0; at `outside` it is above. The chord between
/// the two lies above the function, so where the chord is 0 the function is not above 0.
fn crossing(mut inside: (f64, f64), mut outside: (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..MAX_STEPS {
        if inside.1 >= -EXACT {
            break;
        }
        for share in [inside.1 / (inside.1 - outside.1), 0.5] {
            let x = inside.0 + (outside.0 - inside.0) * share;
            let at = f(x);
            match at <= 0.0 {
                true => inside = (x, at),
                false => outside = (x, at),
            }
        }
    }
    inside.0
}

/// The triangles of a convex polygon, from its first corner.
fn fan(polygon: Vec<Point>) -> Vec<[Point; 3]> {
    let pairs = polygon.get(1..).unwrap_or(&[]).windows(2);
    pairs.map(|pair| [polygon[0], pair[0], pair[1]]).collect()
}

fn area([a, b, c]: &[Point; 3]) -> f64 {
    0.5 * (*b - *a).cross(*c - *a).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten thousand points of a triangle, evenly.
    fn points([a, b, c]: [Point; 3]) -> impl Iterator<Item = Point> {
        let at = move |i: u32, j: u32| {
            let (x, y) = ((f64::from(i) + 0.5) / 141.0, (f64::from(j) + 0.5) / 141.0);
            a + (b - a) * x + (c - a) * y
        };
        (0..140).flat_map(move |i| (0..140 - i).map(move |j| at(i, j)))
    }

    fn holds(&[a, b, c]: &[Point; 3], p: Point) -> bool {
        let normal = (b - a).cross(c - a);
        let is_left =
            |(from, to): (Point, Point)| normal.dot((to - from).cross(p - from)) >= -1e-12;
        assert!(normal.length() > 1e-9, "a part without area");
        [(a, b), (b, c), (c, a)].into_iter().all(is_left)
    }

    /// Cuts where a ball ends; the parts are the whole, and the inner ones lie in the ball.
    fn cut_by_ball(piece: [Point; 3], center: Point, radius: f64) -> Option<Cut> {
        let distance = |p: Point| (p - center).length() - radius;
        let cut = cut_covered(&piece, distance)?;
        let whole: f64 = cut.inner.iter().chain(&cut.outer).map(area).sum();
        assert!((whole / area(&piece) - 1.0).abs() < 1e-9, "{whole}");
        for corner in cut.inner.iter().flatten() {
            assert!(distance(*corner) <= TOLERANCE);
        }
        for p in points(piece) {
            assert!(
                cut.inner
                    .iter()
                    .chain(&cut.outer)
                    .any(|part| holds(part, p))
            );
        }
        Some(cut)
    }

    #[test]
    fn the_parts_are_the_whole_and_the_inner_ones_are_covered() {
        let piece = [(0.0, 0.0), (1.0, 0.2), (0.3, 0.9)].map(|(x, y)| Point::new(x, y, 0.1));
        // At a corner, at two, across two edges without a corner.
        for (x, y, radius) in [(0.0, 0.0, 0.5), (0.5, 0.1, 0.6), (0.5, 0.4, 0.35)] {
            let cut = cut_by_ball(piece, Point::new(x, y, 0.0), radius);
            assert!(cut.is_some(), "{x} {y} {radius}");
        }
        // Where it ends is found to the tolerance: the chord through both ends is as long as it can be.
        let cut = cut_by_ball(piece, Point::new(0.0, 0.0, 0.1), 0.5).unwrap();
        let farthest = cut.inner.iter().flatten().map(|p| (*p - piece[0]).length());
        assert!(farthest.fold(0.0, f64::max) > 0.5 - 1e-8);
    }

    #[test]
    fn what_covers_hardly_anything_does_not_cut() {
        let piece = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point::new(x, y, 0.0));
        assert!(cut_by_ball(piece, Point::new(0.0, 0.0, 0.0), 0.2).is_none());
        assert!(cut_by_ball(piece, Point::new(9.0, 0.0, 0.0), 1.0).is_none());
        // A part of one edge alone.
        assert!(cut_by_ball(piece, Point::new(0.5, 0.0, 0.0), 0.3).is_none());
        let sliver = [(0.0, 0.0), (1.0, 0.0), (0.5, 5e-5)].map(|(x, y)| Point::new(x, y, 0.0));
        assert!(cut_by_ball(sliver, Point::new(0.0, 0.0, 0.0), 0.5).is_none());
    }
}
