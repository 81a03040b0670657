//! Cutting triangles into smaller ones.

use crate::meshing::geometry::bounds::Point;

/// Squared length of the longest edge.
pub fn longest_edge_sq(&[a, b, c]: &[Point; 3]) -> f64 {
    (b - a)
        .length_sq()
        .max((c - b).length_sq())
        .max((a - c).length_sq())
}

/// Distance from the middle of a triangle to its farthest corner.
pub fn radius(&[a, b, c]: &[Point; 3]) -> f64 {
    let middle = (a + b + c) * (1.0 / 3.0);
    let distance_sq = |p: Point| (p - middle).length_sq();
    distance_sq(a)
        .max(distance_sq(b))
        .max(distance_sq(c))
        .sqrt()
}

/// Halves a triangle at the middle of its longest edge; a segment, its last two corners one, at its middle.
pub fn halve(t: [Point; 3]) -> [[Point; 3]; 2] {
    if t[1] == t[2] {
        let middle = (t[0] + t[1]) * 0.5;
        return [[t[0], middle, middle], [middle, t[1], t[1]]];
    }
    let length_sq = |k: usize| (t[(k + 1) % 3] - t[k]).length_sq();
    let k = (0..3).fold(0, |k, j| if length_sq(j) > length_sq(k) { j } else { k });
    let [a, b, c] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
    let middle = (a + b) * 0.5;
    [[a, middle, c], [middle, b, c]]
}

/// Halves a triangle twice: needles become compact before they become small.
pub fn quarter(t: [Point; 3]) -> [[Point; 3]; 4] {
    let [a, b] = halve(t);
    let ([a, b], [c, d]) = (halve(a), halve(b));
    [a, b, c, d]
}
