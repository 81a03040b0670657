//! Measures how far a medial mesh is from a triangle mesh: the Hausdorff distance of their surfaces.
//!
//! # Method
//! Branch and bound (`largest.rs`), starting from whole triangles of the source, or from a box around
//! the solid. Sampling is thereby finer than a quarter of the error wherever the error may be
//! decided, and coarse elsewhere.
//!
//! A piece of the source is settled whole where the solid is smooth, however large: distances to
//! primitives are convex (`Solid::exit_of_any`). Cells have no such bound: where all of the boundary is
//! about equally far, as round a polygonal ring, they must be as small as the slack, which takes
//! millions, and the budget widens the slack instead.
//!
//! # Distances
//! - To the source: exact. Samples of the solid's boundary come from cells of space whose centre is
//!   nearer to it than the cell's radius, moved onto it: what lies inside other primitives never
//!   counts, and primitives that nearly coincide cost no more than one.
//! - From a source point outside the solid: its signed distance. Inside, its depth in the ball
//!   nearest to it, if that ball's surface is on the boundary there; else a straight way out,
//!   marched in steps that the depth allows (Hart, "Sphere tracing", 1996); where that would raise
//!   the result, the nearest point of the boundary itself. All are upper bounds: the error is never
//!   understated by them.
//! - A source point that the source itself encloses (a part stuck into another) is not on the
//!   boundary of anything: its distance is 0. Where such a part comes out again the bound above does
//!   not hold, and pieces of about the size of the error decide.

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use crate::meshing::certify::inside::{Cell, MOST_WAY, Solid};
use crate::meshing::certify::largest::{DividedSurface, Effort, LargestDistance, Look};
use crate::meshing::draft::Draft;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::subdivide;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::options::{Hausdorff, Progress};
use crate::meshing::surface::boundary::solid_boundary;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::hidden::is_before_matter;
use crate::meshing::surface::samples::vertex_samples;
use crate::meshing::watch::Watch;
use std::ops::ControlFlow;

/// Share of its length by which a way out of the solid may be overstated.
const EXIT_OVERESTIMATE: f64 = 0.05;

/// What a cell in a search for a way out costs, in pieces: measured on drums of many thin parts.
const CELL: f64 = 0.25;

/// Least step off the surface that tells an enclosed part from the outside (longest side 1).
const OFF_SURFACE: f64 = 1e-4;

/// Directions along which a piece of the source is moved to get out of the solid. Faces that meet in a reflex edge
/// are enlarged to cover rounding, and stand in each other's way: a corner of three needs two directions more than the
/// normal.
const EXIT_DIRECTIONS: usize = 3;

/// How far each direction turns away from what was in the way of the one before, in units of its length.
const EXIT_TILT: f64 = 0.05;

/// Length of a second way out (longest side 1), tried where a piece is nearly on the boundary. Its direction turns as
/// far as need be, since in a slit the other side is near. Twice the length by which bodies are enlarged to cover
/// rounding.
const SECOND_EXIT_LENGTH: f64 = 5e-6;

/// Pieces that the search in either direction (source to solid, solid to source) may examine before it becomes coarser:
/// about 0.2 s.
const PIECES: f64 = 3e5;

/// Pieces more for each primitive: about 0.3 s per thousand primitives. With both, the slack need not
/// grow above a quarter of the error for bug and dolphin at 500 primitives.
const PIECES_PER_PRIMITIVE: f64 = 500.0;

