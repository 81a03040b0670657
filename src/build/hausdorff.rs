//! Measured two-sided distance between a triangle mesh and the boundary of a medial mesh's solid.
//!
//! # Method
//! The distance to a set changes by at most the way one moves. So a piece of a surface with centre
//! `c` and radius `ρ` holds no point farther than `d(c) + ρ`. Starting from whole triangles (of the
//! source), or from a box (around the solid), pieces that could exceed the largest distance found
//! so far, `h`, by more than a quarter are cut, the others dropped. What is left when none are: a
//! distance `h` reached at a sample, and the certainty that no point exceeds `1.25 h`. Sampling is
//! thereby finer than a quarter of the error wherever the error may be decided, and coarse
//! elsewhere.
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

use super::bounds::{Point, direction};
use super::draft::Draft;
use super::options::{Hausdorff, Progress};
use super::samples::vertex_samples;
use super::solid::{Cell, Solid};
use super::subdivide;
use super::surface::Surface;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use std::ops::ControlFlow;

/// A piece is kept while it may exceed the largest distance found by more than this share of it.
const RESOLUTION: f64 = 0.25;

/// Pieces smaller than this (longest side 1) are not cut: below an error of four times this the
/// certainty is this and no longer a quarter.
const FINEST: f64 = 1e-4;

/// Pieces examined at most, on each side: about a second. Uniform errors, which no piece can be
/// excluded from, reach it below .004 of the size; the report then gives the spacing reached.
const BUDGET: usize = 400_000;

/// After the search, the piece that gave the largest distance is searched until the distance is
/// certain to within this share there.
const POLISH: f64 = 0.02;

/// Pieces examined at most for that.
const POLISH_BUDGET: usize = 4_000;

/// Step off the surface that tells an enclosed part from the outside (longest side 1).
const OFF_SURFACE: f64 = 1e-4;

/// Measures a medial mesh against a triangle mesh, both in the same frame and unit.
///
/// Distances are in that unit. Takes up to seconds for errors far below a thousandth of the size.
/// Fails on a triangle mesh that [`MedialMesh::from_trimesh`] would refuse.
pub fn hausdorff(
    mesh: &MedialMesh,
    vertices: &[Vector],
    indices: &[[u32; 3]],
) -> Result<Hausdorff, BuildError> {
    let mut proceed = |_: Progress| ControlFlow::Continue(());
    let mut watch = Watch::new(&mut proceed);
    let (surface, tree) = Surface::new(vertices, indices, &mut watch)?;
    let draft = Draft::from_medial_mesh(mesh, &surface.frame);
    let measured = measure(&surface, &tree, &draft, &mut watch)?;
    Ok(in_unit(measured, surface.frame.scale))
}

/// A measurement in the builder's frame, in the user's unit.
pub(super) fn in_unit(h: Hausdorff, scale: f64) -> Hausdorff {
    let scaled = |x: Real| (f64::from(x) * scale) as Real;
    Hausdorff {
        surface_to_envelope: scaled(h.surface_to_envelope),
        envelope_to_surface: scaled(h.envelope_to_surface),
        uncovered: scaled(h.uncovered),
        bloat: scaled(h.bloat),
        sampling: scaled(h.sampling),
    }
}

/// Measures a draft against the surface; lengths are in the builder's frame.
pub(super) fn measure(
    surface: &Surface,
    tree: &TriangleTree,
    draft: &Draft,
    watch: &mut Watch,
) -> Result<Hausdorff, BuildError> {
    let solid = Solid::new(draft);
    let mut source = FromSource {
        surface,
        tree,
        solid: &solid,
        uncovered: 0.0,
        hint: 0,
    };
    let mut start = 0.0f64;
    for (i, sample) in vertex_samples(surface).into_iter().enumerate() {
        if i % 512 == 0 {
            watch.at(0.0)?;
        }
        let look = source.look_at(sample.point, sample.normal, start, start);
        if let Look::Distance(d) = look {
            start = start.max(d);
        }
    }
    let triangles = surface.all_corners().zip(0..).collect();
    let (outward, rough) = largest(&mut source, triangles, start, |part| watch.at(0.5 * part))?;
    let mut boundary = FromBoundary {
        tree,
        solid: &solid,
        bloat: 0.0,
        hint: 0,
    };
    let whole = vec![solid.whole()];
    let (inward, rough2) = largest(&mut boundary, whole, 0.0, |part| watch.at(0.5 + 0.5 * part))?;
    let resolved = RESOLUTION * outward.max(inward);
    Ok(Hausdorff {
        surface_to_envelope: outward as Real,
        envelope_to_surface: inward as Real,
        uncovered: source.uncovered as Real,
        bloat: boundary.bloat as Real,
        sampling: rough.max(rough2).max(resolved) as Real,
    })
}

/// What the centre of a piece tells.
enum Look {
    /// Nothing in the piece can matter.
    Settled,
    /// Its distance to the other surface, reached by a sample there.
    Distance(f64),
    /// A sample near it has the first distance; its own is at most the second.
    Near(f64, f64),
    /// It gives no sample of its own, but other points of the piece may.
    Hidden,
}

/// A surface in pieces, to find the largest distance over.
trait Side {
    /// A piece of it.
    type Piece: Copy;
    /// Distance from a piece's centre to its farthest point.
    fn radius(&self, piece: &Self::Piece) -> f64;
    /// Examines the centre of a piece of radius `rho`: `best` is the largest distance so far, and a
    /// distance up to `allowed` at the centre settles the piece.
    fn look(&mut self, piece: &Self::Piece, rho: f64, best: f64, allowed: f64) -> Look;
    /// Cuts a piece into smaller ones.
    fn cut(&self, piece: Self::Piece, pieces: &mut Vec<Self::Piece>);
}

