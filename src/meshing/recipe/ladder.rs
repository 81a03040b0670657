//! Gives a collapsed medial mesh for any number of primitives, in whatever order they are asked for, from two
//! collapses: one for up to [`LARGE`] primitives, and one for more, which measures costs from the start.
//!
//! Neither depends on where it stops. So the state is kept each time the number has halved, and a mesh of any number
//! only needs the collapse from the kept state above it.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::refine::fit::{Collapsed, fine_count, start_count};
use crate::meshing::refine::swaps::LARGE;
use crate::meshing::simplify::shared_count::SolidAndSheets;
use crate::meshing::watch::Watch;

/// A medial mesh, and it again at falling counts.
pub struct Ladder<'a> {
    /// The mesh with all primitives.
    pub finest: SolidAndSheets<'a>,
    /// Convex creases that it keeps.
    pub creases: Vec<[Point; 2]>,
    /// Kept states of the collapse to few primitives, and of that to many.
    rungs: [Vec<SolidAndSheets<'a>>; 2],
}

impl<'a> Ladder<'a> {
    /// A medial mesh that keeps `creases`.
    pub fn new(finest: SolidAndSheets<'a>, creases: Vec<[Point; 2]>) -> Self {
        Self {
            finest,
            creases,
            rungs: [Vec::new(), Vec::new()],
        }
    }

    /// The medial mesh with at most `count` primitives, or as few as it can have.
    pub fn at(
        &mut self,
        count: usize,
        watch: &mut Watch,
    ) -> Result<SolidAndSheets<'a>, BuildError> {
        self.on_the_way(count, count > LARGE, watch)
    }

    /// The medial mesh with at most `count` primitives, from the collapse to many primitives if `large`, else from the
    /// other.
    fn on_the_way(
        &mut self,
        count: usize,
        large: bool,
        watch: &mut Watch,
    ) -> Result<SolidAndSheets<'a>, BuildError> {
        loop {
            let above = |r: &&SolidAndSheets| r.primitives() >= count;
            let rungs = &mut self.rungs[usize::from(large)];
            let last = rungs.iter().rev().find(above);
            let is_lowest = last.map(SolidAndSheets::primitives)
                == rungs.last().map(SolidAndSheets::primitives);
            let mut parts = last.unwrap_or(&self.finest).clone();
            parts.set_measures_early(large);
            let half = parts.primitives() / 2;
            if !is_lowest || half <= count {
                parts.reduce_to(count, watch)?;
                return Ok(parts);
            }
            let before = parts.primitives();
            parts.reduce_to(half, watch)?;
            if parts.primitives() >= before {
                return Ok(parts);
            }
            rungs.push(parts);
        }
    }

    /// The drafts that a fit of `count` primitives starts from, and whether the count kept the topology.
    pub fn collapsed(
        &mut self,
        count: usize,
        watch: &mut Watch,
    ) -> Result<(Collapsed, bool), BuildError> {
        watch.begin("simplify")?;
        let mut parts = self.on_the_way(fine_count(count), count > LARGE, watch)?;
        let fine = (count <= LARGE).then(|| parts.draft());
        parts.reduce_to(count, watch)?;
        let (plain, keeps) = (parts.draft(), !parts.broke_topology());
        parts.reduce_to(start_count(count), watch)?;
        let collapsed = Collapsed {
            most: count,
            fine,
            start: parts.draft(),
            plain,
        };
        Ok((collapsed, keeps))
    }
}
