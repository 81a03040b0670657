//! The bodies that the triangles of a surface bound, where some touch along whole faces and share the edges of these.
//!
//! Around an edge of more than two triangles matter begins and ends at triangles by turns. Two that bound the same
//! matter are of one body.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::edges::{Edges, Use};
use crate::meshing::watch::Watch;

/// A full turn, as [`turn_of`] counts.
const FULL: f64 = 4.0;

/// Turn below which two triangles at an edge lie on each other.
const SAME: f64 = 1e-4;

/// The triangles of each body, in the order of their first ones.
pub fn bodies(surface: &Surface, watch: &mut Watch) -> Result<Vec<Vec<usize>>, BuildError> {
    let count = surface.triangles.len();
    let edges = Edges::new(surface.vertices.len(), &surface.triangles, watch)?;
    let mut groups = Groups::new(count);
    for (i, (ends, uses)) in edges.iter().enumerate() {
        watch.every(i)?;
        let mut join = |a: &Use, b: &Use| groups.join(a.triangle() as u32, b.triangle() as u32);
        match uses {
            [a, b] => join(a, b),
            _ => around_matter(surface, ends, uses)
                .into_iter()
                .for_each(|(a, b)| join(a, b)),
        }
    }
    let mut bodies: Vec<Vec<usize>> = vec![Vec::new(); count];
    for t in 0..count {
        bodies[groups.find(t as u32) as usize].push(t);
    }
    bodies.retain(|body| !body.is_empty());
    Ok(bodies)
}

/// Pairs of triangles at an edge between which there is matter and no other triangle.
fn around_matter<'a>(
    surface: &Surface,
    [lo, hi]: [u32; 2],
    uses: &'a [Use],
) -> Vec<(&'a Use, &'a Use)> {
    let at = |v: u32| surface.vertices[v as usize];
    let axis = direction(at(hi) - at(lo));
    let across = |used: &Use| {
        let corners = surface.triangles[used.triangle()];
        let third = corners.into_iter().find(|v| *v != lo && *v != hi);
        let way = third.map_or(Point::zero(), at) - at(lo);
        way - axis * way.dot(axis)
    };
    let first = direction(uses.first().map_or(Point::zero(), across));
    let second = axis.cross(first);
    let turn = |used: &'a Use| {
        let way = across(used);
        (used, turn_of(way.dot(first), way.dot(second)))
    };
    let turns: Vec<(&Use, f64)> = uses.iter().map(turn).collect();
    // A triangle that runs from the lower vertex to the higher faces the way in which turns grow: matter ends there.
    let turn_to = |from: f64, to: f64| match (to - from).rem_euclid(FULL) {
        turn if !(SAME..=FULL - SAME).contains(&turn) => FULL,
        turn => turn,
    };
    let pair = |&(begins, from): &(&'a Use, f64)| {
        let ends = turns.iter().filter(|other| other.0.forward());
        let end = ends.min_by(|x, y| turn_to(from, x.1).total_cmp(&turn_to(from, y.1)))?;
        let between = |turn: f64| turn_to(from, turn) < turn_to(from, end.1) - SAME;
        let is_alone = turns.iter().all(|other| !between(other.1));
        (turn_to(from, end.1) < FULL && is_alone).then_some((begins, end.0))
    };
    let begin = turns.iter().filter(|turn| !turn.0.forward());
    begin.filter_map(pair).collect()
}

/// Turn from the first axis to a way given by its parts along both: it grows with the angle, from 0 to [`FULL`].
fn turn_of(along_first: f64, along_second: f64) -> f64 {
    let sum = along_first.abs() + along_second.abs();
    let height = along_second / sum.max(f64::MIN_POSITIVE);
    match (along_first >= 0.0, along_second >= 0.0) {
        (true, true) => height,
        (false, _) => 2.0 - height,
        (true, false) => FULL + height,
    }
}
