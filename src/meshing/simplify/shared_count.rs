//! Simplifies the solid parts and the sheets of a mesh side by side, to a number of primitives that they share.
//!
//! One collapse over both would remove sheets first, because costs are sums over the faces that were merged, of which a
//! dense solid has thousands and a sheet of paper two.

use crate::error::BuildError;
use crate::meshing::axis::start::Start;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::simplify::ball_quadrics::{BOUNDARY_WEIGHT_SHEET, BOUNDARY_WEIGHT_SOLID};
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::watch::Watch;

/// The two parts of a medial mesh on its way to fewer primitives.
#[derive(Clone)]
pub struct SolidAndSheets<'a> {
    solid: Simplifier<'a>,
    sheets: Option<Simplifier<'a>>,
    /// Share of the primitives that sheets get: that of the area.
    share: f64,
    /// Least number of primitives that sheets get, up to half of all: one for each patch.
    least: usize,
    /// A single primitive cannot be both.
    gave_up_sheets: bool,
}

impl<'a> SolidAndSheets<'a> {
    /// Prepares both.
    pub fn new(
        start: Start,
        tree: &'a TriangleTree,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let solid = Simplifier::new(start.solid, BOUNDARY_WEIGHT_SOLID, tree, watch)?;
        let sheets = match start.sheets.balls.is_empty() {
            true => None,
            false => Some(Simplifier::new(
                start.sheets,
                BOUNDARY_WEIGHT_SHEET,
                tree,
                watch,
            )?),
        };
        Ok(Self {
            solid: solid.touching(start.spacing),
            sheets,
            share: start.share,
            least: start.sheet_patches,
            gave_up_sheets: false,
        })
    }

    /// A solid part alone.
    pub fn solid(solid: Simplifier<'a>) -> Self {
        Self {
            solid,
            sheets: None,
            share: 0.0,
            least: 0,
            gave_up_sheets: false,
        }
    }

    /// Passes [`Simplifier::set_measures_early`] on to the solid part.
    pub fn set_measures_early(&mut self, early: bool) {
        self.solid.set_measures_early(early);
    }

    /// Number of primitives now.
    pub fn primitives(&self) -> usize {
        self.solid.primitives() + self.sheet_primitives()
    }

    fn kept_sheets(&self) -> Option<&Simplifier<'a>> {
        self.sheets.as_ref().filter(|_| !self.gave_up_sheets)
    }

    fn sheet_primitives(&self) -> usize {
        self.kept_sheets().map_or(0, Simplifier::primitives)
    }

    /// Whether holes had to be closed, or parts joined, to reach a count.
    pub fn broke_topology(&self) -> bool {
        let sheets = self.sheets.as_ref().is_some_and(Simplifier::broke_topology);
        self.gave_up_sheets || self.solid.broke_topology() || sheets
    }

    /// The medial mesh as it is now.
    pub fn draft(&self) -> Draft {
        match self.kept_sheets() {
            None => self.solid.draft(),
            Some(sheets) => self.solid.draft().and(sheets.draft()),
        }
    }

    /// Simplifies until there are at most `target` primitives: each part by its share, and what one
    /// does not need goes to the other.
    pub fn reduce_to(&mut self, target: usize, watch: &mut Watch) -> Result<(), BuildError> {
        let (solid, sheets) = (self.solid.primitives(), self.sheet_primitives());
        if solid + sheets <= target {
            return Ok(());
        }
        self.gave_up_sheets |= sheets > 0 && target < 2 && solid > 0;
        if let Some(part) = self.sheets.as_mut().filter(|_| sheets > 0)
            && !self.gave_up_sheets
        {
            let fair = (target as f64 * self.share).round() as usize;
            let fair = fair.max(self.least.min(target / 2));
            let spare = target.saturating_sub(solid);
            let most = if solid > 0 { target - 1 } else { target };
            let for_sheets = fair.max(spare).clamp(1, most.max(1));
            part.reduce_to(for_sheets, watch)?;
        }
        let left = target.saturating_sub(self.sheet_primitives());
        if solid > 0 {
            self.solid.reduce_to(left, watch)?;
        }
        Ok(())
    }
}