/// Measures how far a medial mesh is from a triangle mesh, both in the same frame and unit. Distances are in that
/// unit. Takes up to seconds if the error is far below a thousandth of the size.
///
/// # Errors
/// [`BuildError`] for a triangle mesh that [`MedialMesh::from_trimesh`] would refuse.
pub fn hausdorff(
    mesh: &MedialMesh,
    vertices: &[Vector],
    indices: &[[u32; 3]],
) -> Result<Hausdorff, BuildError> {
    let mut proceed = |_: Progress| ControlFlow::Continue(());
    let mut watch = Watch::new(&mut proceed);
    let (surface, tree) = Surface::new(vertices, indices, &mut watch)?;
    let draft = Draft::from_medial_mesh(mesh, &surface.frame);
    let mut findings = Findings::default();
    let boundary = solid_boundary(&surface, &tree, false, &mut findings, &mut watch)?;
    let (seen, seen_tree) = match &boundary {
        Some(boundary) => (&boundary.surface, &boundary.tree),
        None => (&surface, &tree),
    };
    let measured = measure(seen, seen_tree, &tree, &draft, Effort::FINE, &mut watch)?;
    Ok(in_unit(measured, surface.frame.scale))
}

/// A measurement in the builder's frame, in the user's unit.
pub(crate) fn in_unit(h: Hausdorff, scale: f64) -> Hausdorff {
    let scaled = |x: Real| (f64::from(x) * scale) as Real;
    Hausdorff {
        surface_to_envelope: scaled(h.surface_to_envelope),
        envelope_to_surface: scaled(h.envelope_to_surface),
        uncovered: scaled(h.uncovered),
        bloat: scaled(h.bloat),
        sampling: scaled(h.sampling),
    }
}

/// Measures a draft against the surface of `tree`; `winding` tells what is inside the source. Lengths are in the
/// builder's frame. Where
/// [`Effort::enough`] ends the search the result is below the true error, and above that.
pub(crate) fn measure(
    surface: &Surface,
    tree: &TriangleTree,
    winding: &TriangleTree,
    draft: &Draft,
    mut effort: Effort,
    watch: &mut Watch,
) -> Result<Hausdorff, BuildError> {
    let solid = Solid::new(draft);
    let mut source = FromSource {
        surface,
        winding,
        solid: &solid,
        uncovered: 0.0,
        hint: 0,
        cells: 0,
    };
    let mut start = 0.0f64;
    for (i, sample) in vertex_samples(surface).into_iter().enumerate() {
        if i % 512 == 0 {
            watch.at(0.0)?;
        }
        if let Look::Distance(d) = source.look_at(sample.point, sample.normal, start, start) {
            start = start.max(d);
        }
    }
    for p in surface.needle_corners().flatten() {
        if let Look::Distance(d) = source.look_at_needle(&[p; 3], p, start) {
            start = start.max(d);
        }
    }
    let budget = PIECES + PIECES_PER_PRIMITIVE * draft.primitives().len() as f64;
    let mut search = LargestDistance::new(&mut source, start, 0.0, effort, budget);
    let triangles = surface.all_corners().zip(0..surface.triangles.len() as u32);
    let needles = surface.needle_corners().map(|corners| (corners, NEEDLE));
    search.in_depth(triangles.chain(needles), |part| watch.at(0.5 * part))?;
    let (outward, slack) = (search.best, search.slack());
    // The other direction gets what this one did not need.
    let left = 2.0 * budget - search.spent() / effort.share;
    let mut boundary = FromBoundary {
        tree,
        solid: &solid,
        bloat: 0.0,
        hint: 0,
        triangle: 0,
    };
    if outward > effort.enough {
        effort.enough = 0.0;
    }
    // A distance below that of the other direction does not raise the error.
    let mut search = LargestDistance::new(&mut boundary, 0.0, outward, effort, left.max(budget));
    let mut tick = |part| watch.at(0.5 + 0.5 * part);
    let cells = search.in_breadth(vec![solid.whole()], &mut tick)?;
    search.in_depth(cells.iter().copied(), tick)?;
    let (inward, slack2) = (search.best, search.slack());
    Ok(Hausdorff {
        surface_to_envelope: outward as Real,
        envelope_to_surface: inward as Real,
        uncovered: source.uncovered as Real,
        bloat: boundary.bloat as Real,
        sampling: slack.max(slack2) as Real,
    })
}

/// Triangle index that stands for a piece without area, which has no normal.
const NEEDLE: u32 = u32::MAX;

