//! The options of a build, its progress, and its report.

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::findings::Findings;

/// How much work a build spends on making the error small.
///
/// A higher quality never gives a larger error ([`Hausdorff::error`], give or take its `sampling`), because a build
/// also makes the result of the lower quality and keeps the better one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// A fifth of the time of [`Self::Balanced`], and one and a half to three times its error, of some creatures six
    /// times, of vases and plates with walls of a hundredth of the size up to thirty times. Edges are collapsed in the
    /// order of an estimated error (the quadric error of Q-MAT); nothing else is done.
    Fast,
    /// The default. After the work of [`Self::Fast`], edges are collapsed by the measured error, primitives are
    /// inserted where the error is largest, and centres and radii are fitted by least squares.
    #[default]
    Balanced,
    /// Three times the time of [`Self::Balanced`] for little gain. There are more rounds, in which primitives are
    /// removed in one place and inserted in another. If the number of primitives is small, there is also a second
    /// start.
    Best,
}

/// Which edges of the triangle mesh count as sharp. Convex sharp edges may be kept, by spheres of radius 0 that lie
/// on them; all other edges are rounded.
///
/// Bodies with flat faces are exact if the number of primitives allows it: their medial axis is used, or, if they are
/// not convex, those of convex pieces. Prisms are so with any angle, others if all their edges are sharper than it, and
/// none without edges. Other closed bodies whose surface does not overlap itself are built twice, with sharp edges and
/// without, and the result with the smaller error is returned ([`Quality::Fast`] builds only the one without).
/// [`BuildReport::variant`] and [`BuildReport::notes`] say which it is.
///
/// ```
/// use rapier3d_medial::prelude::*;
/// let options = BuildOptions { creases: Creases::Keep(40_f32.to_radians()), ..Default::default() };
/// # assert_eq!(options.primitives, Some(500));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Creases {
    /// Edges at which the surface bends by more than 25°. If most of these edges end within a face, as on a coarse
    /// mesh of an animal, no edges. On a convex body with flat faces, all edges.
    #[default]
    Auto,
    /// Edges at which the normals of the two faces differ by more than this angle, in radians.
    Keep(Real),
    /// No edges: all are rounded.
    None,
}

impl Creases {
    /// The angle (rad) above which an edge is sharp; `None` where none is kept.
    pub(crate) fn angle(self) -> Option<f64> {
        /// 25°: above what facets bend a curved face by.
        const SHARP: f64 = 0.4363;
        self.angle_or(SHARP)
    }

