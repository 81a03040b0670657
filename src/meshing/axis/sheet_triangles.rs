//! A convex polygon cut into triangles, of which the flattest is as little flat as can be.
//!
//! Source: Klincsek, "Minimal triangulations of polygonal domains" (1980): the best for each run of corners from
//! the best of its parts. The cost of a triangle is its longest edge over its height.

use crate::meshing::geometry::bounds::Point;

/// Polygons of more corners are cut from one of them: the cost is cubic.
const MAX_OPTIMAL_CORNERS: usize = 60;

/// Cost of a triangle without height, and more.
const FLATTEST: f64 = 1e12;

/// The triangles of a polygon, less those lower than `no_height`, and the sum of the heights of those.
pub fn sheet_triangles(
    polygon: &[u32],
    at: impl Fn(u32) -> Point,
    no_height: f64,
) -> (Vec<[u32; 3]>, f64) {
    let n = polygon.len();
    let mut triangles = Vec::new();
    if n < 3 {
        return (triangles, 0.0);
    }
    let points: Vec<Point> = polygon.iter().map(|&v| at(v)).collect();
    let height = |t: [usize; 3]| height(t.map(|k| points[k]));
    let cost = |t: [usize; 3]| {
        let (height, longest) = height(t);
        (longest / height.max(f64::MIN_POSITIVE)).min(FLATTEST)
    };
    let mut waiting = vec![(0, n - 1)];
    // For each run of corners the cost, and the third corner of the triangle on its chord.
    let mut best = vec![(0.0, 0); if n <= MAX_OPTIMAL_CORNERS { n * n } else { 0 }];
    if n <= MAX_OPTIMAL_CORNERS {
        for length in 2..n {
            for from in 0..n - length {
                let to = from + length;
                let of = |k: usize| best[from * n + k].0 + best[k * n + to].0 + cost([from, k, to]);
                let third = (from + 1..to).map(|k| (of(k), k));
                let least = third.min_by(|x, y| x.0.total_cmp(&y.0));
                best[from * n + to] = least.unwrap_or((0.0, from + 1));
            }
        }
    }
    let mut lost = 0.0;
    while let Some((from, to)) = waiting.pop() {
        if to < from + 2 {
            continue;
        }
        let third = match n <= MAX_OPTIMAL_CORNERS {
            true => best[from * n + to].1,
            false => to - 1,
        };
        waiting.extend([(from, third), (third, to)]);
        let own = [from, third, to];
        let corners = own.map(|k| polygon[k]);
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            continue;
        }
        match height(own).0 {
            low if low < no_height => lost += low,
            _ => triangles.push(corners),
        }
    }
    (triangles, lost)
}

/// Height of a triangle over its longest edge, and the length of that edge.
fn height([a, b, c]: [Point; 3]) -> (f64, f64) {
    let sides = [b - a, c - b, a - c].map(|side| side.length());
    let longest = sides.into_iter().fold(0.0, f64::max);
    let twice = (b - a).cross(c - a).length();
    (twice / longest.max(f64::MIN_POSITIVE), longest)
}
