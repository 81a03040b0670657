//! The boundary of the solid that a surface winds around, where its parts overlap, pass through themselves or have
//! gaps: the pieces of its triangles with matter behind them and none before.
//!
//! Source of the inside test: Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers" (2013). A triangle that another part passes through is halved until its pieces lie on one side.

use super::bounds::Point;
use super::subdivide::{halve, longest_edge_sq};
use super::surface::Surface;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// Distance before and behind the surface at which the winding number is asked for (longest side 1).
const OFF: f64 = 2e-4;

/// Winding number inside.
const INSIDE: f64 = 0.5;

/// Pieces with edges up to this are not halved (longest side 1); those with longer ones than the second are, for
/// seven probes would miss what passes through them.
const FINEST: f64 = 0.006;
const LARGE: f64 = 0.08;

/// The boundary of what a surface winds around, and its tree; `None` where nothing of the surface is on it.
pub fn solid_boundary(
    surface: &Surface,
    tree: &TriangleTree,
    watch: &mut Watch,
) -> Result<Option<(Surface, TriangleTree)>, BuildError> {
    let mut pieces: Vec<([Point; 3], usize)> = Vec::new();
    let mut waiting = Vec::new();
    for (t, corners) in surface.all_corners().enumerate() {
        let normal = surface.normals[t];
        waiting.push(corners);
        while let Some(piece) = waiting.pop() {
            watch.again()?;
            let longest_sq = longest_edge_sq(&piece);
            let middle = middle(&piece);
            let bounds = |p: Point| bounds(tree, p, normal);
            let whole = longest_sq <= FINEST * FINEST
                || (longest_sq <= LARGE * LARGE && {
                    let here = bounds(middle);
                    probes(&piece, middle).all(|p| bounds(p) == here)
                });
            match whole {
                true if bounds(middle) => pieces.push((piece, t)),
                true => {}
                false => waiting.extend(halve(piece)),
            }
        }
    }
    if pieces.is_empty() {
        return Ok(None);
    }
    let boundary = surface.of_pieces(&pieces);
    let tree = TriangleTree::new(pieces.len(), |i| pieces[i].0, watch)?;
    Ok(Some((boundary, tree)))
}

/// Whether there is matter behind a point of the surface and none before it.
fn bounds(tree: &TriangleTree, p: Point, normal: Point) -> bool {
    tree.winding(p + normal * OFF) < INSIDE && tree.winding(p - normal * OFF) > INSIDE
}

fn middle(&[a, b, c]: &[Point; 3]) -> Point {
    (a + b + c) * (1.0 / 3.0)
}

/// Points near the corners and the middles of the sides.
fn probes(piece: &[Point; 3], middle: Point) -> impl Iterator<Item = Point> + '_ {
    let near = move |p: Point| p * 0.9 + middle * 0.1;
    let at = move |k: usize| [piece[k], (piece[k] + piece[(k + 1) % 3]) * 0.5];
    (0..3).flat_map(at).map(near)
}
