//! Seams: an edge of one triangle along which the edges of others run, cut at more vertices (T-junctions), and chains
//! of edges along each other, cut at different vertices.
//!
//! Nothing is missing there but a sliver without area between the edge and the chain of the others, or between two
//! chains. Such slivers close the surface, and no vertex moves.

use crate::error::BuildError;
use crate::math::fast_hash::{FastMap, FastSet};
use crate::medial::simplex::sorted;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::surface::edges::Edges;
use crate::meshing::watch::Watch;

/// Distance (longest side 1) by which vertices of a chain may be off the edge: modellers round to four digits.
pub const OFF: f64 = 1e-4;

/// Vertices of two chains along each other, at most.
const MOST_IN_LOOP: usize = 64;

/// Slivers that close the seams of a surface.
pub fn seam_slivers(
    vertices: &[Point],
    triangles: &[[u32; 3]],
    watch: &mut Watch,
) -> Result<Vec<[u32; 3]>, BuildError> {
    // Open edges, in the direction in which their triangles use them.
    let mut open: Vec<[u32; 2]> = Vec::new();
    for (i, ([lo, hi], uses)) in Edges::new(vertices.len(), triangles, watch)?
        .iter()
        .enumerate()
    {
        watch.every(i)?;
        if let [only] = uses {
            open.push(if only.forward() { [lo, hi] } else { [hi, lo] });
        }
    }
    let mut joined: FastMap<u32, Vec<u32>> = FastMap::default();
    for &[a, b] in &open {
        joined.entry(a).or_default().push(b);
        joined.entry(b).or_default().push(a);
    }
    let mut closed: FastSet<[u32; 2]> = FastSet::default();
    let mut slivers = Vec::new();
    for (i, &[a, b]) in open.iter().enumerate() {
        watch.every(i)?;
        let Some(chain) = chain(vertices, &joined, [a, b]) else {
            continue;
        };
        let links = || chain.windows(2).map(|link| sorted([link[0], link[1]]));
        if closed.contains(&sorted([a, b])) || links().any(|link| closed.contains(&link)) {
            continue;
        }
        closed.extend(links().chain([sorted([a, b])]));
        let inner = &chain[..chain.len() - 1];
        slivers.extend(inner.windows(2).map(|link| [link[0], link[1], b]));
    }
    open.retain(|edge| !closed.contains(&sorted(*edge)));
    close_loops(vertices, &open, &mut slivers, watch)?;
    Ok(slivers)
}

/// Adds fans of slivers between open edges that lead back to where they start along one line.
fn close_loops(
    vertices: &[Point],
    open: &[[u32; 2]],
    slivers: &mut Vec<[u32; 3]>,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    // A sliver passes the edges that it closes in the other direction.
    let mut onward: FastMap<u32, Vec<u32>> = FastMap::default();
    for &[to, from] in open {
        onward.entry(from).or_default().push(to);
    }
    let mut closed: FastSet<[u32; 2]> = FastSet::default();
    for (i, &[second, first]) in open.iter().enumerate() {
        watch.every(i)?;
        if closed.contains(&[first, second]) {
            continue;
        }
        let from = vertices[first as usize];
        let way = direction(vertices[second as usize] - from);
        let is_on = |v: u32| {
            let to = vertices[v as usize] - from;
            (to - way * to.dot(way)).length() <= OFF
        };
        let mut around = vec![first, second];
        let mut here = second;
        while here != first && around.len() <= MOST_IN_LOOP {
            let next = onward.get(&here).into_iter().flatten().copied();
            let mut next = next.filter(|&v| {
                let is_new = v == first || !around.contains(&v);
                is_new && !closed.contains(&[here, v]) && is_on(v)
            });
            let Some(v) = next.next() else {
                break;
            };
            here = v;
            around.push(v);
        }
        if here != first || around.len() < 4 {
            continue;
        }
        closed.extend(around.windows(2).map(|edge| [edge[0], edge[1]]));
        let fan = around[1..around.len() - 1].windows(2);
        slivers.extend(fan.map(|edge| [first, edge[0], edge[1]]));
    }
    Ok(())
}

/// The vertices of open edges that lead from one end of an open edge to the other along it, ends included.
fn chain(
    vertices: &[Point],
    joined: &FastMap<u32, Vec<u32>>,
    [a, b]: [u32; 2],
) -> Option<Vec<u32>> {
    let at = |v: u32| vertices[v as usize];
    let way = at(b) - at(a);
    let length = way.length();
    let along = |v: u32| (at(v) - at(a)).dot(way) / length;
    let is_on = |v: u32| (at(v) - at(a) - way * (along(v) / length)).length() <= OFF;
    let mut chain = vec![a];
    let mut here = a;
    while here != b {
        let onward = joined.get(&here)?.iter().copied();
        let onward = onward.filter(|&v| [here, v] != [a, b] && along(v) > along(here) && is_on(v));
        here = onward.min_by(|&u, &v| along(u).total_cmp(&along(v)))?;
        if along(here) > length {
            return None;
        }
        chain.push(here);
    }
    Some(chain)
}
