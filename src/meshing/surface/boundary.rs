//! The boundary of the solid that a surface winds around, where its parts overlap or pass through themselves: all
//! of its triangles but the pieces with matter on both sides, which are hidden.
//!
//! A triangle that another part passes through is cut along the planes of all faces if these are flat and few
//! (`flat_boundary.rs`). Otherwise it is halved until its pieces lie on one side; of the smallest, those that are
//! partly hidden stay. What is hidden: `hidden.rs`. Small openings have lids there. Folds (`folds.rs`) that matter
//! encloses are hidden too.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::subdivide::{halve, longest_edge_sq};
use crate::meshing::geometry::triangle::points_inside;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::flat_boundary::{TrianglePiece, flat_pieces};
use crate::meshing::surface::folds::Folds;
use crate::meshing::surface::hidden::Hidden;
use crate::meshing::surface::uneven_parts::{Unevenness, uneven_parts};
use crate::meshing::watch::Watch;

/// Distance before and behind the surface at which the winding number is asked for (longest side 1).
const OFF: f64 = 2e-4;

/// Longest edge of the smallest pieces (longest side 1), which are not halved. Smaller, and the boundary is known more
/// finely, in more time.
const FINEST: f64 = 0.006;

/// Longest edge of a piece (longest side 1) above which it is halved in any case: seven probes would miss what passes
/// through it.
const LARGE: f64 = 0.08;

/// How far the points of a piece that are looked at are from its border, as a share of the way to the middle.
const INWARD: f64 = 0.1;

/// Triangles and points that winding numbers may look at before larger pieces are tried: so many, and so many more for
/// each triangle. The first is a few seconds' work, of which bodies of overlapping parts took an eighth at most; the
/// second lets meshes of very many triangles look at each.
const MOST_WORK: [usize; 2] = [100_000_000, 4_000];

/// Pieces that may be kept before larger pieces are tried: so many, and so many more for each triangle.
const MOST_PIECES: [usize; 2] = [200_000, 2];

/// Factor by which pieces become larger at least, each time the work was too much.
const COARSER: f64 = 2.0;

/// Factor by which pieces become larger at most at a time, where little of the surface was done before the work ended.
const COARSEST: f64 = 16.0;

/// A length above that of all edges in the builder's frame (longest side 1): pieces of that size are whole triangles.
const SPAN: f64 = 2.0;

/// Share of the area that is lost by rounding.
const ROUNDING: f64 = 1e-9;

/// Part of a surface that is not hidden inside matter.
pub struct Boundary {
    /// The pieces of triangles, and lids on what is open, as a surface.
    pub surface: Surface,
    /// Tree of that surface.
    pub tree: TriangleTree,
    /// Area of what is hidden (longest side 1).
    pub hidden: f64,
    /// Longest edge of the smallest pieces, which are kept if they are partly hidden: what is finer is not known.
    pub finest: f64,
    /// How uneven the parts are that it is of, if they are.
    pub uneven: Option<Unevenness>,
}

/// What of a surface is not hidden.
struct Sorted {
    /// Pieces of triangles, in the order of these.
    pieces: Vec<TrianglePiece>,
    finest: f64,
    cracks: f64,
    uneven: Option<Unevenness>,
}