/// Distance from the source surface to the solid's boundary. Pieces: triangles, each with the index of the source
/// triangle that it is part of, or [`NEEDLE`].
struct FromSource<'a> {
    surface: &'a Surface,
    winding: &'a TriangleTree,
    solid: &'a Solid<'a>,
    uncovered: f64,
    hint: u32,
    /// Cells that the last search for a way out looked at; 0 where there was none.
    cells: u64,
}

impl FromSource<'_> {
    /// Distance of the surface point `p` to the solid's boundary.
    fn look_at(&mut self, p: Point, normal: Point, allowed: f64, best: f64) -> Look {
        let leaves = |way: f64, towards: Point| self.solid.is_out(p + towards * way, self.hint);
        // Near enough to the primitive of the point before, and near enough to the outside.
        let sticks_out = self.solid.distance_to(self.hint, p).max(0.0);
        if sticks_out <= allowed.min(self.uncovered) && leaves(allowed, normal) {
            return Look::Settled;
        }
        if allowed < best && sticks_out <= best.min(self.uncovered) && leaves(best, normal) {
            return Look::Hidden(best);
        }
        let near = self.solid.nearest(p, self.hint);
        self.hint = near.primitive;
        let signed = near.signed.distance;
        if signed >= 0.0 {
            self.uncovered = self.uncovered.max(signed);
            return Look::Distance(signed);
        }
        // The nearest point of the ball that holds `p` is as near as the boundary can be.
        // On a ball's centre all ways are alike.
        let radial = p - self.solid.ball(&near).center;
        let outward = if radial.length() > 1e-9 {
            direction(radial)
        } else {
            normal
        };
        let leaves = |way: f64, towards: Point| self.solid.is_out(p + towards * way, self.hint);
        if leaves(-signed, outward) {
            let enclosed = -signed > best && self.is_enclosed(p, normal);
            return Look::Distance(if enclosed { 0.0 } else { -signed });
        }
        if allowed >= -signed && (leaves(allowed, normal) || leaves(allowed, outward)) {
            return Look::Settled;
        }
        let exit =
            |towards: Point, most: f64| self.solid.exit_distance(p, towards, most, self.hint);
        let way_up_to = |most: f64| exit(normal, most).min(exit(outward, most));
        // Where all ways are equally long, rounding alone must not start a search.
        let way = way_up_to(best * (1.0 + 1e-6));
        if way.is_finite() {
            return Look::Distance(way);
        }
        if self.is_enclosed(p, normal) {
            Look::Distance(0.0)
        } else {
            let way = way_up_to(MOST_WAY);
            // Shorter ways do not raise the result.
            let exit = self.solid.nearest_exit(p, [way, best], EXIT_OVERESTIMATE);
            self.cells = exit.cells;
            Look::Distance(exit.distance)
        }
    }

    /// How far the middle of a needle sticks out. Inside, it bounds nothing: its distance is 0. Settled
    /// where all of the needle sticks out of one primitive, which is convex, by no more than `allowed`.
    fn look_at_needle(&mut self, corners: &[Point; 3], center: Point, allowed: f64) -> Look {
        let to_hint = |p: Point| self.solid.distance_to(self.hint, p).max(0.0);
        if to_hint(center) <= self.uncovered && corners.iter().all(|&p| to_hint(p) <= allowed) {
            return Look::Settled;
        }
        let near = self.solid.nearest(center, self.hint);
        self.hint = near.primitive;
        let out = near.signed.distance.max(0.0);
        self.uncovered = self.uncovered.max(out);
        Look::Distance(out)
    }

    /// Whether each point of a triangle is within `allowed` of the boundary: it sticks out of one primitive by no more,
    /// and moved by as much or less, along its normal or a little away from what stands beside it, it is all outside.
    fn is_settled(&self, corners: &[Point; 3], center: Point, normal: Point, allowed: f64) -> bool {
        let to_hint = |p: Point| self.solid.distance_to(self.hint, p);
        if allowed < 0.0
            || to_hint(center).max(0.0) > self.uncovered
            || corners.iter().any(|&p| to_hint(p) > allowed)
        {
            return false;
        }
        let gets_out = |far: f64, tilt: f64| {
            let mut way = normal;
            (0..EXIT_DIRECTIONS).any(|_| {
                let moved = |p: Point| p + way * far;
                let (corners, center) = (corners.map(moved), moved(center));
                let inside = self.solid.exit_of_any(&corners, center, self.hint);
                way = direction(way + inside.unwrap_or(way) * tilt);
                inside.is_none()
            })
        };
        gets_out(allowed, EXIT_TILT)
            || allowed > SECOND_EXIT_LENGTH
                && to_hint(center) > -SECOND_EXIT_LENGTH
                && gets_out(SECOND_EXIT_LENGTH, 1.0)
    }

    /// Whether the surface point `p` lies inside matter that the source bounds, or at the bottom of a crack in it.
    fn is_enclosed(&self, p: Point, normal: Point) -> bool {
        let is_inside = |p: Point| self.winding.winding(p) > INSIDE;
        let off = OFF_SURFACE.max(self.surface.cracks);
        is_before_matter(self.winding, p, normal * off, is_inside)
    }
}

