//! Enclosure: radii are raised until the solid covers the whole source surface, and the lids of its small
//! openings, and a certificate proves it.
//!
//! # Dilation
//! An uncovered point at distance `d` from the ball of weights `α` is reached when the radii grow
//! by `Δrₖ = d αₖ / Σ α²`: then `Σ αₖ Δrₖ = d`, with the smallest sum of squares. Each ball takes
//! the largest growth that any point asks for.
//!
//! # Certificate
//! Balls, cones and slabs are convex. A triangle whose three corners lie in one primitive therefore
//! lies in it whole. Other triangles are cut where one primitive's part of them ends (`coverage_cuts.rs`), or halved; a
//! piece of the smallest size that no primitive contains makes the one that needs least grow by its worst
//! corner. The certificate is complete when a pass over all triangles finds no such piece; it holds up to
//! rounding.

use crate::error::BuildError;
use crate::meshing::certify::coverage_cuts::{Cut, cut_covered};
use crate::meshing::certify::primitive_tree::DraftTree;
use crate::meshing::draft::{Draft, Signed};
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::subdivide::{halve, longest_edge_sq};
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::samples::{even_samples, vertex_samples};
use crate::meshing::watch::Watch;

/// Points that dilation looks at, besides all vertices. The certificate finds the rest: more
/// points cost more than they save it.
const POINTS: usize = 30_000;

/// Passes of dilation. Each point may need a ball that another point's growth made nearer; two or
/// three passes settle nearly all.
const DILATION_PASSES: usize = 8;

/// Longest edge of the smallest pieces of the certificate (longest side 1), up to [`FINEST_UP_TO`] primitives. A piece
/// that needs two primitives makes one of them grow by up to this much.
const FINEST: f64 = 0.002;

/// Number of primitives above which the smallest pieces shrink as primitives do: more primitives have smaller errors.
const FINEST_UP_TO: f64 = 500.0;

/// Passes of the certificate before all balls grow alike. Measured: 2 to 5 are needed.
const CERTIFICATE_PASSES: usize = 12;

/// A piece that a primitive misses by no more than this (longest side 1) makes it grow instead of being cut. With less
/// more pieces are cut; errors of fits are above a hundred times this.
const NEGLIGIBLE: f64 = 1e-5;

/// Growth beyond what a piece needs (longest side 1), so that rounding does not ask again.
const MARGIN: f64 = 1e-9;

/// Raises radii until every triangle of the surface is proven to stick out of the solid by at most
/// `allowed`: to lie in the solid whose radii are all larger by that.
pub fn enclose(
    draft: &mut Draft,
    surface: &Surface,
    allowed: f64,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let before: Vec<f64> = draft.balls.iter().map(|b| b.radius).collect();
    // The certificate is about welded vertices; the source's own are this near.
    let slack = (allowed - surface.welded).max(0.0);
    let welded = (surface.welded - allowed).max(0.0);
    draft.balls.iter_mut().for_each(|b| b.radius += slack);
    dilate(draft, surface, watch)?;
    certify(draft, surface, watch)?;
    for (ball, before) in draft.balls.iter_mut().zip(before) {
        // Taking the slack back must not shrink, by rounding, what never grew.
        ball.radius = (ball.radius - slack).max(before) + welded;
    }
    Ok(())
}

/// Length by which each ball must grow.
struct Growth(Vec<f64>);

impl Growth {
    fn none(draft: &Draft) -> Self {
        Self(vec![0.0; draft.balls.len()])
    }

    fn ask(&mut self, corners: [u32; 3], signed: &Signed) {
        let squares: f64 = signed.weights.iter().map(|w| w * w).sum();
        for (v, w) in corners.into_iter().zip(signed.weights) {
            let growth = (signed.distance + MARGIN) * w / squares;
            let most = &mut self.0[v as usize];
            *most = most.max(growth);
        }
    }

    fn apply(&self, draft: &mut Draft) {
        for (ball, growth) in draft.balls.iter_mut().zip(&self.0) {
            ball.radius += growth;
        }
    }
}

