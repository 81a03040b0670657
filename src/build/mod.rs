//! L2: triangle mesh → [`MedialMesh`]. The pipeline: calls in order, progress, cancellation.

pub mod mesh_file;

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use std::ops::ControlFlow;

/// What to build.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BuildOptions {
    /// Largest number of primitives (slabs, cones that belong to no slab, lone spheres).
    pub primitives: Option<usize>,
    /// Largest two-sided Hausdorff error, as a fraction of the longest side of the bounding box.
    pub max_error: Option<Real>,
    /// Enlarge radii until the solid covers the whole source surface.
    pub enclose: bool,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            primitives: Some(500),
            max_error: None,
            enclose: true,
        }
    }
}

/// How far a build is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Name of the running stage.
    pub stage: &'static str,
    /// Of the whole build, in [0, 1].
    pub fraction: Real,
}

/// Two-sided distance between a source surface and the solid's boundary, in the user's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hausdorff {
    /// Largest distance from the source surface to the solid's boundary.
    pub surface_to_envelope: Real,
    /// Largest distance from the solid's boundary to the source surface.
    pub envelope_to_surface: Real,
    /// How far the source surface sticks out of the solid.
    pub uncovered: Real,
    /// Distance between neighbouring samples of both surfaces.
    pub sampling: Real,
}

/// What a build did, measured.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildReport {
    /// Error of the result.
    pub hausdorff: Hausdorff,
    /// Error before the enclosure, when one was asked for.
    pub hausdorff_before_enclosure: Option<Hausdorff>,
    /// Longest side of the source's bounding box: errors are usually quoted in it.
    pub longest_side: Real,
    /// Primitives of the result.
    pub primitives: usize,
    /// What was found in the input and what was done about it.
    pub notes: Vec<String>,
    /// Seconds per stage, in order.
    pub seconds: Vec<(&'static str, f64)>,
}

impl MedialMesh {
    /// Builds a medial mesh from a triangle mesh.
    pub fn from_trimesh(
        vertices: &[Vector],
        indices: &[[u32; 3]],
        options: &BuildOptions,
    ) -> Result<(MedialMesh, BuildReport), BuildError> {
        Self::from_trimesh_with_progress(vertices, indices, options, &mut |_| {
            ControlFlow::Continue(())
        })
    }

    /// As [`MedialMesh::from_trimesh`], calling `progress` between and within stages; a `Break` ends
    /// the build with [`BuildError::Cancelled`].
    pub fn from_trimesh_with_progress(
        _vertices: &[Vector],
        _indices: &[[u32; 3]],
        _options: &BuildOptions,
        _progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(MedialMesh, BuildReport), BuildError> {
        Err(BuildError::NoInside {
            message: "to come".into(),
        })
    }
}
