//! How far a draft is from the surface, sample by sample, and which balls answer for it.
//!
//! A surface sample belongs to the primitive nearest to it; its residual is the signed distance.
//! An envelope sample is a point of the solid's boundary; its residual is minus the signed distance
//! to the surface: negative where the solid bulges out. To first order
//! ```text
//! d(residual) = −Σ αₖ (n·Δcₖ + Δrₖ)
//! ```
//! with the weights `α` of the primitive's balls there and the outward normal `n`, because the
//! derivative of a minimum over `α` is that of its argument at the minimum (envelope theorem).
//! Sources of the terms: signed distance, paper Eq. (2); one-sided residuals both ways as in Thiery
//! et al., "Sphere-Meshes" (2013), §5.

use crate::error::BuildError;
use crate::meshing::certify::inside::{Cell, MOST_WAY, Solid};
use crate::meshing::certify::primitive_tree::NearestPrimitive;
use crate::meshing::draft::{Ball, Corners, Draft};
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::chunks::{VERY_COSTLY, map_chunks, map_each};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::samples::Sample;
use crate::meshing::watch::{Watch, bytes_of};

/// Share of its length by which a way out of the solid may be overstated. With a third of it searches look at 1.7 to 2
/// times as many cells for a sample, and the M16 nut and bolt of 500 primitives are off by the same to 2 %.
const EXIT_OVERESTIMATE: f64 = 0.15;

/// Nodes of a tree that take as long to look at as a cell of a search for a way out.
const NODES_OF_CELL: u64 = 40;

/// A sample, the balls that answer for it, and what is wrong there.
#[derive(Clone, Copy)]
pub struct ResidualRow {
    /// Balls of its primitive.
    pub corners: Corners,
    /// Weights of the corners; sum 1.
    pub weights: [f64; 3],
    /// Outward unit normal of the solid.
    pub normal: Point,
    /// Length by which the solid should grow there.
    pub residual: f64,
    /// Weight of its square.
    pub weight: f64,
    /// Point of the sample.
    pub point: Point,
    /// Index of the primitive that the sample is of.
    pub primitive: u32,
}

/// A point of the solid's boundary, by the ball that it lies on: it moves with the ball.
#[derive(Clone, Copy)]
pub struct EnvelopeSample {
    primitive: u32,
    weights: [f64; 3],
    normal: Point,
    /// The triangle that was nearest to it, or [`UNKNOWN`].
    triangle: u32,
}

/// Marks a sample without a triangle or a primitive yet: the sample before, which is likely near, gives the hint.
pub const UNKNOWN: u32 = u32::MAX;

impl EnvelopeSample {
    /// Point where it is now, and the corners of its primitive.
    pub fn at(&self, draft: &Draft, solid: &Solid) -> (Point, Corners) {
        let corners = solid.primitives()[self.primitive as usize];
        let ball = Ball::interpolate(draft.balls_of(corners), self.weights);
        (ball.center + self.normal * ball.radius, corners)
    }
}

/// All rows of a draft: surface samples first, then envelope samples.
pub struct Residuals {
    /// The rows.
    pub rows: Vec<ResidualRow>,
    /// How many of them are surface samples.
    pub surface_rows: usize,
    /// Largest residual of either kind.
    pub largest: f64,
    /// Number by which fits are compared: the largest residual plus twice the root mean square.
    pub score: f64,
}

