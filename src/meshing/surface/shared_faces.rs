//! Leaves out the faces that two parts share where they touch: triangles given once with either orientation, with
//! matter on both sides. They bound nothing.
//!
//! Such a pair adds nothing to the winding number, so that of the other triangles tells what is around it. It counts
//! those parts alone whose surface is closed, where it is a whole number. What is not inside these is a sheet with two
//! sides, of which one stays.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::triangle::points_inside;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::checked_surface::corners;
use crate::meshing::surface::edges::Edges;
use crate::meshing::surface::weld::Welded;
use crate::meshing::watch::Watch;

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

/// The triangles but for the pairs, of those parts that these leave closed: each edge is used as often one way as the
/// other.
fn closed_parts(
    welded: &Welded,
    is_pair: &[bool],
    watch: &mut Watch,
) -> Result<Vec<usize>, BuildError> {
    let mut parts = Groups::new(welded.vertices.len());
    for (i, &[a, b, c]) in welded.triangles.iter().enumerate() {
        watch.every(i)?;
        parts.join(a, b);
        parts.join(b, c);
    }
    let others: Vec<usize> = (0..is_pair.len()).filter(|&t| !is_pair[t]).collect();
    let triangles: Vec<[u32; 3]> = others.iter().map(|&t| welded.triangles[t]).collect();
    let edges = Edges::new(welded.vertices.len(), &triangles, watch)?;
    let mut is_open = vec![false; welded.vertices.len()];
    for (i, (ends, uses)) in edges.iter().enumerate() {
        watch.every(i)?;
        if 2 * uses.iter().filter(|u| u.forward()).count() != uses.len() {
            is_open[parts.find(ends[0]) as usize] = true;
        }
    }
    let mut closed = others;
    closed.retain(|&t| !is_open[parts.find(welded.triangles[t][0]) as usize]);
    Ok(closed)
}
