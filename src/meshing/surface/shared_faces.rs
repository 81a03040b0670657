//! Leaves out the faces that two parts share where they touch: triangles given once with either orientation, with
//! matter on both sides. They bound nothing.
//!
//! Such a pair adds nothing to the winding number, so that of the other triangles tells what is around it. It counts
//! those parts alone whose surface is closed but for small openings, where it is about a whole number. What is not
//! inside these is a sheet with two sides, of which one stays.
//!
//! What is open of a part is told by the vectors of the areas that its rims go around, in which edges along each other
//! that are cut at different vertices (T-junctions) cancel out.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle::points_inside;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::checked_surface::{corners, cross};
use crate::meshing::surface::edges::Edges;
use crate::meshing::surface::openings::{OPEN, WIDE};
use crate::meshing::surface::weld::Welded;
use crate::meshing::watch::Watch;
use std::f64::consts::PI;

/// How far points near a triangle's border are from it, as a share of the way to the middle.
const INWARD: f64 = 1e-3;

/// Leaves out of a welded mesh those of the triangles given in both orientations that have matter on both sides.
pub fn leave_out_shared(
    welded: &mut Welded,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let pairs = std::mem::take(&mut welded.both_ways);
    if pairs.is_empty() {
        return Ok(());
    }
    let mut is_pair = vec![false; welded.triangles.len()];
    pairs.iter().for_each(|&t| is_pair[t] = true);
    let closed = closed_parts(welded, &is_pair, watch)?;
    if closed.is_empty() {
        return Ok(());
    }
    let corners_of = |t: usize| corners(&welded.vertices, &welded.triangles[t]);
    let tree = TriangleTree::new(closed.len(), |i| corners_of(closed[i]), watch)?;
    let mut is_inside = vec![false; is_pair.len()];
    for (i, &t) in pairs.iter().enumerate() {
        if i % 64 == 0 {
            watch.again()?;
        }
        // A sheet that leaves a solid has points outside.
        let mut points = points_inside(&corners_of(t), INWARD).into_iter();
        is_inside[t] = points.all(|p| tree.winding(p).abs() > INSIDE);
    }
    let inside = is_inside.iter().filter(|inside| **inside).count();
    findings.triangles_repeated -= inside;
    findings.triangles_shared = 2 * inside;
    let mut keep = is_inside.into_iter().map(|inside| !inside);
    welded.triangles.retain(|_| keep.next().unwrap_or(true));
    welded.leave_out_unused();
    Ok(())
}

/// The triangles but for the pairs, of those parts that these leave closed, but for small openings.
fn closed_parts(
    welded: &Welded,
    is_pair: &[bool],
    watch: &mut Watch,
) -> Result<Vec<usize>, BuildError> {
    let Welded {
        vertices,
        triangles,
        ..
    } = welded;
    let mut parts = Groups::new(vertices.len());
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        watch.every(i)?;
        parts.join(a, b);
        parts.join(b, c);
    }
    let mut closed: Vec<usize> = (0..is_pair.len()).filter(|&t| !is_pair[t]).collect();
    let mut left = vec![0.0; vertices.len()];
    for t in &closed {
        let area = 0.5 * cross(corners(vertices, &triangles[*t])).length();
        left[parts.find(triangles[*t][0]) as usize] += OPEN * area;
    }
    let others: Vec<[u32; 3]> = closed.iter().map(|&t| triangles[t]).collect();
    for (rim, area) in rims(vertices, &others, watch)? {
        let is_wide = area > PI * WIDE * WIDE;
        left[parts.find(rim) as usize] -= if is_wide { f64::INFINITY } else { area };
    }
    closed.retain(|&t| left[parts.find(triangles[t][0]) as usize] >= 0.0);
    Ok(closed)
}

/// The rims of what triangles leave open: connected edges that are not used as often one way as the other. Each has a
/// vertex, and the length of the vector of the area that it goes around.
fn rims(
    vertices: &[Point],
    triangles: &[[u32; 3]],
    watch: &mut Watch,
) -> Result<Vec<(u32, f64)>, BuildError> {
    let edges = Edges::new(vertices.len(), triangles, watch)?;
    let mut rims = Groups::new(vertices.len());
    let mut open = Vec::new();
    for (i, ([a, b], uses)) in edges.iter().enumerate() {
        watch.every(i)?;
        let forward = uses.iter().filter(|u| u.forward()).count();
        if 2 * forward != uses.len() {
            rims.join(a, b);
            open.push(([a, b], 2.0 * forward as f64 - uses.len() as f64));
        }
    }
    let mut vectors = vec![Point::zero(); vertices.len()];
    for &([a, b], times) in &open {
        let [p, q] = [a, b].map(|v| vertices[v as usize]);
        let vector = &mut vectors[rims.find(a) as usize];
        *vector = *vector + p.cross(q) * (0.5 * times);
    }
    let around = open.into_iter().filter(|&([a, _], _)| rims.find(a) == a);
    let mut around: Vec<u32> = around.map(|([a, _], _)| a).collect();
    around.dedup();
    Ok(around
        .into_iter()
        .map(|v| (v, vectors[v as usize].length()))
        .collect())
}
