//! Error by count: the least error of a body at each of several counts of primitives, from one construction.

use super::draft::Draft;
use super::hausdorff::in_unit;
use super::options::{BuildOptions, Hausdorff, Limits, Progress};
use super::pipeline::Source;
use super::surface::Surface;
use super::watch::Watch;
use crate::error::BuildError;
use crate::math::{Real, Vector};
use std::ops::ControlFlow;

/// The least error found with up to a count of primitives.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ErrorAt {
    /// The count.
    pub asked: usize,
    /// Primitives of the medial mesh that has it.
    pub primitives: usize,
    /// The error, after enclosure if that is asked for, in the user's unit.
    pub hausdorff: Hausdorff,
}

/// The least error at each of `counts`, in ascending order, and the longest side of the source's box.
///
/// Each is about what [`crate::MedialMesh::from_trimesh`] gives with that many `primitives` and the other
/// `options`, whose own count and error count for nothing. No error is above that of a smaller count. The mesh is
/// cleaned, sampled and collapsed once; each count costs a fit, an enclosure and a measurement.
///
/// # Errors
/// As [`crate::MedialMesh::from_trimesh`]; counts of 0 are refused.
pub fn error_curve(
    vertices: &[Vector],
    indices: &[[u32; 3]],
    counts: &[usize],
    options: &BuildOptions,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(Vec<ErrorAt>, Real), BuildError> {
    let mut options = options.clone();
    options.max_error = None;
    let mut counts = counts.to_vec();
    counts.sort_unstable();
    counts.dedup();
    for &count in [counts.first(), counts.last()].into_iter().flatten() {
        options.primitives = Some(count);
        Limits::new(&options)?;
    }
    let mut watch = Watch::new(progress);
    watch.begin("surface")?;
    let (surface, tree) = Surface::new(vertices, indices, &mut watch)?;
    let mut source = Source::new(surface, tree, Limits::new(&options)?);
    let points = source.curve(counts, &mut watch)?;
    watch.finish()?;
    Ok((points, source.surface.frame.scale as Real))
}

impl Source {
    /// The least error at each count, in order of the counts.
    fn curve(&mut self, counts: Vec<usize>, watch: &mut Watch) -> Result<Vec<ErrorAt>, BuildError> {
        let exact = self.polyhedra(watch)?;
        let (start, samples) = self.start(false, watch)?;
        let (mut rounded, mut creased) = self.ladders(start, samples, watch)?;
        let mut best = None;
        let mut points = Vec::with_capacity(counts.len());
        let at = |asked, draft: &Draft, hausdorff| ErrorAt {
            asked,
            primitives: draft.primitives().len(),
            hausdorff: in_unit(hausdorff, self.surface.frame.scale),
        };
        for count in counts {
            if let Some(exact) = &exact
                && exact.draft.primitives().len() <= count
            {
                points.push(at(count, &exact.draft, exact.hausdorff));
                continue;
            }
            for ladder in std::iter::once(&mut rounded).chain(creased.as_mut()) {
                watch.attempt();
                let (collapsed, _) = ladder.collapsed(count, watch)?;
                best = Some(self.fitted(&collapsed, &ladder.creases, best, watch)?);
            }
            if let Some(best) = &best {
                points.push(at(count, &best.draft, best.hausdorff));
            }
        }
        Ok(points)
    }
}