/// The boundary of the matter that a surface winds around, with the sheets outside it; `None` where nothing is
/// hidden, or all, and nothing is open. If `of_parts`, the cracks between uneven parts count as matter: for a medial
/// mesh that keeps the parts. `findings` is told what is hidden.
pub fn solid_boundary(
    surface: &Surface,
    tree: &TriangleTree,
    of_parts: bool,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Option<Boundary>, BuildError> {
    let is_mixed = [true, false]
        .iter()
        .all(|kind| surface.sheet.contains(kind));
    let hides = surface.findings.overlapping || findings.overlapping || is_mixed;
    if !hides && surface.lids.is_empty() {
        return Ok(None);
    }
    let whole = || surface.all_corners().enumerate().map(|(t, c)| (c, t));
    let sorted = match hides {
        true => sort_out(surface, tree, of_parts, findings, watch)?,
        false => None,
    };
    let Sorted {
        pieces,
        finest,
        cracks,
        uneven,
    } = sorted.unwrap_or_else(|| Sorted {
        pieces: whole().collect(),
        finest: FINEST,
        cracks: 0.0,
        uneven: None,
    });
    let patches = surface.patch_of.iter().max().map_or(0, |&p| p as usize + 1);
    let mut is_seen = vec![false; patches];
    let mut triangles = surface.triangles.len();
    for same in pieces.chunk_by(|a, b| a.1 == b.1) {
        triangles -= 1;
        is_seen[surface.patch_of[same[0].1] as usize] = true;
    }
    let mut boundary = surface.of_pieces(&pieces);
    boundary.cracks = cracks;
    let added: f64 = surface.lids.iter().map(|lid| area(&lid.0)).sum();
    let hidden = surface.area + added - boundary.area;
    // Halves of a triangle add up to it but for rounding.
    let hidden = if hidden > ROUNDING * surface.area {
        hidden
    } else {
        0.0
    };
    if pieces.is_empty() || (hidden == 0.0 && surface.lids.is_empty()) {
        return Ok(None);
    }
    findings.triangles_hidden = triangles;
    findings.patches_hidden = is_seen.iter().filter(|seen| !**seen).count();
    let mut tree = TriangleTree::new(boundary.triangles.len(), |i| boundary.corners(i), watch)?;
    let counts = |i: u32| i8::from(!boundary.sheet[i as usize]);
    tree.recount(counts, watch)?;
    Ok(Some(Boundary {
        surface: boundary,
        tree,
        hidden,
        finest,
        uneven,
    }))
}

/// The pieces of triangles that are not hidden. A surface so tangled that most of its pieces are partly hidden is cut
/// into larger ones; `None` if that takes too much work too.
fn sort_out(
    surface: &Surface,
    tree: &TriangleTree,
    of_parts: bool,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Option<Sorted>, BuildError> {
    let folds = Folds::new(surface, tree, watch)?;
    let uneven = match of_parts {
        true => uneven_parts(surface, watch)?,
        false => None,
    };
    let cracks = uneven.map_or(0.0, |uneven| uneven.cracks);
    if let Some((pieces, cracks)) = flat_pieces(surface, tree, &folds, cracks, watch)? {
        return Ok(Some(Sorted {
            pieces,
            finest: FINEST,
            cracks,
            uneven,
        }));
    }
    let mut coarser = 1.0;
    loop {
        let mut cut = Cut::new(tree, &folds, surface.triangles.len(), coarser);
        cut.hidden.cracks = cracks.max(OFF);
        let mut area_done = 0.0;
        for (t, corners) in surface.all_corners().enumerate() {
            let normal = surface.normals[t];
            if !cut.triangle((corners, t), surface.patch_of[t], normal, watch)? {
                break;
            }
            area_done += area(&corners);
        }
        if !cut.is_exhausted() {
            findings.boundary_coarse = coarser > 1.0;
            return Ok(Some(Sorted {
                pieces: cut.pieces,
                finest: cut.finest,
                cracks,
                uneven,
            }));
        }
        if coarser * LARGE > SPAN {
            findings.boundary_coarse = true;
            return Ok(None);
        }
        // The work on pieces of one size is as the area over its square.
        let done = area_done / surface.area;
        coarser *= (COARSER / done.sqrt()).clamp(COARSER, COARSEST);
    }
}

/// The triangles of a surface, cut up to a size of pieces and a budget.
struct Cut<'a> {
    hidden: Hidden<'a>,
    finest: f64,
    large: f64,
    pieces: Vec<TrianglePiece>,
    waiting: Vec<[Point; 3]>,
    /// The most of both.
    most_pieces: usize,
    most_work: usize,
}

impl<'a> Cut<'a> {
    fn new(tree: &'a TriangleTree, folds: &'a Folds<'a>, triangles: usize, coarser: f64) -> Self {
        let most = |[fixed, of_each]: [usize; 2]| fixed + of_each * triangles;
        Self {
            hidden: Hidden {
                tree,
                folds,
                off: OFF,
                cracks: OFF,
                work: 0,
            },
            finest: FINEST * coarser,
            large: LARGE * coarser,
            pieces: Vec::new(),
            waiting: Vec::new(),
            most_pieces: most(MOST_PIECES),
            most_work: most(MOST_WORK),
        }
    }

    fn is_exhausted(&self) -> bool {
        self.hidden.work > self.most_work || self.pieces.len() > self.most_pieces
    }

    /// Keeps what is not hidden of a triangle; `false` if the budget ends before.
    fn triangle(
        &mut self,
        (corners, t): TrianglePiece,
        patch: u32,
        normal: Point,
        watch: &mut Watch,
    ) -> Result<bool, BuildError> {
        self.waiting.push(corners);
        while let Some(piece) = self.waiting.pop() {
            watch.again()?;
            if self.is_exhausted() {
                return Ok(false);
            }
            let longest_sq = longest_edge_sq(&piece);
            if longest_sq > self.large * self.large {
                self.waiting.extend(halve(piece));
                continue;
            }
            let middle = middle(&piece);
            let points = || points_inside(&piece, INWARD).into_iter();
            let is_finest = longest_sq <= self.finest * self.finest;
            let here = self.hidden.is_enclosed(middle, normal);
            let is_alike = match is_finest && !here {
                true => false,
                false => points()
                    .skip(1)
                    .all(|p| self.hidden.is_enclosed(p, normal) == here),
            };
            if is_alike && here {
                continue;
            }
            if !is_alike && !is_finest {
                self.waiting.extend(halve(piece));
                continue;
            }
            // Most pieces that are seen are in no fold: one point tells.
            match self.hidden.is_in_fold(middle, patch, normal) {
                false => self.pieces.push((piece, t)),
                true if points()
                    .skip(1)
                    .all(|p| self.hidden.is_in_fold(p, patch, normal)) => {}
                true if is_finest => self.pieces.push((piece, t)),
                true => self.waiting.extend(halve(piece)),
            }
        }
        Ok(true)
    }
}

fn area(&[a, b, c]: &[Point; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

fn middle(&[a, b, c]: &[Point; 3]) -> Point {
    (a + b + c) * (1.0 / 3.0)
}
