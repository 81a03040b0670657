//! Additional costs of collapses in a medial mesh with creases, for damage that the quadrics do not see.
//!
//! The quadrics measure how well balls touch the planes around them. On a flat sheet all planes agree on every
//! ball, and moving it costs nothing, so the sheet could fold over its own outline. And a slab between balls of
//! radius 0 may span a notch and still touch all its planes.

use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::{GUESS, TriangleTree};
use crate::meshing::simplify::complex::Complex;

/// Cosine of the turn of a face beyond which it counts as turned over.
const TURNED: f64 = 0.2;

/// Cost of turned faces over their area (twice it; longest side 1): a sheet folds before it is off by more
/// than a tenth.
const FOLD_COST: f64 = 10.0;

/// Faces smaller than this (twice their area) have no direction that counts.
const NO_AREA: f64 = 1e-8;

/// A ball that moves by less (longest side 1) stays where it is.
const STILL: f64 = 1e-9;

/// Cost of the faces at either end of an edge that turn over when both become `ball`.
pub fn fold_cost(complex: &Complex, [a, b]: [u32; 2], ball: &Ball) -> f64 {
    let at = |v: u32| complex.balls[v as usize].center;
    let normal = |p: [Point; 3]| (p[1] - p[0]).cross(p[2] - p[0]);
    let mut sum = 0.0;
    for (moved, other) in [(a, b), (b, a)] {
        if stays(&complex.balls[moved as usize], ball) {
            continue;
        }
        for face in complex.faces_at(moved).filter(|f| !f.contains(&other)) {
            let before = normal(face.map(at));
            let after = normal(face.map(|v| if v == moved { ball.center } else { at(v) }));
            let (long_before, long_after) = (before.length(), after.length());
            let turned = before.dot(after) < TURNED * long_before * long_after;
            if turned && long_after > NO_AREA {
                sum += long_after.min(long_before.max(1e-3 * long_after));
            }
        }
    }
    FOLD_COST * sum
}

/// Distance by which the merged ball of an edge, and the middles of the primitives around it, stick out of the solid; 0
/// where none does.
pub fn stick_out(complex: &Complex, tree: &TriangleTree, ab: [u32; 2], ball: &Ball) -> f64 {
    let middles = ab.into_iter().flat_map(|v| middles(complex, ab, v, ball));
    let out = |b: Ball| b.radius + tree.signed_distance(b.center, 1.2 * b.radius.max(GUESS));
    middles.chain([*ball]).map(out).fold(0.0, f64::max)
}

/// Lower bound of [`stick_out`], found far more quickly; 0 if nothing is found to stick out by more than `least`
/// (longest side 1). Balls no thicker than `least` are not looked at, nor those whose centres are outside the solid by
/// more than their radius.
pub fn stick_out_beyond(
    least: f64,
    complex: &Complex,
    tree: &TriangleTree,
    ab: [u32; 2],
    ball: &Ball,
) -> f64 {
    let moves = |v: &u32| !stays(&complex.balls[*v as usize], ball);
    let moved = ab.into_iter().filter(moves);
    let middles = moved.flat_map(|v| middles(complex, ab, v, ball));
    let mut most = least;
    for b in middles.chain([*ball]) {
        let within = b.radius - most;
        if within > 0.0 && tree.any_within(b.center, within) {
            let out = b.radius + tree.signed_distance(b.center, 1.2 * b.radius.max(GUESS));
            most = most.max(out);
        }
    }
    if most > least { most } else { 0.0 }
}

/// Whether a ball that becomes another stays where it is.
fn stays(ball: &Ball, becomes: &Ball) -> bool {
    let way = (ball.center - becomes.center).length();
    way + (ball.radius - becomes.radius).abs() <= STILL
}

/// The middles of the edges and faces that one end of the edge `ab` brings along when both become `ball`.
fn middles<'a>(
    complex: &'a Complex,
    [a, b]: [u32; 2],
    moved: u32,
    ball: &'a Ball,
) -> impl Iterator<Item = Ball> + 'a {
    let other = a + b - moved;
    let ends = complex
        .neighbors(moved)
        .iter()
        .filter(move |&&v| v != other);
    let edges = ends.map(move |&v| {
        let end = complex.balls[v as usize];
        Ball::interpolate([*ball, end, end], [0.5, 0.5, 0.0])
    });
    let faces = complex.faces_at(moved).filter(move |f| !f.contains(&other));
    let slabs = faces.map(move |face| {
        let of = |v: u32| {
            if v == moved {
                *ball
            } else {
                complex.balls[v as usize]
            }
        };
        Ball::interpolate(face.map(of), [1.0 / 3.0; 3])
    });
    slabs.chain(edges)
}
