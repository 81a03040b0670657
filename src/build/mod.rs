//! L2: triangle mesh → [`MedialMesh`]. The entry; `pipeline.rs` calls the stages in order.

mod bounds;
mod chunks;
mod complex;
pub mod delaunay;
mod draft;
mod enclose;
mod fit;
pub mod hausdorff;
mod inner_balls;
mod insert;
mod insertion_order;
mod least_squares;
mod measured;
pub mod mesh_file;
mod options;
mod orient;
mod pipeline;
mod primitive_tree;
mod quadric;
mod random;
mod refit;
mod residuals;
mod samples;
mod simplify;
mod solid;
mod subdivide;
mod surface;
mod swaps;
mod triangle_tree;
mod watch;

pub use options::{BuildOptions, BuildReport, Hausdorff, Progress, Quality};

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use hausdorff::in_unit;
use options::Limits;
use pipeline::Source;
use std::ops::ControlFlow;
use surface::Surface;
use triangle_tree::TriangleTree;
use watch::Watch;

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
        vertices: &[Vector],
        indices: &[[u32; 3]],
        options: &BuildOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(MedialMesh, BuildReport), BuildError> {
        let limits = Limits::new(options)?;
        let mut watch = Watch::new(progress);
        watch.begin("surface")?;
        let surface = Surface::new(vertices, indices)?;
        let tree = TriangleTree::new(surface.all_corners());
        let source = Source {
            surface,
            tree,
            limits,
        };
        let candidate = source.best_candidate(&mut watch)?;
        let frame = source.surface.frame;
        let mut mesh = candidate.draft.to_medial_mesh(&frame)?;
        if let Some(mass) = source.surface.mass_properties() {
            mesh = mesh.with_mass_properties(mass);
        }
        let target_reached = candidate.keeps(source.limits.max_error);
        let mut notes = source.surface.notes;
        notes.extend(candidate.notes);
        let report = BuildReport {
            hausdorff: in_unit(candidate.hausdorff, frame.scale),
            hausdorff_before_enclosure: candidate.before.map(|h| in_unit(h, frame.scale)),
            longest_side: frame.scale as Real,
            primitives: mesh.primitive_count(),
            euler: mesh.spheres().len() as i64 - mesh.edges().len() as i64
                + mesh.faces().len() as i64,
            target_reached,
            notes,
            seconds: watch.finish()?,
        };
        Ok((mesh, report))
    }
}
