//! L2: triangle mesh → [`MedialMesh`]. The pipeline: calls in order, progress, cancellation.

mod bounds;
mod complex;
pub mod delaunay;
mod draft;
mod edges;
mod enclose;
mod fast_hash;
mod findings;
pub mod hausdorff;
mod inner_balls;
mod insertion_order;
mod mass;
pub mod mesh_file;
mod openings;
mod orient;
mod parts;
mod patches;
mod primitive_tree;
mod quadric;
mod random;
mod samples;
mod sheets;
mod simplify;
mod solid;
mod start;
mod subdivide;
mod surface;
mod triangle_tree;
mod watch;
mod weld;

use crate::error::BuildError;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use draft::Draft;
use enclose::enclose;
pub use findings::{Findings, MassSource};
use hausdorff::{in_unit, measure};
use mass::mass_properties;
use parts::Parts;
use start::{Start, start};
use std::ops::ControlFlow;
use surface::Surface;
use triangle_tree::TriangleTree;
use watch::Watch;

/// What to build.
#[derive(Clone, Debug, PartialEq)]
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
    /// No point of either surface exceeds its distance above by more than this: a quarter of the
    /// error, or more where the error is below a thousandth of the size.
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
    /// What was found in the input and what was done about it, counted.
    pub findings: Findings,
    /// The same in words, and which limit bound.
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
        vertices: &[Vector],
        indices: &[[u32; 3]],
        options: &BuildOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(MedialMesh, BuildReport), BuildError> {
        let limits = Limits::new(options)?;
        let mut watch = Watch::new(progress);
        watch.begin("surface")?;
        let (surface, tree) = Surface::new(vertices, indices, &mut watch)?;
        let mut source = Source {
            surface,
            tree,
            limits,
        };
        let candidate = source.best_candidate(&mut watch)?;
        watch.begin("mass")?;
        let surface = source.surface;
        let (mass, mass_source) = mass_properties(&surface, &mut watch)?;
        let mut mesh = candidate.draft.to_medial_mesh(&surface.frame)?;
        if let Some(mass) = mass {
            mesh = mesh.with_mass_properties(mass);
        }
        let mut findings = surface.findings;
        findings.mass = mass_source;
        let mut notes = findings.notes();
        notes.extend(candidate.notes);
        let frame = surface.frame;
        let report = BuildReport {
            hausdorff: in_unit(candidate.hausdorff, frame.scale),
            hausdorff_before_enclosure: candidate.before.map(|h| in_unit(h, frame.scale)),
            longest_side: frame.scale as Real,
            primitives: mesh.primitive_count(),
            findings,
            notes,
            seconds: watch.finish()?,
        };
        Ok((mesh, report))
    }
}

/// Counts tried when the error is the limit shrink by this factor from one to the next.
const LADDER: f64 = 0.8;

/// What the options ask for.
struct Limits {
    primitives: Option<usize>,
    max_error: Option<f64>,
    enclose: bool,
}

impl Limits {
    fn new(options: &BuildOptions) -> Result<Self, BuildError> {
        if options.primitives == Some(0) {
            return Err(BuildError::Option {
                option: "primitives",
                value: 0.0,
                must: "at least 1",
            });
        }
        let max_error = options.max_error.map(f64::from);
        if let Some(value) = max_error.filter(|e| !(*e > 0.0 && e.is_finite())) {
            return Err(BuildError::Option {
                option: "max_error",
                value,
                must: "above 0 and finite",
            });
        }
        let unlimited = options.primitives.is_none() && max_error.is_none();
        let default = BuildOptions::default().primitives;
        Ok(Self {
            primitives: if unlimited {
                default
            } else {
                options.primitives
            },
            max_error,
            enclose: options.enclose,
        })
    }

    /// Samples of the surface that the medial mesh starts from: three for each primitive wanted, or
    /// neighbours at about twice the error allowed.
    fn samples(&self, area: f64) -> usize {
        const LEAST: usize = 10_000;
        const MOST: usize = 200_000;
        let by_count = self.primitives.map_or(0, |n| n.saturating_mul(3));
        let by_error = self.max_error.map_or(0.0, |e| area / (4.0 * e * e));
        by_count
            .max((by_error as usize).min(6 * LEAST))
            .clamp(LEAST, MOST)
    }
}