impl DividedSurface for FromSource<'_> {
    type Piece = ([Point; 3], u32);

    fn radius(&self, (corners, _): &Self::Piece) -> f64 {
        subdivide::radius(corners)
    }

    fn look(&mut self, piece: &Self::Piece, rho: f64, best: f64, allowed: f64) -> Look {
        let (corners, triangle) = piece;
        let [a, b, c] = *corners;
        let center = (a + b + c) * (1.0 / 3.0);
        self.cells = 0;
        let Some(&normal) = self.surface.normals.get(*triangle as usize) else {
            return self.look_at_needle(corners, center, allowed + rho);
        };
        if self.is_settled(corners, center, normal, allowed + rho) {
            return Look::Settled;
        }
        self.look_at(center, normal, allowed, best)
    }

    fn extra_work(&self) -> f64 {
        CELL * self.cells as f64
    }

    fn cut(&self, (corners, triangle): Self::Piece, pieces: &mut Vec<Self::Piece>) {
        pieces.extend(subdivide::quarter(corners).map(|part| (part, triangle)));
    }
}

/// Distance from the solid's boundary to the source surface. Pieces: cells of space that it may cross.
struct FromBoundary<'a> {
    tree: &'a TriangleTree,
    solid: &'a Solid<'a>,
    bloat: f64,
    hint: u32,
    /// A triangle near the cell before.
    triangle: u32,
}

impl DividedSurface for FromBoundary<'_> {
    type Piece = Cell;

    fn radius(&self, cell: &Cell) -> f64 {
        cell.radius()
    }

    fn look(&mut self, cell: &Cell, rho: f64, best: f64, allowed: f64) -> Look {
        // In this order, for the first two settle most and cost least.
        if self.tree.is_within(self.triangle, cell.center, allowed) {
            return Look::Settled;
        }
        let Some(near) = self.solid.nearest_if_near(cell.center, rho, self.hint) else {
            return Look::Settled;
        };
        self.hint = near.primitive;
        if let Some(triangle) = self.tree.some_within(cell.center, allowed) {
            self.triangle = triangle;
            return Look::Settled;
        }
        // A sample that raises neither result need not be measured: the cell is cut all the same. The
        // centre is no farther from the source than the sample and the way between them.
        let sample = self.solid.towards_boundary(cell.center, &near);
        let way = near.signed.distance.abs();
        let low = self.bloat.min(best);
        if self.tree.is_within(self.triangle, sample, low) {
            return Look::Hidden(low + way);
        }
        let (d, triangle) = self.tree.distance_from(sample, self.triangle);
        self.triangle = triangle;
        if d <= low || !self.solid.is_on_boundary(sample, &near) {
            return Look::Hidden(d + way);
        }
        if d > self.bloat && self.tree.signed_distance(sample, d) > 0.0 {
            self.bloat = d;
        }
        Look::Near(d, d + way)
    }

    fn cut(&self, cell: Cell, cells: &mut Vec<Cell>) {
        cells.extend(cell.children());
    }
}