    /// The angle (rad) above which an edge between two flat faces is sharp; `None` where none is kept.
    pub(crate) fn angle_of_flat(self) -> Option<f64> {
        /// Angle just above the rounding of normals: faces are told apart by their vertices.
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

/// Options of [`crate::MedialMesh::from_trimesh`]. The defaults are 500 primitives, balanced quality, and
/// a solid that covers the triangle mesh.
///
/// ```
/// use rapier3d_medial::prelude::*;
/// // At most 100 primitives:
/// let by_count = BuildOptions { primitives: Some(100), ..Default::default() };
/// // As few primitives as keep the error below 1 % of the mesh's longest side:
/// let by_error = BuildOptions { primitives: None, max_error: Some(0.01), ..Default::default() };
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Largest number of primitives (slabs, cones that belong to no slab, lone spheres). It decides what the collider
    /// costs. At least 1. With `None`, `max_error` decides the number; if that is `None` too, it is 500.
    pub primitives: Option<usize>,
    /// Largest error ([`Hausdorff::error`] of the result), as a fraction of the longest side of the bounding box. Above
    /// 0. Several numbers of primitives are tried ([`BuildReport::notes`]), and the smallest mesh that keeps to this
    /// error is returned. If `primitives` is set as well, the mesh has at most that many. If no mesh keeps to the
    /// error, the best one found is returned, and [`BuildReport::target_reached`] is false. A build with `max_error`
    /// takes five to fifteen times as long as one for a given number of primitives.
    pub max_error: Option<Real>,
    /// How much work to spend on making the error small.
    pub quality: Quality,
    /// Whether the solid provably covers the whole triangle mesh: spheres are moved and enlarged until it does
    /// ([`Quality::Fast`] only enlarges them). With `false`, the error is about seven tenths as large, and parts of
    /// the triangle mesh stick out of the solid.
    pub enclose: bool,
    /// Distance by which the triangle mesh may stick out of the solid in spite of `enclose`, as a fraction of the
    /// longest side of the bounding box; at least 0. The solid becomes thinner by up to this distance.
    pub allow_uncovered: Real,
    /// Which edges of the triangle mesh count as sharp.
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

/// How far a build has got. The build passes it to its callback
/// ([`MedialMesh::from_trimesh_with_progress`](crate::MedialMesh::from_trimesh_with_progress)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Name of the running stage, in English: `"surface"`, `"simplify"`, `"refit"`, `"measure"` and others. Which
    /// stages there are depends on the mesh and may change; they are for people to read.
    pub stage: &'static str,
    /// Share of the whole build that is done, from 0 to 1. It is estimated, and never falls.
    pub fraction: Real,
}

/// How far a medial mesh is from the triangle mesh: the Hausdorff distance of the two surfaces, which is the largest
/// distance from a point of either surface to the nearest point of the other. All fields are lengths in the user's
/// unit. All parts of the triangle mesh together make one solid; triangles that lie inside it do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hausdorff {
    /// Largest distance from a point of the triangle mesh to the surface of the medial mesh.
    pub surface_to_envelope: Real,
    /// Largest distance from a point on the surface of the medial mesh to the triangle mesh. Only the larger of the two
    /// distances is searched for to the end: if this one is the smaller, it is a lower bound, and may be 0.
    pub envelope_to_surface: Real,
    /// How far the triangle mesh sticks out of the medial mesh, at the points that were measured; nowhere farther than
    /// [`Self::bound`]. With [`BuildOptions::enclose`] it sticks out nowhere by more than
    /// [`BuildOptions::allow_uncovered`] permits.
    pub uncovered: Real,
    /// How far the medial mesh sticks out of the triangle mesh, at the points that were measured.
    pub bloat: Real,
    /// Uncertainty of [`Self::error`], since only some points were measured: no point of either surface is farther from
    /// the other than `error() + sampling`. It is a quarter of the error (half with [`Quality::Fast`] and no
    /// [`BuildOptions::max_error`]), or more if the error is below 0.2 % of the longest side or the
    /// search ran out of its budget. For [`Variant::Exact`] it follows from how the result is made.
    pub sampling: Real,
}

impl Hausdorff {
    /// The Hausdorff distance: the larger of [`Self::surface_to_envelope`] and [`Self::envelope_to_surface`].
    pub fn error(&self) -> Real {
        self.surface_to_envelope.max(self.envelope_to_surface)
    }

    /// The largest distance that is possible anywhere, also between the points measured: [`Self::error`] plus
    /// [`Self::sampling`]. Compare [`Self::error`] with [`BuildOptions::max_error`]: of round bodies the bound may be
    /// several times as large.
    pub fn bound(&self) -> Real {
        self.error() + self.sampling
    }
}

/// Whether the sharp edges of a triangle mesh were kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Variant {
    /// All edges are rounded.
    #[default]
    Rounded,
    /// Sharp convex edges are kept where that makes the error smaller, by spheres of radius 0 on them.
    Creased {
        /// Number of edges of the triangle mesh that could be kept.
        edges: usize,
    },
    /// Edges of a medial mesh that would be exact, with [`BuildReport::exact_with`] primitives, were collapsed until it
    /// had as few as you allow. Most of its faces and sharp edges are still exact, and its error is at most 0.5 %
    /// of the longest side. If the body is compact, the exact one is several times as fast in a simulation.
    Reduced,
    /// The medial mesh is exact: it consists of the medial axes of convex bodies with flat faces, or of overlapping
    /// convex pieces that together are the body. For such pieces [`Hausdorff::error`] is measured:
    /// some 1e-6 of the longest side. It is larger if vertices lie off the planes of their faces
    /// (1e-4 to 2e-4 of the longest side, if they are off by up to 2e-5 of it), or are rounded
    /// because the mesh is far from the origin. [`Hausdorff::sampling`] follows from how the pieces
    /// are made: 1e-5 of the longest side, or 4e-4 of it if vertices are off.
    Exact,
}

