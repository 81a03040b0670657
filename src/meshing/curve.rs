//! [`error_curve`]: how small the error can be at each of several numbers of primitives.

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::meshing::certify::hausdorff::in_unit;
use crate::meshing::draft::Draft;
use crate::meshing::options::{BuildLimits, BuildOptions, Hausdorff, Progress};
use crate::meshing::recipe::source::Source;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::watch::Watch;
use std::ops::ControlFlow;

/// The smallest error found with up to a number of primitives.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ErrorAt {
    /// The number of primitives that was asked for.
    pub asked: usize,
    /// Number of primitives of the medial mesh with this error; at most [`Self::asked`].
    pub primitives: usize,
    /// How far that medial mesh is from the triangle mesh, in the user's unit.
    pub hausdorff: Hausdorff,
}

/// The error that a triangle mesh has with each of several numbers of primitives (`counts`), to choose one before
/// a build. Returns them in ascending order, and the longest side of the mesh's bounding box in the user's unit.
///
/// Each error is about what [`crate::MedialMesh::from_trimesh`] gives with that many `primitives` and the other
/// `options`; `primitives` and `max_error` of the options are ignored. No error is larger than that of a
/// smaller number. This is faster than as many builds: the mesh is cleaned, sampled and simplified once, and only
/// fitting, covering and measuring are done for each number. `progress` is called as in
/// [`crate::MedialMesh::from_trimesh_with_progress`].
///
/// # Errors
/// The same as of [`crate::MedialMesh::from_trimesh_with_progress`]; a number of 0 primitives is refused.
///
/// ```no_run
/// use rapier3d::prelude::*;
/// use rapier3d_medial::{BuildOptions, meshing::error_curve};
/// use std::ops::ControlFlow;
///
/// let (vertices, indices) = Cuboid::new(Vector::new(0.5, 0.2, 0.3)).to_trimesh();
/// let options = BuildOptions::default();
/// let mut go_on = |_| ControlFlow::Continue(());
/// let (curve, _) = error_curve(&vertices, &indices, &[22, 50], &options, &mut go_on)?;
/// for point in curve {
///     println!("{} primitives: off by {} m", point.primitives, point.hausdorff.error());
/// }
/// # Ok::<(), rapier3d_medial::BuildError>(())
/// ```
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
        BuildLimits::new(&options)?;
    }
    let mut watch = Watch::new(progress);
    watch.begin("surface")?;
    let (surface, tree) = Surface::new(vertices, indices, &mut watch)?;
    let mut source = Source::new(surface, tree, BuildLimits::new(&options)?);
    let points = source.curve(counts, &mut watch)?;
    watch.finish()?;
    Ok((points, source.surface.frame.scale as Real))
}

impl Source {
    /// The least error at each count, in order of the counts.
    fn curve(&mut self, counts: Vec<usize>, watch: &mut Watch) -> Result<Vec<ErrorAt>, BuildError> {
        let exact = self.exact(self.limits.primitives.unwrap_or(usize::MAX), watch)?;
        let start = self.start(false, watch)?;
        let (mut rounded, mut creased) = self.ladders(start, watch)?;
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