fn dilate(draft: &mut Draft, surface: &Surface, watch: &mut Watch) -> Result<(), BuildError> {
    let spread = even_samples(surface, POINTS, &mut Random::new(3));
    let vertices = vertex_samples(surface);
    let points = vertices.into_iter().chain(spread).map(|s| s.point);
    let points = points.chain(surface.lids.iter().flat_map(|lid| lid.0));
    let mut uncovered: Vec<Point> = points.chain(surface.needle_corners().flatten()).collect();
    for pass in 0..DILATION_PASSES {
        let mut growth = Growth::none(draft);
        let tree = DraftTree::new(draft);
        let mut hint = 0;
        let mut left = Vec::new();
        for (i, &p) in uncovered.iter().enumerate() {
            if i % 512 == 0 {
                let done = (pass as f64 + i as f64 / uncovered.len() as f64).min(2.0);
                watch.at(0.2 * done)?;
            }
            let nearest = tree.nearest_between(p, 0.0, f64::INFINITY, hint);
            hint = nearest.primitive;
            if nearest.signed.distance > 0.0 {
                growth.ask(tree.primitives()[hint as usize], &nearest.signed);
                left.push(p);
            }
        }
        drop(tree);
        growth.apply(draft);
        if left.is_empty() {
            break;
        }
        uncovered = left;
    }
    Ok(())
}

fn certify(draft: &mut Draft, surface: &Surface, watch: &mut Watch) -> Result<(), BuildError> {
    let triangles = surface.all_corners().chain(surface.needle_corners());
    let triangles = triangles.chain(surface.lids.iter().map(|lid| lid.0));
    let mut open: Vec<[Point; 3]> = triangles.collect();
    let crowd = (draft.primitives().len() as f64 / FINEST_UP_TO).max(1.0);
    for pass in 0..CERTIFICATE_PASSES {
        let mut growth = Growth::none(draft);
        let tree = DraftTree::new(draft);
        let mut prover = Prover {
            tree: &tree,
            hint: 0,
            worst: 0.0,
            finest_sq: FINEST * FINEST / crowd,
        };
        // Radii only grow, so what is proven stays so.
        let mut left = Vec::new();
        for (i, &piece) in open.iter().enumerate() {
            let done = (pass as f64 + i as f64 / open.len() as f64).min(3.0);
            let mut tick = || watch.at(0.4 + 0.2 * done);
            if i % 64 == 0 {
                tick()?;
            }
            prover.prove(piece, &mut growth, &mut left, &mut tick)?;
        }
        let worst = prover.worst;
        drop(tree);
        if left.is_empty() {
            return Ok(());
        }
        if pass + 1 == CERTIFICATE_PASSES {
            // Each piece's primitive then holds its worst corner: its ball, whatever its weights,
            // has grown by at least that.
            growth.0.fill(worst + MARGIN);
        }
        growth.apply(draft);
        open = left;
    }
    Ok(())
}

struct Prover<'a> {
    tree: &'a DraftTree<'a>,
    /// The primitive that held the piece before.
    hint: u32,
    /// Largest distance by which the solid failed to cover a piece.
    worst: f64,
    /// Squared length of the longest edge of the smallest pieces.
    finest_sq: f64,
}

