//! How many samples thin walls need. Samples nearer to each other than a wall is thick give balls between its faces.
//! Samples more than twice as far apart as that give none, and the wall becomes slabs (`start.rs`). In between a wall
//! is partly both, and neither fits: cups whose walls are .8 or 1 % of their height came out 7 to 10 % off.

use crate::error::BuildError;
use crate::meshing::axis::shrinking_ball::{SMALLEST_BALL, shrink_from};
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::samples::even_samples;
use crate::meshing::watch::Watch;

/// Points at which the thickness is looked at, each for as much of the surface.
const PROBES: usize = 1_000;

/// Distances between samples, over the thickness, between which a wall is neither balls nor slabs.
const NEITHER: [f64; 2] = [1.15, 2.3];

/// Multiples of the number of samples that are tried.
const TIMES: [usize; 3] = [1, 2, 4];

/// Share of the surface that may be neither.
const MAX_UNDECIDED: f64 = 0.25;

/// How many times as many samples walls need as there are a distance apart, one to four: the fewest with which little
/// of the surface is of walls in between; 1 if there is no such number.
pub fn times_for_walls(
    surface: &Surface,
    tree: &TriangleTree,
    distance: f64,
    watch: &mut Watch,
) -> Result<usize, BuildError> {
    let probes = even_samples(surface, PROBES, &mut Random::new(1));
    let mut thicknesses = Vec::with_capacity(PROBES);
    for (i, probe) in probes.iter().enumerate() {
        if i % 64 == 0 {
            watch.again()?;
        }
        let ball = shrink_from(tree, probe.point, -probe.normal, distance);
        thicknesses.push(2.0 * ball.radius);
    }
    let is_neither = |thickness: &&f64, distance: f64| {
        let [balls, slabs] = NEITHER;
        let ratio = distance / **thickness;
        // Smaller balls are not told apart.
        **thickness > 2.0 * SMALLEST_BALL && ratio > balls && ratio < slabs
    };
    let neither = |times: usize| {
        let distance = distance / (times as f64).sqrt();
        let some = thicknesses.iter().filter(|t| is_neither(t, distance));
        some.count() as f64 / thicknesses.len().max(1) as f64
    };
    let times = TIMES
        .into_iter()
        .find(|times| neither(*times) <= MAX_UNDECIDED);
    Ok(times.unwrap_or(1))
}
