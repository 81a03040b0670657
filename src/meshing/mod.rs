//! Builds a [`MedialMesh`] from a triangle mesh (layer 2). This file has the functions that users call;
//! `recipe/pipeline.rs` calls the stages in order.
//!
//! # Files
//! - In the order of a build: `mesh_file.rs` (reads files, one reader for each format in `mesh_file/`), `surface/`
//!   (repair, creases), `axis/` (the mesh to start from), `simplify/` (fewer primitives), `refine/` (a better fit),
//!   `certify/` (covers the surface, error, mass). `geometry/` serves all of them.
//! - `recipe/` decides which candidates are made, and which is returned. Each is a `draft.rs` until it is done.
//! - Around a build: `options.rs` (options and report), `watch.rs` (progress), `findings.rs` (faults of the mesh),
//!   `cached.rs` (a folder of built meshes), `curve.rs` (the error at several numbers of primitives).

mod axis;
mod cached;
mod certify;
mod curve;
mod draft;
mod findings;
mod geometry;
pub mod mesh_file;
mod options;
mod recipe;
mod refine;
mod simplify;
mod surface;
mod watch;

pub use axis::delaunay;
pub use certify::hausdorff;
pub use curve::{ErrorAt, error_curve};
pub use findings::{Findings, MassSource};
pub use options::{BuildOptions, BuildReport, Creases, Hausdorff, Progress, Quality, Variant};

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use certify::hausdorff::in_unit;
use certify::mass::mass_properties;
use options::BuildLimits;
use recipe::source::Source;
use std::ops::ControlFlow;
use surface::checked_surface::Surface;
use watch::Watch;

impl MedialMesh {
    /// Builds a medial mesh from a triangle mesh. Triangles that enclose a volume become a solid; all others become
    /// sheets without thickness. The result is in the unit and frame of the vertices, and has the mass, centre of
    /// mass and inertia of the solid.
    ///
    /// The vertices of each triangle should be in counter-clockwise order, seen from outside; triangles in the other
    /// order are turned round. Other damage (cracks, small openings, repeated triangles, overlapping parts) is
    /// repaired if possible, and [`BuildReport::findings`] counts it.
    ///
    /// A build with some hundreds of primitives takes a second to half a minute in optimised code, a minute for a
    /// thread (`docs/measurements/medial-mesh-error.md` has a table), over a minute with thousands, and many times as
    /// long without optimisation. Build once and save the result ([`MedialMesh::save_asset`]).
    ///
    /// # Errors
    /// [`BuildError`] names the item and its value: [`BuildError::Option`] an option out of its range, other variants a
    /// triangle mesh that is empty, not finite, too large, without extent, or has an index beyond its vertices.
    ///
    /// ```
    /// use rapier3d::prelude::*;
    /// use rapier3d_medial::prelude::*;
    ///
    /// let (vertices, indices) = Cuboid::new(Vector::new(0.5, 0.2, 0.3)).to_trimesh();
    /// let options = BuildOptions { primitives: Some(50), ..Default::default() };
    /// let (mesh, report) = MedialMesh::from_trimesh(&vertices, &indices, &options)?;
    /// assert!(mesh.primitive_count() <= 50 && report.target_reached);
    /// assert!((mesh.mass_properties(1.0).mass() - 0.24).abs() < 1.0e-5);
    /// # Ok::<(), rapier3d_medial::BuildError>(())
    /// ```
    pub fn from_trimesh(
        vertices: &[Vector],
        indices: &[[u32; 3]],
        options: &BuildOptions,
    ) -> Result<(MedialMesh, BuildReport), BuildError> {
        Self::from_trimesh_with_progress(vertices, indices, options, &mut |_| {
            ControlFlow::Continue(())
        })
    }

    /// Does the same as [`MedialMesh::from_trimesh`], and calls `progress` several times a second to tell how far
    /// the build is. If `progress` returns `Break`, the build stops.
    ///
    /// # Errors
    /// The same as of [`MedialMesh::from_trimesh`], and [`BuildError::Cancelled`] if `progress` returned
    /// `Break`.
    ///
    /// ```
    /// use rapier3d::prelude::*;
    /// use rapier3d_medial::prelude::*;
    /// use std::ops::ControlFlow;
    ///
    /// let (vertices, indices) = Cuboid::new(Vector::new(0.5, 0.2, 0.3)).to_trimesh();
    /// let options = BuildOptions { primitives: Some(50), ..Default::default() };
    /// let mut show = |progress: Progress| {
    ///     println!("{:3.0} % {}", 100.0 * progress.fraction, progress.stage);
    ///     ControlFlow::Continue(())
    /// };
    /// let (mesh, _) =
    ///     MedialMesh::from_trimesh_with_progress(&vertices, &indices, &options, &mut show)?;
    /// # assert!(mesh.primitive_count() <= 50);
    /// # Ok::<(), rapier3d_medial::BuildError>(())
    /// ```
    pub fn from_trimesh_with_progress(
        vertices: &[Vector],
        indices: &[[u32; 3]],
        options: &BuildOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(MedialMesh, BuildReport), BuildError> {
        let limits = BuildLimits::new(options)?;
        let mut watch = Watch::new(progress);
        watch.begin("surface")?;
        let (surface, tree) = Surface::new(vertices, indices, &mut watch)?;
        let mut source = Source::new(surface, tree, limits);
        let candidate = source.best_candidate(&mut watch)?;
        let target_reached = candidate.keeps(source.limits.max_error);
        watch.begin("mass")?;
        let hidden = source.boundary.as_ref().map_or(0.0, |b| b.hidden);
        let surface = source.surface;
        let (mass, mass_source) = mass_properties(&surface, &mut watch)?;
        let mesh = candidate.draft.to_medial_mesh(&surface.frame)?;
        let mut mesh = mesh.of_convex_pieces(candidate.variant == Variant::Exact);
        if let Some(mass) = mass {
            mesh = mesh.with_mass_properties(mass);
        }
        let mut findings = surface.findings;
        findings.mass = mass_source;
        findings.fit_cut_short = watch.is_fit_cut();
        let mut notes = findings.notes();
        if hidden > 0.0 {
            notes.push(findings.hidden_in_words(hidden / surface.area));
        }
        notes.extend(findings.undone_in_words());
        notes.extend(candidate.notes);
        if let Some(count) = candidate.exact_with {
            notes.push(format!(
                "with {count} primitives it would be exact and build faster, at about the same time per step or less"
            ));
        }
        let frame = surface.frame;
        let report = BuildReport {
            hausdorff: in_unit(candidate.hausdorff, frame.scale),
            hausdorff_before_enclosure: candidate.before.map(|h| in_unit(h, frame.scale)),
            longest_side: frame.scale as Real,
            primitives: mesh.primitive_count(),
            exact_with: candidate.exact_with,
            variant: candidate.variant,
            euler: mesh.spheres().len() as i64 - mesh.edges().len() as i64
                + mesh.faces().len() as i64,
            target_reached,
            hidden_area: (hidden * frame.scale * frame.scale) as Real,
            findings,
            notes,
            memory: watch.peak(),
            seconds: watch.finish()?,
        };
        Ok((mesh, report))
    }
}