impl Prover<'_> {
    /// Asks for growth where a piece is not covered, and puts the parts of which that is so on the list.
    fn prove(
        &mut self,
        piece: [Point; 3],
        growth: &mut Growth,
        left: &mut Vec<[Point; 3]>,
        tick: &mut dyn FnMut() -> Result<(), BuildError>,
    ) -> Result<(), BuildError> {
        let mut pieces = vec![piece];
        for looked_at in 1usize.. {
            let Some(piece) = pieces.pop() else { break };
            if looked_at.is_multiple_of(64) {
                tick()?;
            }
            let (primitive, worst, at_middle) = self.tightest(&piece);
            if worst.distance <= 0.0 {
                continue;
            }
            let large = worst.distance > NEGLIGIBLE && longest_edge_sq(&piece) > self.finest_sq;
            if large && let Some((by, cut)) = self.cut(&piece, [primitive, at_middle]) {
                for part in cut.inner {
                    let worst = self.worst_corner(by, &part);
                    if worst.distance > 0.0 {
                        self.ask(by, &worst, growth);
                        left.push(part);
                    }
                }
                pieces.extend(cut.outer);
                continue;
            }
            if large {
                pieces.extend(halve(piece));
                continue;
            }
            self.ask(primitive, &worst, growth);
            left.push(piece);
        }
        Ok(())
    }

    /// Asks for a primitive's growth to the worst corner of a piece.
    fn ask(&mut self, primitive: u32, worst: &Signed, growth: &mut Growth) {
        self.worst = self.worst.max(worst.distance);
        growth.ask(self.tree.primitives()[primitive as usize], worst);
    }

    /// Cuts a piece along what one of two primitives covers of it.
    fn cut(&self, piece: &[Point; 3], primitives: [u32; 2]) -> Option<(u32, Cut)> {
        let tried = if primitives[0] == primitives[1] { 1 } else { 2 };
        primitives[..tried].iter().find_map(|&by| {
            let cut = cut_covered(piece, |p| self.tree.distance_to(by, p).distance)?;
            Some((by, cut))
        })
    }

    /// Among the primitives nearest to the middle and the corners, the one whose worst corner is
    /// best, and that corner's distance; the first that holds all three ends the search. And the one
    /// nearest to the middle, if the search came to it.
    fn tightest(&mut self, piece: &[Point; 3]) -> (u32, Signed, u32) {
        let [a, b, c] = *piece;
        let mut at_middle = None;
        let mut best = (self.hint, self.worst_corner(self.hint, piece));
        for p in [(a + b + c) * (1.0 / 3.0), a, b, c] {
            if best.1.distance <= 0.0 {
                break;
            }
            let nearest = self.tree.nearest(p, self.hint);
            at_middle = at_middle.or(Some(nearest.primitive));
            let worst = self.worst_corner(nearest.primitive, piece);
            if worst.distance < best.1.distance {
                best = (nearest.primitive, worst);
            }
        }
        self.hint = best.0;
        (best.0, best.1, at_middle.unwrap_or(best.0))
    }

    fn worst_corner(&self, primitive: u32, piece: &[Point; 3]) -> Signed {
        let at = |p: &Point| self.tree.distance_to(primitive, *p);
        let [a, b, c] = [at(&piece[0]), at(&piece[1]), at(&piece[2])];
        let ab = if b.distance > a.distance { b } else { a };
        if c.distance > ab.distance { c } else { ab }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::draft::Ball;

    /// Rest of a strip from `x = 0` to 1 at `z = top`, of the width of a peg's facets, beside a cone along it of radius
    /// .1, which ends at `end`.
    fn left_of_strip(top: f64, end: f64) -> Vec<[Point; 3]> {
        let ball = |x: f64| Ball {
            center: Point::new(x, 0.0, 0.0),
            radius: 0.1,
        };
        let draft = Draft {
            balls: vec![ball(-0.2), ball(end)],
            edges: vec![[0, 1]],
            faces: Vec::new(),
        };
        let tree = DraftTree::new(&draft);
        let mut prover = Prover {
            tree: &tree,
            hint: 0,
            worst: 0.0,
            finest_sq: FINEST * FINEST,
        };
        let strip = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.001)];
        let strip = strip.map(|(x, y)| Point::new(x, y, top));
        let mut left = Vec::new();
        let mut growth = Growth::none(&draft);
        let proven = prover.prove(strip, &mut growth, &mut left, &mut || Ok(()));
        proven.expect("nobody cancels");
        left
    }

    #[test]
    fn a_facet_that_is_hardly_missed_is_not_cut() {
        // The far corner is missed by 5e-6, half of what calls for a cut, and lies on the cone at any smaller height.
        assert_eq!(left_of_strip(0.1, 1.2).len(), 1);
    }

    #[test]
    fn only_the_parts_that_are_missed_are_left() {
        let left = left_of_strip(0.09, 0.95);
        assert!(!left.is_empty());
        let nearest = left.iter().flatten().map(|p| p.x);
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        // The last ball is that high up to `x = .95 + √(.1² − .09²)`.
        let end = 0.95 + (0.1f64.powi(2) - 0.09f64.powi(2)).sqrt();
        assert!(nearest > end - 2.0 * FINEST, "{nearest}, {end}");
    }
}
