//! The largest ball inside the surface that touches it at a given point, found by shrinking.
//!
//! Source: Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and the normal field" (2012):
//! a ball that touches `p` with inward normal `n` and holds the surface point `q` shrinks to the one through both, of
//! radius `|p − q|² / (2 n·(q − p))`.

use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::TriangleTree;

/// Radius at which shrinking starts (longest side 1). No ball inside a body whose longest side is 1 is larger.
const LARGEST_BALL: f64 = 0.5;

/// Radius at which shrinking ends (longest side 1). A ball of this radius may reach out of the surface.
pub const SMALLEST_BALL: f64 = 1e-3;

/// The largest ball inside the surface that touches `p`, where the inward normal is `n`.
pub fn shrink(tree: &TriangleTree, p: Point, n: Point) -> Ball {
    shrink_from(tree, p, n, LARGEST_BALL)
}

/// The ball, of radius `largest` at most.
pub fn shrink_from(tree: &TriangleTree, p: Point, n: Point, largest: f64) -> Ball {
    let mut radius = largest;
    // Thirty steps end all but those that creep, which are near enough by then.
    for _ in 0..30 {
        let center = p + n * radius;
        let Some(q) = tree.closest_within(center, radius) else {
            break;
        };
        if (q - center).length() >= radius * (1.0 - 1e-4) - 1e-6 {
            break;
        }
        let to = q - p;
        let smaller = to.length_sq() / (2.0 * n.dot(to));
        if !(smaller > 0.0 && smaller < radius) {
            break;
        }
        radius = smaller.max(SMALLEST_BALL);
        if radius <= SMALLEST_BALL {
            break;
        }
    }
    Ball {
        center: p + n * radius,
        radius,
    }
}
