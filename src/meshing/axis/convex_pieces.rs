//! A body of flat faces as a union of convex polyhedra, which may overlap.
//!
//! # Method
//! The planes of all faces cut space into cells, each inside the body or outside (its winding number says which). A
//! convex polyhedron bounded by some of the planes is in the body if no outer cell is on its side of all of them: one
//! bit for each plane, so this is a comparison of words. Starting with all planes around an inner cell, planes are
//! given up one by one as long as that holds. What is left is a largest piece about the cell, in the order in which
//! planes were tried; of several orders the one is taken whose piece covers most of what is not covered yet. Pieces
//! that overlap leave no seam within the body, where parts that merely adjoin would have faces, and their spheres no
//! radius.

use crate::error::BuildError;
use crate::meshing::geometry::convex::{Convex, Plane};
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::watch::Watch;

/// Planes at most: the bits of a word.
pub const MOST_PLANES: usize = 64;

/// Cells at most: a ring of 24 sides has 1,251, a gear of eight teeth 1,299.
const MOST_CELLS: usize = 6_000;

/// Largest number of pieces.
const MOST_PIECES: usize = 64;

/// Orders in which planes are tried for each piece. With one a star of eight points takes seven pieces, with four or
/// more it takes five.
const ORDERS: u64 = 32;

/// Half the side of the box that is cut (longest side of the body 1, centred).
const HALF_BOX: f64 = 1.0;

/// The plane of the box's sides.
const BOX: u32 = u32::MAX;

/// Volume (longest side 1) below which a cell is left out: a sliver between planes that are nearly one. If a cell was
/// more than that, it shows in the measured error, and the pieces are not used.
const NO_VOLUME: f64 = 1e-12;

/// A cell inside the body.
struct Cell {
    /// Bit `i` is set if it is below plane `i`.
    below: u64,
    volume: f64,
}

/// The cells that planes cut space into.
struct Cells {
    inner: Vec<Cell>,
    /// The bits of those outside.
    outer: Vec<u64>,
}

impl Cells {
    fn new(
        planes: &[Plane],
        on: f64,
        tree: &TriangleTree,
        watch: &mut Watch,
    ) -> Result<Option<Self>, BuildError> {
        let mut all = vec![Convex::cube(HALF_BOX, BOX)];
        for (i, plane) in planes.iter().enumerate() {
            watch.again()?;
            all = all
                .iter()
                .flat_map(|cell| cell.cut(plane, i as u32, on))
                .flatten()
                .collect();
            if all.len() > MOST_CELLS {
                return Ok(None);
            }
        }
        let mut cells = Self {
            inner: Vec::new(),
            outer: Vec::new(),
        };
        for (i, cell) in all.iter().enumerate() {
            watch.every(i)?;
            let (middle, volume) = (cell.middle(), cell.volume());
            if volume < NO_VOLUME {
                continue;
            }
            let bit = |(i, plane): (usize, &Plane)| u64::from(plane.depth(middle) > 0.0) << i;
            let below = planes.iter().enumerate().map(bit).sum();
            if tree.winding(middle) > 0.5 {
                cells.inner.push(Cell { below, volume });
            } else {
                cells.outer.push(below);
            }
        }
        Ok(Some(cells))
    }

    /// The planes, as bits, that are left of all around a cell when no more can be given up, tried in `order`. One that
    /// bounds nothing is given up last: before, it stands in for another that may have to go.
    fn grown(&self, cell: &Cell, order: &[usize]) -> u64 {
        let mut kept = order.iter().fold(0, |all, i| all | 1 << i);
        let count = |planes: u64| self.within(cell, planes).filter(|w| *w).count();
        let is_inner = |planes: u64| self.outer.iter().all(|o| (o ^ cell.below) & planes != 0);
        let mut inner = count(kept);
        let mut grows = true;
        while std::mem::take(&mut grows) {
            for i in order {
                let fewer = kept & !(1 << i);
                if fewer == kept || !is_inner(fewer) {
                    continue;
                }
                let more = count(fewer);
                if more > inner {
                    (kept, inner, grows) = (fewer, more, true);
                }
            }
        }
        for i in order {
            let fewer = kept & !(1 << i);
            if is_inner(fewer) {
                kept = fewer;
            }
        }
        kept
    }