/// Points of the boundary of the solid, about `spacing` apart.
pub fn envelope_samples(
    solid: &Solid,
    spacing: f64,
    watch: &mut Watch,
) -> Result<Vec<EnvelopeSample>, BuildError> {
    // A shell of cells one radius wide on both sides holds √3 cells per square of their side.
    let side = spacing * 3f64.sqrt().sqrt();
    let whole = solid.whole();
    let mut start = whole.with_side(side);
    while start.side() < whole.side() {
        start = start.with_side(2.0 * start.side());
    }
    let mut cells: Vec<(Cell, u32)> = vec![(start, 0)];
    while cells.first().is_some_and(|c| c.0.side() > 1.5 * side) {
        cells = map_chunks(&cells, watch, |chunk| {
            let mut children = Vec::new();
            for &(cell, hint) in chunk {
                if let Some(near) = solid.nearest_if_near(cell.center, cell.radius(), hint) {
                    children.extend(cell.children().map(|child| (child, near.primitive)));
                }
            }
            children
        })?;
    }
    map_chunks(&cells, watch, |chunk| {
        let mut samples = Vec::new();
        for &(cell, hint) in chunk {
            let Some(near) = solid.nearest_if_near(cell.center, cell.radius(), hint) else {
                continue;
            };
            if let Some(point) = solid.onto_boundary(cell.center, &near) {
                samples.push(EnvelopeSample {
                    primitive: near.primitive,
                    weights: near.signed.weights,
                    normal: direction(point - solid.ball(&near).center),
                    triangle: UNKNOWN,
                });
            }
        }
        samples
    })
}

/// Examines a draft at surface samples, each with the primitive it had last, and at envelope
/// samples. Where the solid may reach `beyond` the surface, residuals are what it reaches farther (negative) and
/// what it does not cover.
pub fn residuals(
    draft: &Draft,
    tree: &TriangleTree,
    samples: &[Sample],
    hints: &mut [u32],
    envelope: &mut [EnvelopeSample],
    beyond: f64,
    watch: &mut Watch,
) -> Result<Residuals, BuildError> {
    let solid = Solid::new(draft);
    let paired: Vec<(Sample, u32)> = samples.iter().copied().zip(hints.iter().copied()).collect();
    let counted = surface_rows(&solid, &paired, beyond, watch)?;
    let mut work = counted.iter().map(|c| c.1).sum();
    let mut rows: Vec<ResidualRow> = counted.into_iter().map(|c| c.0).collect();
    for (hint, row) in hints.iter_mut().zip(&rows) {
        *hint = row.primitive;
    }
    let surface_rows = rows.len();
    let share = surface_rows as f64 / envelope.len().max(1) as f64;
    let outer = envelope_rows(draft, &solid, tree, (envelope, share), beyond, watch)?;
    for (sample, (row, triangle, looked_at)) in envelope.iter_mut().zip(outer) {
        sample.triangle = triangle;
        rows.push(row);
        work += looked_at;
    }
    watch.count_fit(envelope.len(), work);
    watch.hold(bytes_of(&rows) + bytes_of(&paired) + size_of_val(envelope));
    let largest = rows.iter().map(|r| r.residual.abs()).fold(0.0, f64::max);
    let sum = |f: fn(&ResidualRow) -> f64| rows.iter().map(f).sum::<f64>();
    let squares = sum(|r| r.weight * r.residual * r.residual);
    let rms = (squares / sum(|r| r.weight).max(f64::MIN_POSITIVE)).sqrt();
    Ok(Residuals {
        rows,
        surface_rows,
        largest,
        score: largest + 2.0 * rms,
    })
}