/// The report of a build: how far the result is from the triangle mesh, and what was repaired.
///
/// Look first at [`Self::hausdorff`] (the error), [`Self::target_reached`] (whether you got what you
/// asked for) and [`Self::notes`] (what you should know, in sentences).
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildReport {
    /// How far the result is from the triangle mesh, in the user's unit.
    pub hausdorff: Hausdorff,
    /// How far the result was before spheres were moved and enlarged to cover the triangle mesh; `None` without
    /// [`BuildOptions::enclose`].
    pub hausdorff_before_enclosure: Option<Hausdorff>,
    /// Longest side of the triangle mesh's bounding box, in the user's unit. Errors are often given as fractions of it.
    pub longest_side: Real,
    /// Number of primitives of the result.
    pub primitives: usize,
    /// Number of primitives with which the result would be exact. `None` if it is exact already, or
    /// if that takes more primitives than you allow and than twice the default of
    /// [`BuildOptions::primitives`]. Bodies with flat faces are often exact with few.
    pub exact_with: Option<usize>,
    /// Whether sharp edges were kept.
    pub variant: Variant,
    /// Euler number of the result: spheres − edges + faces. It is 1 for a ball, 0 for a ring. If the result consists of
    /// overlapping convex pieces (see [`Self::notes`]), it is the number of pieces.
    pub euler: i64,
    /// Whether the result keeps to [`BuildOptions::max_error`]; true if none was asked for.
    /// [`BuildOptions::primitives`] is never exceeded.
    pub target_reached: bool,
    /// How many faults were found in the triangle mesh, and how many repairs were made.
    pub findings: Findings,
    /// Area of the triangle mesh that lies inside the solid, hidden by other parts, in the user's unit squared. It
    /// does not count in the error.
    pub hidden_area: Real,
    /// Remarks on the triangle mesh and the result, a sentence each.
    pub notes: Vec<String>,
    /// The most bytes that the builder's large arrays held at any one time. Small lists, overhead of the allocator
    /// and your own mesh are not included, so the true number is larger.
    pub memory: usize,
    /// Seconds that each stage took, in order.
    pub seconds: Vec<(&'static str, f64)>,
}

/// The options, checked, in double precision.
pub(crate) struct BuildLimits {
    pub primitives: Option<usize>,
    pub max_error: Option<f64>,
    pub quality: Quality,
    pub enclose: bool,
    pub allow_uncovered: f64,
    pub creases: Creases,
}

impl BuildLimits {
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

    /// Primitives up to which an exact result is looked for, be it only to tell of it: as many as are allowed, or twice
    /// the default if that is more.
    pub fn exact_up_to(&self) -> usize {
        let default = BuildOptions::default().primitives.unwrap_or(0);
        self.primitives.map_or(usize::MAX, |n| n.max(2 * default))
    }

    /// Number of samples of the surface that the medial mesh starts from: two for each primitive wanted, or
    /// so many that neighbours are at about twice the error allowed. `area` is that of the surface (longest side 1).
    /// Measured up to 5,000 primitives: eight for each give nothing more.
    pub fn samples(&self, area: f64) -> usize {
        /// Least number of samples. With half of it, results at 500 primitives are a third worse.
        const MIN_SAMPLES: usize = 10_000;
        /// Largest number of samples, which bounds the time and memory of a build.
        const MAX_SAMPLES: usize = 200_000;
        let by_count = self.primitives.map_or(0, |n| n.saturating_mul(2));
        let by_error = self.max_error.map_or(0.0, |e| area / (4.0 * e * e));
        by_count
            .max((by_error as usize).min(2 * MIN_SAMPLES))
            .clamp(MIN_SAMPLES, MAX_SAMPLES)
    }
}