    /// The cells of the piece about a cell that some planes bound.
    fn within(&self, cell: &Cell, planes: u64) -> impl Iterator<Item = bool> + use<'_> {
        let below = cell.below;
        self.inner
            .iter()
            .map(move |c| (c.below ^ below) & planes == 0)
    }

    /// The volume of cells.
    fn volume(&self, wanted: impl Fn(usize) -> bool) -> f64 {
        let wanted = (0..self.inner.len()).filter(|&i| wanted(i));
        wanted.map(|i| self.inner[i].volume).sum()
    }
}

/// One convex piece of a body.
pub struct SolidPiece {
    /// Planes of the piece, outward, one for each face.
    pub planes: Vec<Plane>,
    /// Faces of the piece, which name their planes.
    pub solid: Convex,
}

/// The convex pieces whose union is the body with these faces, in a box of side 1 about the origin; `None` where they
/// are too many, or where rounding spoils them. Points within `on` of a plane are on it.
pub fn convex_pieces(
    planes: &[Plane],
    on: f64,
    tree: &TriangleTree,
    watch: &mut Watch,
) -> Result<Option<Vec<SolidPiece>>, BuildError> {
    let Some(cells) = Cells::new(planes, on, tree, watch)? else {
        return Ok(None);
    };
    let mut pieces: Vec<(usize, u64, Vec<bool>)> = Vec::new();
    let mut open = vec![true; cells.inner.len()];
    let largest = |open: &[bool]| {
        let open = (0..open.len()).filter(|&i| open[i]);
        open.max_by(|&i, &j| cells.inner[i].volume.total_cmp(&cells.inner[j].volume))
    };
    while let Some(at) = largest(&open) {
        if pieces.len() == MOST_PIECES {
            return Ok(None);
        }
        let cell = &cells.inner[at];
        let mut best: Option<(f64, f64, u64)> = None;
        for seed in 0..ORDERS {
            watch.again()?;
            let mut order: Vec<usize> = (0..planes.len()).collect();
            Random::new(seed).shuffle(&mut order);
            let kept = cells.grown(cell, &order);
            let within: Vec<bool> = cells.within(cell, kept).collect();
            let new = cells.volume(|i| within[i] && open[i]);
            let all = cells.volume(|i| within[i]);
            if best.is_none_or(|(n, a, _)| (n, a) < (new, all)) {
                best = Some((new, all, kept));
            }
        }
        let kept = best.map_or(u64::MAX, |b| b.2);
        let within: Vec<bool> = cells.within(cell, kept).collect();
        open.iter_mut().zip(&within).for_each(|(o, w)| *o &= !w);
        pieces.push((at, kept, within));
    }
    // The first may have become superfluous by later ones.
    for k in (0..pieces.len()).rev() {
        let others = |i: usize| (0..pieces.len()).any(|j| j != k && pieces[j].2[i]);
        if (0..cells.inner.len()).all(|i| !pieces[k].2[i] || others(i)) {
            pieces.remove(k);
        }
    }
    let solid = |(at, kept, _): &(usize, u64, Vec<bool>)| {
        bounded(planes, on, cells.inner[*at].below, *kept)
    };
    Ok(pieces.iter().map(solid).collect())
}

/// The polyhedron on the sides `below` of the planes `kept`.
fn bounded(planes: &[Plane], on: f64, below: u64, kept: u64) -> Option<SolidPiece> {
    let mut solid = Convex::cube(HALF_BOX, BOX);
    let mut outward = Vec::new();
    for (i, plane) in planes.iter().enumerate() {
        if kept >> i & 1 == 0 {
            continue;
        }
        let sign = if below >> i & 1 == 1 { 1.0 } else { -1.0 };
        let plane = Plane {
            normal: plane.normal * sign,
            offset: plane.offset * sign,
        };
        let [inside, _] = solid.cut(&plane, outward.len() as u32, on);
        solid = inside?;
        outward.push(plane);
    }
    // Planes that rounding left without a face are none of its own.
    let faces = &solid.faces;
    let all = (0..outward.len() as u32).all(|i| faces.iter().any(|face| face.plane == i));
    let closed = faces.iter().all(|face| face.plane != BOX);
    (all && closed).then_some(SolidPiece {
        planes: outward,
        solid,
    })
}
