//! Gives a collapsed medial mesh for any number of primitives, in whatever order they are asked for, from one collapse.
//!
//! A collapse does not depend on where it stops. So the state is kept each time the number has halved, and a mesh
//! of any number only needs the collapse from the kept state above it.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::refine::fit::{Collapsed, fine_count, start_count};
use crate::meshing::refine::swaps::LARGE;
use crate::meshing::simplify::shared_count::Parts;
use crate::meshing::watch::Watch;

/// A medial mesh, and it again at falling counts.
pub struct Ladder<'a> {
    /// The mesh with all primitives.
    pub finest: Parts<'a>,
    /// Convex creases that it keeps.
    pub creases: Vec<[Point; 2]>,
    /// On the way to few primitives, and to many ([`Parts::measuring_early`]).
    rungs: [Vec<Parts<'a>>; 2],
}

impl<'a> Ladder<'a> {
    /// A medial mesh that keeps `creases`.
    pub fn new(finest: Parts<'a>, creases: Vec<[Point; 2]>) -> Self {
        Self {
            finest,
            creases,
            rungs: [Vec::new(), Vec::new()],
        }
    }

    /// The medial mesh with at most `count` primitives, or as few as it can have.
    pub fn at(&mut self, count: usize, watch: &mut Watch) -> Result<Parts<'a>, BuildError> {
        loop {
            let above = |r: &&Parts| r.primitives() >= count;
            let rungs = &mut self.rungs[usize::from(count > LARGE)];
            let last = rungs.iter().rev().find(above);
            let is_lowest = last.map(Parts::primitives) == rungs.last().map(Parts::primitives);
            let parts = last.unwrap_or(&self.finest).clone();
            let mut parts = parts.measuring_early(count > LARGE);
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
        let mut parts = self.at(fine_count(count), watch)?;
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
