//! What a build is asked for, and what it reports.

use super::findings::Findings;
use crate::error::BuildError;
use crate::math::Real;

/// How much work a build spends on a small error.
///
/// A higher one never gives a larger error (the larger direction of [`BuildReport::hausdorff`],
/// within its sampling): it compares its result with the lower one's and keeps the better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// Edge collapse by quadric error (Q-MAT).
    Fast,
    /// Then collapse by measured error, insertion where it is largest, least-squares refit.
    #[default]
    Balanced,
    /// Then several starts for small counts, and rounds of swaps.
    Best,
}

/// Which sharp convex edges of the source may be kept, by spheres of radius 0 on them.
///
/// Convex bodies with flat faces, alone or several apart, become their own medial axis, which is exact,
/// where the limit on the count allows it. Other closed bodies keep what makes the error
/// smallest: all medial meshes are measured, those with spheres of radius 0 and one without
/// ([`Quality::Fast`]: that one only). `BuildReport::notes` says what came out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Creases {
    /// Those above 25°, unless most of them end within a face, as those of a coarse organic mesh do; between
    /// flat faces of a convex body all.
    #[default]
    Auto,
    /// Those at which the faces' normals differ by more than this angle (rad).
    Keep(Real),
    /// None: spheres of radius 0 are avoided.
    None,
}

impl Creases {
    /// The angle (rad) above which an edge is sharp; `None` where none is kept.
    pub(super) fn angle(self) -> Option<f64> {
        /// 25°: above what facets bend a curved face by.
        const SHARP: f64 = 0.4363;
        self.angle_or(SHARP)
    }

    /// The same between flat faces.
    pub(super) fn angle_of_flat(self) -> Option<f64> {
        /// Above the rounding of normals only: faces are told apart by their vertices.
        const SHARP: f64 = 1e-6;
        self.angle_or(SHARP)
    }

    fn angle_or(self, sharp: f64) -> Option<f64> {
        match self {
            Self::Auto => Some(sharp),
            Self::Keep(angle) => Some(angle.into()),
            Self::None => None,
        }
    }
}

/// What to build.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Largest number of primitives (slabs, cones that belong to no slab, lone spheres).
    pub primitives: Option<usize>,
    /// Largest two-sided Hausdorff error after enclosure, as a fraction of the longest side of the bounding box:
    /// the smallest mesh that keeps it is built, as far as counts were tried (`BuildReport::notes`). With `primitives`
    /// as well it has no more than those. Where none keeps it, the best is built, and
    /// [`BuildReport::target_reached`] is false. Takes five to fifteen times as long as a count does.
    pub max_error: Option<Real>,
    /// How much work to spend.
    pub quality: Quality,
    /// Enlarge radii until the solid provably covers the whole source surface.
    pub enclose: bool,
    /// How far the source surface may stick out of the enclosed solid, as a fraction of the longest
    /// side of the bounding box. Enclosure then proves this instead: bloat falls by up to as much.
    pub allow_uncovered: Real,
    /// Which sharp edges to keep.
    pub creases: Creases,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            primitives: Some(500),
            max_error: None,
            quality: Quality::default(),
            enclose: true,
            allow_uncovered: 0.0,
            creases: Creases::Auto,
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

/// Two-sided distance between a source surface and the solid's boundary, in the user's unit. What of the source
/// lies inside the matter that its parts make together is no surface here.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hausdorff {
    /// Largest distance from the source surface to the solid's boundary.
    pub surface_to_envelope: Real,
    /// Largest distance from the solid's boundary to the source surface.
    pub envelope_to_surface: Real,
    /// How far the source surface sticks out of the solid.
    pub uncovered: Real,
    /// How far the solid sticks out of the source surface, at the points examined.
    pub bloat: Real,
    /// No point of either surface is farther from the other than [`Self::error`] and this: a quarter
    /// of the error ([`Quality::Fast`] without [`BuildOptions::max_error`]: half), or more where the
    /// error is below two thousandths of the size, or the search runs out of its budget.
    pub sampling: Real,
}

impl Hausdorff {
    /// The two-sided distance: the larger of both directions.
    pub fn error(&self) -> Real {
        self.surface_to_envelope.max(self.envelope_to_surface)
    }
}

/// Of what kind a medial mesh is: which of those that were made of one body came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Variant {
    /// Balls inside, slabs of sheets: edges are rounded.
    #[default]
    Rounded,
    /// Spheres of radius 0 on sharp convex edges.
    Creased {
        /// Edges of the source that may be kept: those that pay are.
        edges: usize,
    },
    /// The medial axis of convex polyhedra, exact.
    Exact,
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
    /// Of what kind it is.
    pub variant: Variant,
    /// Euler number of the result's complex: spheres − edges + faces. 1 for a ball, 0 for a ring.
    pub euler: i64,
    /// Whether the result keeps every limit asked for. The count is always kept.
    pub target_reached: bool,
    /// What was found in the input and what was done about it, counted.
    pub findings: Findings,
    /// Area of the source that lies inside solid matter, where other parts hide it, in the user's unit squared: the
    /// error is that of the boundary of the solid, and this counts for nothing.
    pub hidden_area: Real,
    /// The same in words, and which limit bound.
    pub notes: Vec<String>,
    /// Most bytes that the builder's large arrays held at any time: the sum of their capacities. An
    /// estimate from below: small lists, and what the allocator adds, are not in it, nor is the
    /// caller's mesh.
    pub memory: usize,
    /// Seconds per stage, in order.
    pub seconds: Vec<(&'static str, f64)>,
}

/// The options, checked, in double precision.
pub(super) struct Limits {
    pub primitives: Option<usize>,
    pub max_error: Option<f64>,
    pub quality: Quality,
    pub enclose: bool,
    pub allow_uncovered: f64,
    pub creases: Creases,
}

impl Limits {
    pub fn new(options: &BuildOptions) -> Result<Self, BuildError> {
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
        let allow_uncovered = f64::from(options.allow_uncovered);
        if !(allow_uncovered >= 0.0 && allow_uncovered.is_finite()) {
            return Err(BuildError::Option {
                option: "allow_uncovered",
                value: allow_uncovered,
                must: "at least 0 and finite",
            });
        }
        if let Creases::Keep(angle) = options.creases
            && !(angle > 0.0 && angle.is_finite())
        {
            return Err(BuildError::Option {
                option: "creases",
                value: angle.into(),
                must: "an angle above 0 and finite",
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
            quality: options.quality,
            enclose: options.enclose,
            allow_uncovered,
            creases: options.creases,
        })
    }

    /// Samples of the surface that the medial mesh starts from: two for each primitive wanted, or
    /// neighbours at about twice the error allowed. Measured up to 5,000 primitives: eight for each give
    /// nothing more; half of the least loses a third at 500.
    pub fn samples(&self, area: f64) -> usize {
        const LEAST: usize = 10_000;
        const MOST: usize = 200_000;
        let by_count = self.primitives.map_or(0, |n| n.saturating_mul(2));
        let by_error = self.max_error.map_or(0.0, |e| area / (4.0 * e * e));
        by_count
            .max((by_error as usize).min(2 * LEAST))
            .clamp(LEAST, MOST)
    }
}
