//! Leaves out the faces that two parts share where they touch: triangles given once with either orientation, with
//! matter on both sides. They bound nothing.
//!
//! Such a pair adds nothing to the winding number, so that of the other triangles tells what is around it. It counts
//! those parts alone whose surface is closed but for small openings, where it is about a whole number. What is not
//! inside these is a sheet with two sides, of which one stays.

use crate::error::BuildError;
use crate::medial::simplex::sorted;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::{Bounds, Point, direction};
use crate::meshing::geometry::triangle::points_inside;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::checked_surface::{corners, cross};
use crate::meshing::surface::edges::Edges;
use crate::meshing::surface::openings::{OPEN, WIDE};
use crate::meshing::surface::seams::OFF;
use crate::meshing::surface::weld::Welded;
use crate::meshing::watch::Watch;
use std::collections::BTreeMap;

/// How far points near a triangle's border are from it, as a share of the way to the middle.
const INWARD: f64 = 1e-3;

/// Corners of open edges that are connected, at most, where these are cut: each edge is compared with all of them.
const MOST_CORNERS: usize = 1_000;

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
    let open = open_edges(vertices, &others, watch)?;
    for (rim, width) in rims(vertices, &open) {
        let is_wide = width > 2.0 * WIDE;
        left[parts.find(rim) as usize] -= if is_wide {
            f64::INFINITY
        } else {
            width * width
        };
    }
    closed.retain(|&t| left[parts.find(triangles[t][0]) as usize] >= 0.0);
    Ok(closed)
}

/// Edges that triangles do not use as often one way as the other, where all are cut at the vertices of others that lie
/// on them: seams (`seams.rs`) are none.
fn open_edges(
    vertices: &[Point],
    triangles: &[[u32; 3]],
    watch: &mut Watch,
) -> Result<Vec<[u32; 2]>, BuildError> {
    let mut uneven: Vec<([u32; 2], i64)> = Vec::new();
    for (i, (ends, uses)) in Edges::new(vertices.len(), triangles, watch)?
        .iter()
        .enumerate()
    {
        watch.every(i)?;
        let forward = uses.iter().filter(|u| u.forward()).count();
        if 2 * forward != uses.len() {
            uneven.push((ends, 2 * forward as i64 - uses.len() as i64));
        }
    }
    let mut groups = Groups::new(vertices.len());
    uneven.iter().for_each(|&([a, b], _)| groups.join(a, b));
    uneven.sort_by_key(|&([a, _], _)| groups.find(a));
    let mut open = Vec::new();
    for group in uneven.chunk_by(|x, y| groups.find(x.0[0]) == groups.find(y.0[0])) {
        let mut corners: Vec<u32> = group.iter().flat_map(|edge| edge.0).collect();
        corners.sort_unstable();
        corners.dedup();
        if corners.len() > MOST_CORNERS {
            open.extend(group.iter().map(|edge| edge.0));
            continue;
        }
        let mut times: BTreeMap<[u32; 2], i64> = BTreeMap::new();
        for &(ends, uses) in group {
            watch.again()?;
            for link in cut(vertices, ends, &corners).windows(2) {
                let way = if link[0] < link[1] { 1 } else { -1 };
                *times.entry(sorted([link[0], link[1]])).or_default() += way * uses;
            }
        }
        open.extend(
            times
                .iter()
                .filter(|(_, uses)| **uses != 0)
                .map(|(ends, _)| *ends),
        );
    }
    Ok(open)
}

/// The ends of an edge, and in between those vertices that lie on it.
fn cut(vertices: &[Point], [a, b]: [u32; 2], others: &[u32]) -> Vec<u32> {
    let at = |v: u32| vertices[v as usize] - vertices[a as usize];
    let (way, length) = (direction(at(b)), at(b).length());
    let along = |v: u32| at(v).dot(way);
    let is_on = |v: &u32| {
        let there = along(*v);
        *v != a
            && *v != b
            && there > 0.0
            && there < length
            && (at(*v) - way * there).length() <= OFF
    };
    let mut inner: Vec<u32> = others.iter().copied().filter(is_on).collect();
    inner.sort_by(|u, v| along(*u).total_cmp(&along(*v)));
    [vec![a], inner, vec![b]].concat()
}

/// The rims that open edges form, each by a vertex and the longest side of its box.
fn rims(vertices: &[Point], open: &[[u32; 2]]) -> Vec<(u32, f64)> {
    let mut groups = Groups::new(vertices.len());
    open.iter().for_each(|&[a, b]| groups.join(a, b));
    let mut boxes: BTreeMap<u32, Bounds> = BTreeMap::new();
    for edge in open {
        let around = boxes.entry(groups.find(edge[0])).or_insert(Bounds::EMPTY);
        *around = around.union(Bounds::of(edge.map(|v| vertices[v as usize])));
    }
    let width = |(rim, around): (u32, Bounds)| (rim, around.longest_side());
    boxes.into_iter().map(width).collect()
}