/// Largest distance over all pieces, at least `start`, and the radius of the largest piece left
/// unresolved.
fn largest<S: Side>(
    side: &mut S,
    pieces: Vec<S::Piece>,
    start: f64,
    tick: impl FnMut(f64) -> Result<(), BuildError>,
) -> Result<(f64, f64), BuildError> {
    let mut search = Search {
        side,
        best: start,
        top: None,
        unresolved: 0.0,
        examined: 0,
    };
    search.run(pieces, RESOLUTION, BUDGET, tick)?;
    let unresolved = search.unresolved;
    if let Some(top) = search.top {
        search.examined = 0;
        search.run(vec![top], POLISH, POLISH_BUDGET, |_| Ok(()))?;
    }
    Ok((search.best, unresolved))
}

struct Search<'a, S: Side> {
    side: &'a mut S,
    best: f64,
    /// The piece that gave `best`.
    top: Option<S::Piece>,
    unresolved: f64,
    examined: usize,
}

impl<S: Side> Search<'_, S> {
    /// Cuts pieces, level by level, until none can exceed the best by more than `resolution` of it.
    fn run(
        &mut self,
        mut level: Vec<S::Piece>,
        resolution: f64,
        budget: usize,
        mut tick: impl FnMut(f64) -> Result<(), BuildError>,
    ) -> Result<(), BuildError> {
        while !level.is_empty() {
            let mut next = Vec::new();
            let count = level.len();
            for (i, piece) in level.into_iter().enumerate() {
                if i % 128 == 0 {
                    tick(i as f64 / count as f64)?;
                }
                let rho = self.side.radius(&piece);
                if self.is_settled(&piece, rho, resolution) {
                    continue;
                }
                if rho > FINEST && self.examined < budget {
                    self.side.cut(piece, &mut next);
                } else {
                    self.unresolved = self.unresolved.max(rho);
                }
            }
            level = next;
        }
        Ok(())
    }

    fn is_settled(&mut self, piece: &S::Piece, rho: f64, resolution: f64) -> bool {
        self.examined += 1;
        let allowed = |best: f64| (1.0 + resolution) * best - rho;
        let look = self.side.look(piece, rho, self.best, allowed(self.best));
        let (sample, bound) = match look {
            Look::Settled => return true,
            Look::Hidden => return false,
            Look::Distance(d) => (d, d),
            Look::Near(sample, bound) => (sample, bound),
        };
        if sample > self.best {
            self.best = sample;
            self.top = Some(*piece);
        }
        bound <= allowed(self.best)
    }
}

/// From the source surface to the solid's boundary. Pieces: triangles, each with the index of the
/// source triangle that it is part of.
struct FromSource<'a> {
    surface: &'a Surface,
    tree: &'a TriangleTree,
    solid: &'a Solid<'a>,
    uncovered: f64,
    hint: u32,
}

impl FromSource<'_> {
    /// Distance of the surface point `p` to the solid's boundary.
    fn look_at(&mut self, p: Point, normal: Point, allowed: f64, best: f64) -> Look {
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
        let way_out = |towards: Point| self.solid.way_out(p, towards, self.hint);
        let way = way_out(normal).min(way_out(outward));
        // Where all ways are equally long, rounding alone must not start a search.
        if way <= best * (1.0 + 1e-6) {
            return Look::Distance(way);
        }
        if self.is_enclosed(p, normal) {
            Look::Distance(0.0)
        } else {
            Look::Distance(self.solid.nearest_exit(p, way))
        }
    }

    /// Whether the surface point `p` lies inside matter that the source bounds.
    fn is_enclosed(&self, p: Point, normal: Point) -> bool {
        self.tree.winding(p + normal * OFF_SURFACE) > 0.5
    }
}

impl Side for FromSource<'_> {
    type Piece = ([Point; 3], u32);

    fn radius(&self, (corners, _): &Self::Piece) -> f64 {
        subdivide::radius(corners)
    }

    fn look(&mut self, piece: &Self::Piece, _rho: f64, best: f64, allowed: f64) -> Look {
        let (corners, triangle) = piece;
        let normal = self.surface.normals[*triangle as usize];
        let [a, b, c] = *corners;
        let center = (a + b + c) * (1.0 / 3.0);
        self.look_at(center, normal, allowed, best)
    }

    fn cut(&self, (corners, triangle): Self::Piece, pieces: &mut Vec<Self::Piece>) {
        pieces.extend(subdivide::quarter(corners).map(|part| (part, triangle)));
    }
}

/// From the solid's boundary to the source surface. Pieces: cells of space that it may cross.
struct FromBoundary<'a> {
    tree: &'a TriangleTree,
    solid: &'a Solid<'a>,
    bloat: f64,
    hint: u32,
}

impl Side for FromBoundary<'_> {
    type Piece = Cell;

    fn radius(&self, cell: &Cell) -> f64 {
        cell.radius()
    }

    fn look(&mut self, cell: &Cell, rho: f64, _best: f64, allowed: f64) -> Look {
        if self.tree.any_within(cell.center, allowed) {
            return Look::Settled;
        }
        let near = self.solid.nearest(cell.center, self.hint);
        self.hint = near.primitive;
        if near.signed.distance.abs() > rho {
            return Look::Settled;
        }
        match self.solid.onto_boundary(cell.center, &near) {
            Some(sample) => {
                let d = self.tree.distance(sample);
                if d > self.bloat && self.tree.signed_distance(sample, d) > 0.0 {
                    self.bloat = d;
                }
                Look::Near(d, d + near.signed.distance.abs())
            }
            None => Look::Hidden,
        }
    }

    fn cut(&self, cell: Cell, cells: &mut Vec<Cell>) {
        cells.extend(cell.children());
    }
}
