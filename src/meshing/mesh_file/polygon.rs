//! Polygons cut into triangles by ear clipping. (A fan from the first corner, as most readers do,
//! covers the notch of a concave polygon.)
//!
//! The polygon is seen along its Newell normal, so slightly warped polygons are fine. Corner `b`
//! between its neighbours `a` and `c` is an ear if it turns left and no other corner that turns
//! right lies in the triangle `abc`. Every simple polygon has two ears (Meisters 1975); one
//! that crosses itself may have none, then any corner goes next, so that there are always n − 2
//! triangles.

use crate::math::Vector;
use crate::math::lane::Vec3;

/// Tests of a corner against a triangle, per corner of the polygon (a count). Bounds the time
/// on hostile input to about 20 µs per corner; ordinary polygons up to 64 corners never
/// reach it. When it is used up the rest is cut without tests.
const TESTS_PER_CORNER: usize = 4096;

/// Appends triangles for a polygon given by its corners. Repeated neighbours are removed first;
/// fewer than three corners give nothing. Orientation is kept.
pub(super) fn triangulate(corners: &mut Vec<u32>, vertices: &[Vector], into: &mut Vec<[u32; 3]>) {
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    match corners.as_slice() {
        [] | [_] | [_, _] => return,
        &[a, b, c] => return into.push([a, b, c]),
        _ => {}
    }
    let points = project(corners, vertices);
    let count = corners.len();
    let mut next: Vec<usize> = (1..=count).map(|i| i % count).collect();
    let mut previous: Vec<usize> = (0..count).map(|i| (i + count - 1) % count).collect();
    let mut reflex: Vec<usize> = (0..count)
        .filter(|&i| turn(points[previous[i]], points[i], points[next[i]]) <= 0.0)
        .collect();
    let mut tests = TESTS_PER_CORNER * count;
    let (mut at, mut left, mut refused) = (0, count, 0);
    while left > 3 {
        let (a, c) = (previous[at], next[at]);
        if refused < left && tests > 0 {
            tests = tests.saturating_sub(reflex.len());
            let triangle = [points[a], points[at], points[c]];
            let ear = turn(triangle[0], triangle[1], triangle[2]) > 0.0
                && !reflex.iter().any(|&r| contains(triangle, points[r]));
            if !ear {
                refused += 1;
                at = c;
                continue;
            }
        }
        into.push([corners[a], corners[at], corners[c]]);
        (next[a], previous[c]) = (c, a);
        (left, refused) = (left - 1, 0);
        if tests > 0 {
            tests = tests.saturating_sub(reflex.len());
            let turns_right = |r| turn(points[previous[r]], points[r], points[next[r]]) <= 0.0;
            reflex.retain(|&r| r != at && turns_right(r));
        }
        // Going on past the neighbour spreads the cuts, which avoids a fan of slivers.
        at = next[c];
    }
    into.push([corners[previous[at]], corners[at], corners[next[at]]]);
}

/// The polygon seen against its Newell normal: counter-clockwise as a whole.
fn project(corners: &[u32], vertices: &[Vector]) -> Vec<[f64; 2]> {
    let point = |i: usize| Vec3::<f64>::from_vector(vertices[corners[i % corners.len()] as usize]);
    let relative = |i: usize| point(i) - point(0);
    let normal = (0..corners.len())
        .map(|i| relative(i).cross(relative(i + 1)))
        .fold(Vec3::zero(), |sum, n| sum + n);
    // Dropping the largest component of the normal keeps all turns and inclusions.
    let (x, y, z) = (normal.x.abs(), normal.y.abs(), normal.z.abs());
    let flat = |p: Vec3<f64>| {
        if x >= y && x >= z {
            ([p.y, p.z], normal.x)
        } else if y >= z {
            ([p.z, p.x], normal.y)
        } else {
            ([p.x, p.y], normal.z)
        }
    };
    (0..corners.len())
        .map(|i| match flat(relative(i)) {
            ([a, b], facing) if facing < 0.0 => [b, a],
            (ab, _) => ab,
        })
        .collect()
}

/// Twice the signed area of a triangle: positive for a left turn.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a left-turning triangle contains `p`, border included, corners not: a polygon with a
/// hole runs along the same cut twice, and its other visit must not block an ear.
fn contains([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    let inside = turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    inside && ![a, b, c].contains(&p)
}
