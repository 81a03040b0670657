//! A flat polygon with holes cut into triangles by its ears, the ones least flat first (Meisters, "Polygons have ears",
//! 1975); holes are joined to the outline by their shortest bridges first.

use crate::meshing::geometry::bounds::Point;

/// Twice the area of a triangle in the plane, positive if its corners go round to the left.
fn twice_area(a: Point, b: Point, c: Point) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Area of a polygon in the plane, negative if it goes round to the right.
pub fn polygon_area(points: &[Point]) -> f64 {
    let n = points.len();
    let twice = (0..n).map(|k| {
        let (p, q) = (points[k], points[(k + 1) % n]);
        p.x * q.y - p.y * q.x
    });
    0.5 * twice.sum::<f64>()
}

/// Triangles of what loops of points bound, matter on their left: `at` gives the places of points in the plane. What is
/// not simple, by rounding, is cut too, as well as can be.
pub fn polygon_triangles(loops: Vec<Vec<u32>>, at: impl Fn(u32) -> Point) -> Vec<[u32; 3]> {
    let area = |around: &Vec<u32>| {
        let fan = around.windows(2);
        let parts = fan.map(|w| twice_area(at(around[0]), at(w[0]), at(w[1])));
        parts.sum::<f64>()
    };
    let (mut outlines, mut holes): (Vec<_>, Vec<_>) =
        loops.into_iter().partition(|around| area(around) > 0.0);
    while let Some((hole, i, outline, j)) = bridge(&outlines, &holes, &at) {
        let mut around = holes.swap_remove(hole);
        around.rotate_left(i);
        around.push(around[0]);
        let outline: &mut Vec<u32> = &mut outlines[outline];
        around.push(outline[j]);
        outline.splice(j + 1..j + 1, around);
    }
    let mut triangles = Vec::new();
    for outline in outlines {
        cut_ears(outline, &at, &mut triangles);
    }
    triangles
}

/// The shortest segment between a hole and an outline that crosses neither: hole, its corner, outline, its corner.
fn bridge(
    outlines: &[Vec<u32>],
    holes: &[Vec<u32>],
    at: impl Fn(u32) -> Point,
) -> Option<(usize, usize, usize, usize)> {
    let all = || outlines.iter().chain(holes);
    let crosses = |p: u32, q: u32| {
        all().any(|around| {
            (0..around.len()).any(|k| {
                let (a, b) = (around[k], around[(k + 1) % around.len()]);
                let shares = [a, b].iter().any(|v| *v == p || *v == q);
                let [p, q, a, b] = [p, q, a, b].map(&at);
                !shares
                    && twice_area(p, q, a) * twice_area(p, q, b) <= 0.0
                    && twice_area(a, b, p) * twice_area(a, b, q) <= 0.0
            })
        })
    };
    let mut best: Option<(f64, (usize, usize, usize, usize))> = None;
    for (hole, around) in holes.iter().enumerate() {
        for (outline, other) in outlines.iter().enumerate() {
            for (i, p) in around.iter().enumerate() {
                for (j, q) in other.iter().enumerate() {
                    let length = (at(*p) - at(*q)).length_sq();
                    if best.is_none_or(|b| length < b.0) && !crosses(*p, *q) {
                        best = Some((length, (hole, i, outline, j)));
                    }
                }
            }
        }
    }
    best.map(|b| b.1)
}

/// Cuts off ears until nothing is left.
fn cut_ears(mut around: Vec<u32>, at: impl Fn(u32) -> Point, triangles: &mut Vec<[u32; 3]>) {
    while around.len() > 2 {
        let n = around.len();
        let mut best = (f64::NEG_INFINITY, 0);
        for k in 0..n {
            let ear = [around[(k + n - 1) % n], around[k], around[(k + 1) % n]];
            let [a, b, c] = ear.map(&at);
            let area = twice_area(a, b, c);
            let longest = [b - a, c - b, a - c].map(|side| side.length_sq());
            let longest = longest.into_iter().fold(f64::MIN_POSITIVE, f64::max);
            let holds = |v: &&u32| {
                let p = at(**v);
                !ear.contains(v)
                    && twice_area(a, b, p) >= 0.0
                    && twice_area(b, c, p) >= 0.0
                    && twice_area(c, a, p) >= 0.0
            };
            // A triangle that holds other corners is no ear, but the least bad is cut where there is none.
            let shape = area / longest;
            let worst = if area > 0.0 && around.iter().any(|v| holds(&v)) {
                -2.0
            } else {
                0.0
            };
            if shape + worst > best.0 {
                best = (shape + worst, k);
            }
        }
        let k = best.1;
        let ear = [around[(k + n - 1) % n], around[k], around[(k + 1) % n]];
        around.remove(k);
        if ear[0] != ear[1] && ear[1] != ear[2] && ear[2] != ear[0] {
            triangles.push(ear);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a square about the middle, to the left or to the right.
    fn square(half: f64, left: bool) -> Vec<Point> {
        let corner = |&(x, y): &(f64, f64)| Point::new(x * half, y * half, 0.0);
        let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let mut points: Vec<Point> = around.iter().map(corner).collect();
        if !left {
            points.reverse();
        }
        points
    }

    #[test]
    fn a_square_with_a_hole_has_eight_triangles_of_its_area() {
        let points = [square(2.0, true), square(1.0, false)].concat();
        let at = |v: u32| points[v as usize];
        let triangles = polygon_triangles(vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7]], at);
        assert_eq!(triangles.len(), 8);
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.map(at);
            0.5 * twice_area(a, b, c)
        });
        let areas: Vec<f64> = areas.collect();
        assert!(areas.iter().all(|a| *a > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - 12.0).abs() < 1e-12);
    }
}