/// A finished medial mesh and what was measured on it, in the builder's frame.
struct Candidate {
    draft: Draft,
    hausdorff: Hausdorff,
    before: Option<Hausdorff>,
    notes: Vec<String>,
}

impl Candidate {
    fn error(&self) -> f64 {
        let h = &self.hausdorff;
        f64::from(h.surface_to_envelope.max(h.envelope_to_surface))
    }
}

/// The checked surface, its tree, and what to build from it.
struct Source {
    surface: Surface,
    tree: TriangleTree,
    limits: Limits,
}

impl Source {
    /// Balls inside where the surface bounds matter, slabs where it is a sheet.
    fn best_candidate(&mut self, watch: &mut Watch) -> Result<Candidate, BuildError> {
        let count = self.limits.samples(self.surface.area);
        let mut findings = std::mem::take(&mut self.surface.findings);
        let start = start(&self.surface, &self.tree, count, &mut findings, watch)?;
        self.surface.findings = findings;
        self.candidate(start, watch)
    }

    /// Simplifies to the limits, encloses and measures.
    fn candidate(&self, start: Start, watch: &mut Watch) -> Result<Candidate, BuildError> {
        watch.begin("simplify")?;
        let mut simplifier = Parts::new(start, &self.tree, watch)?;
        let most = self.limits.primitives.unwrap_or(usize::MAX);
        simplifier.reduce_to(most, watch)?;
        let mut candidate = match self.limits.max_error {
            None => self.finish(simplifier.draft(), watch)?,
            Some(error) => self.coarsest(&mut simplifier, error, watch)?,
        };
        if simplifier.broke_topology() {
            candidate
                .notes
                .push("holes or parts were given up to reach the count".into());
        }
        Ok(candidate)
    }

    /// The fewest primitives whose error is at most `max_error`, among counts in ratio [`LADDER`].
    fn coarsest(
        &self,
        simplifier: &mut Parts,
        max_error: f64,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let mut rungs = vec![simplifier.draft()];
        while simplifier.primitives() > 1 {
            watch.begin("simplify")?;
            let next = (simplifier.primitives() as f64 * LADDER) as usize;
            let before = simplifier.primitives();
            simplifier.reduce_to(next, watch)?;
            if simplifier.primitives() == before {
                break;
            }
            rungs.push(simplifier.draft());
        }
        let finest = rungs[0].primitives().len();
        let mut best: Option<Candidate> = None;
        // Rungs below `fine` keep the limit, rungs from `coarse` on break it.
        let (mut fine, mut coarse) = (0, rungs.len());
        while fine < coarse {
            let middle = fine + (coarse - fine) / 2;
            let candidate = self.finish(rungs[middle].clone(), watch)?;
            if candidate.error() <= max_error {
                fine = middle + 1;
                best = Some(candidate);
            } else {
                coarse = middle;
            }
        }
        let (mut candidate, binding) = match best {
            Some(candidate) => (candidate, "max_error"),
            None => (self.finish(rungs.swap_remove(0), watch)?, "primitives"),
        };
        let count = candidate.draft.primitives().len();
        let error = candidate.error();
        candidate.notes.push(match (binding, self.limits.primitives) {
            ("max_error", _) if count < finest => {
                format!("max_error {max_error} bound first: {count} primitives, error {error:.5}")
            }
            ("max_error", _) => format!("error {error:.5} is within max_error {max_error}"),
            (_, Some(most)) => format!(
                "primitives {most} bound first: error {error:.5} is above max_error {max_error}"
            ),
            (_, None) => format!(
                "max_error {max_error} is out of reach: error {error:.5} with all {count} primitives"
            ),
        });
        Ok(candidate)
    }

    /// Encloses when asked to, and measures before and after.
    fn finish(&self, mut draft: Draft, watch: &mut Watch) -> Result<Candidate, BuildError> {
        watch.begin("measure")?;
        let mut hausdorff = measure(&self.surface, &self.tree, &draft, watch)?;
        let mut before = None;
        if self.limits.enclose {
            before = Some(hausdorff);
            watch.begin("enclose")?;
            enclose(&mut draft, &self.surface, watch)?;
            watch.begin("measure")?;
            hausdorff = measure(&self.surface, &self.tree, &draft, watch)?;
        }
        Ok(Candidate {
            draft,
            hausdorff,
            before,
            notes: Vec::new(),
        })
    }
}
