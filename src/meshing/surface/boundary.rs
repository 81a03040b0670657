//! The boundary of the solid that a surface winds around, where its parts overlap or pass through themselves: all
//! of its triangles but the pieces with matter on both sides, which are hidden.
//!
//! Source of the inside test: Jacobson et al., "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers" (2013). A triangle that another part passes through is halved until its pieces lie on one side; of the
//! smallest, those that are partly hidden stay. Small openings have lids there.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::subdivide::{halve, longest_edge_sq};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;

/// Distance before and behind the surface at which the winding number is asked for (longest side 1).
const OFF: f64 = 2e-4;

/// Winding number inside.
const INSIDE: f64 = 0.5;

/// Pieces with edges up to this are not halved (longest side 1); those with longer ones than the second are, for
/// seven probes would miss what passes through them.
const FINEST: f64 = 0.006;
const LARGE: f64 = 0.08;

/// Share of the area that is lost by rounding.
const ROUNDING: f64 = 1e-9;

/// What of a surface is not hidden inside matter.
pub struct Boundary {
    /// The pieces of triangles, and lids on what is open, as a surface.
    pub surface: Surface,
    /// Their tree.
    pub tree: TriangleTree,
    /// Area of what is hidden (longest side 1).
    pub hidden: f64,
}

/// The boundary of the matter that a surface winds around, with the sheets outside it; `None` where nothing is
/// hidden, or all, and nothing is open. `findings` is told what is hidden.
pub fn solid_boundary(
    surface: &Surface,
    tree: &TriangleTree,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Option<Boundary>, BuildError> {
    let is_mixed = [true, false]
        .iter()
        .all(|kind| surface.sheet.contains(kind));
    let hides = surface.findings.overlapping || findings.overlapping || is_mixed;
    if !hides && surface.lids.is_empty() {
        return Ok(None);
    }
    let mut pieces: Vec<([Point; 3], usize)> = Vec::new();
    let mut waiting = Vec::new();
    let patches = surface.patch_of.iter().max().map_or(0, |&p| p as usize + 1);
    let mut is_seen = vec![false; patches];
    let mut triangles = 0;
    for (t, corners) in surface.all_corners().enumerate() {
        let normal = surface.normals[t];
        let before = pieces.len();
        match hides {
            true => waiting.push(corners),
            false => pieces.push((corners, t)),
        }
        while let Some(piece) = waiting.pop() {
            watch.again()?;
            let longest_sq = longest_edge_sq(&piece);
            let middle = middle(&piece);
            let mut points = std::iter::once(middle).chain(probes(&piece, middle));
            if longest_sq > LARGE * LARGE {
                waiting.extend(halve(piece));
            } else if longest_sq <= FINEST * FINEST {
                if !points.all(|p| is_hidden(tree, p, normal)) {
                    pieces.push((piece, t));
                }
            } else {
                let here = is_hidden(tree, middle, normal);
                match points.all(|p| is_hidden(tree, p, normal) == here) {
                    true if here => {}
                    true => pieces.push((piece, t)),
                    false => waiting.extend(halve(piece)),
                }
            }
        }
        match pieces.len() > before {
            true => is_seen[surface.patch_of[t] as usize] = true,
            false => triangles += 1,
        }
    }
    let boundary = surface.of_pieces(&pieces);
    let added: f64 = surface.lids.iter().map(|lid| area(&lid.0)).sum();
    let hidden = surface.area + added - boundary.area;
    // Halves of a triangle add up to it but for rounding.
    let hidden = if hidden > ROUNDING * surface.area {
        hidden
    } else {
        0.0
    };
    if pieces.is_empty() || (hidden == 0.0 && surface.lids.is_empty()) {
        return Ok(None);
    }
    findings.triangles_hidden = triangles;
    findings.patches_hidden = is_seen.iter().filter(|seen| !**seen).count();
    let mut tree = TriangleTree::new(boundary.triangles.len(), |i| boundary.corners(i), watch)?;
    let counts = |i: u32| i8::from(!boundary.sheet[i as usize]);
    tree.recount(counts, watch)?;
    Ok(Some(Boundary {
        surface: boundary,
        tree,
        hidden,
    }))
}

/// Whether there is matter behind a point of the surface and before it.
fn is_hidden(tree: &TriangleTree, p: Point, normal: Point) -> bool {
    tree.winding(p + normal * OFF) > INSIDE && tree.winding(p - normal * OFF) > INSIDE
}

fn area(&[a, b, c]: &[Point; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
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