/// Rows of surface samples, each with the primitive it had last, and the nodes that searches for ways out looked at.
fn surface_rows(
    solid: &Solid,
    paired: &[(Sample, u32)],
    beyond: f64,
    watch: &mut Watch,
) -> Result<Vec<(ResidualRow, u64)>, BuildError> {
    let row =
        |point: Point, near: &NearestPrimitive, residual: f64, on_boundary: Point| ResidualRow {
            corners: solid.primitives()[near.primitive as usize],
            weights: near.signed.weights,
            normal: direction(on_boundary - solid.ball(near).center),
            residual,
            weight: 1.0,
            point,
            primitive: near.primitive,
        };
    let found = map_chunks(paired, watch, |chunk| {
        let mut last = 0;
        let found = |&(sample, hint): &(Sample, u32)| {
            let near = solid.nearest(sample.point, if hint == UNKNOWN { last } else { hint });
            last = near.primitive;
            let mut residual = near.signed.distance;
            let is_deep = beyond > 0.0 && is_far_inside(solid, &sample, &near, beyond);
            if beyond > 0.0 && residual < 0.0 {
                residual = (residual + beyond).min(0.0);
            }
            let row = row(sample.point, &near, residual, sample.point);
            (row, is_deep.then_some(near))
        };
        chunk.iter().map(found).collect()
    })?;
    let (mut rows, mut deep) = (Vec::with_capacity(found.len()), Vec::new());
    for (i, (row, near)) in found.into_iter().enumerate() {
        rows.push((row, 0));
        deep.extend(near.map(|near| (i, near)));
    }
    // Ways out take long, and only few samples are deep.
    let exits = map_each(VERY_COSTLY, &deep, watch, |(i, near)| {
        let (sample, _) = &paired[*i];
        let mut work = 0;
        let exit = way_out(solid, sample, near.primitive, beyond, &mut work);
        let deepest = exit.map(|exit| {
            let residual = beyond - (exit - sample.point).length();
            // Shrinking the ball there shortens the way.
            let near = solid.nearest(exit, near.primitive);
            row(sample.point, &near, residual.min(0.0), exit)
        });
        (*i, deepest, work)
    })?;
    for (i, deepest, work) in exits {
        rows[i].1 = work;
        if let Some(deepest) = deepest {
            rows[i].0 = deepest;
        }
    }
    Ok(rows)
}

/// Rows of envelope samples of which each weighs `share`, the triangle nearest to each, and the number of nodes and
/// triangles that the search for it looked at.
fn envelope_rows(
    draft: &Draft,
    solid: &Solid,
    tree: &TriangleTree,
    (envelope, share): (&[EnvelopeSample], f64),
    beyond: f64,
    watch: &mut Watch,
) -> Result<Vec<(ResidualRow, u32, u64)>, BuildError> {
    map_chunks(envelope, watch, |chunk| {
        let mut hint = 0;
        let row = |sample: &EnvelopeSample| {
            let (point, corners) = sample.at(draft, solid);
            if sample.triangle != UNKNOWN {
                hint = sample.triangle;
            }
            let mut work = 0;
            let (nearest, triangle) = tree.closest_counted(point, hint, &mut work);
            hint = triangle;
            let off = point - nearest;
            let (distance, along) = (off.length(), off.dot(sample.normal));
            let mut residual = if along > 0.0 { -distance } else { distance };
            if beyond > 0.0 {
                residual = (residual + beyond).min(0.0);
            }
            // Where the way to the surface is across the normal, growing does not help.
            let cosine = if distance > 1e-9 {
                along / distance
            } else {
                1.0
            };
            let row = ResidualRow {
                corners,
                weights: sample.weights,
                normal: sample.normal,
                residual,
                weight: share * cosine * cosine,
                point,
                primitive: sample.primitive,
            };
            (row, triangle, work)
        };
        chunk.iter().map(row).collect()
    })
}

/// Whether a sample is inside the solid, its way out along its normal is longer than `beyond`, and the nearest point of
/// the primitive that is deepest there is inside other primitives.
pub fn is_far_inside(solid: &Solid, sample: &Sample, near: &NearestPrimitive, beyond: f64) -> bool {
    near.signed.distance < 0.0
        && !solid.is_out(sample.point + sample.normal * beyond, near.primitive)
        && solid.onto_boundary(sample.point, near).is_none()
}

/// End of a way out of the solid from a sample that [`is_far_inside`], which is longer than the shortest by at most
/// [`EXIT_OVERESTIMATE`] of it, or is no longer than `beyond`; `hint` is a primitive near it. Nodes that the search
/// looked at are added to `work`.
pub fn way_out(
    solid: &Solid,
    sample: &Sample,
    hint: u32,
    beyond: f64,
    work: &mut u64,
) -> Option<Point> {
    let p = sample.point;
    let way = solid.exit_distance(p, sample.normal, MOST_WAY, hint);
    let straight = way.is_finite().then(|| p + sample.normal * way);
    let nearest = solid.nearest_exit(p, [way, beyond], EXIT_OVERESTIMATE);
    *work += NODES_OF_CELL * nearest.cells;
    nearest.point.or(straight)
}
