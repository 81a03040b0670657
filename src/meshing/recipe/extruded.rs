//! The medial mesh of a prism: its profile with as many edges as the count allows, and the roof over that, which is
//! exact for it (`prism_axis.rs`), or its thick part and ribs (`ribs.rs`), which take fewer slabs.

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::axis::prism_axis::prism_axis;
use crate::meshing::axis::ribs::{Opened, Rib};
use crate::meshing::certify::largest::Effort;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::options::Variant;
use crate::meshing::recipe::candidate::{Candidate, Enclosed};
use crate::meshing::recipe::polyhedron::MAX_PRIMITIVES;
use crate::meshing::recipe::source::Source;
use crate::meshing::surface::profile::{Profile, fewer};
use crate::meshing::watch::Watch;

/// Largest thickness within which a profile is brought to fewer edges (longest side 1): the coarsest prism that is
/// tried.
const THICKEST: f64 = 0.05;

/// Thickness at which the search for a profile ends (longest side 1), if the count of primitives has not ended it
/// before.
const THINNEST: f64 = 1e-4;

/// Ratio of each thickness to the one before. Nearer to 1, and more profiles are tried, in more time.
const STEP: f64 = 0.85;

/// Half of the thickness below which parts of a profile are ribs (longest side 1). All are tried.
const RIB_HALVES: [f64; 6] = [0.015, 0.02, 0.03, 0.045, 0.065, 0.09];

/// Thickness within which a profile without its ribs is brought to fewer edges, in units of the thickness within which
/// the whole profile was. All are tried.
const COARSER: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];

/// Largest number of edges of a profile that is tried with ribs: the time for a roof grows with the third power of it.
const MOST_RIBBED: usize = 256;

/// Length of the roof's ridges, in units of the thickness, below which their two ends become one. At 1 the count of
/// slabs is hardly less.
const MIN_RIDGE: f64 = 0.25;

/// Radii are larger by this (longest side 1): what is covered needs no proof by the smallest pieces then.
const MARGIN: f64 = 1e-5;

/// Largest error at a few samples, in units of the thickness, of a draft that is not discarded: where it is more, the
/// body is a prism by its outline alone.
const MAX_ROUGH_ERROR: f64 = 4.0;

/// Largest error (longest side 1) of a prism that is returned without a fit besides: fits of prisms by 200 primitives
/// are off by .002 to .006.
pub const NEAR: f64 = 2.5e-3;

/// The balls and slabs of a prism near to a body.
struct Prism {
    draft: Draft,
    count: usize,
    /// Largest distance (longest side 1) by which it may be off at a few samples; a draft that is off by more is not of
    /// the body.
    far: f64,
    /// The edges of its profile.
    edges: usize,
    /// Description of its parts, for the report.
    parts: String,
}

impl Source {
    /// The medial mesh of the prism nearest to a body that is one, or nearly, of as many primitives as are allowed.
    pub fn extruded(&self, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        let Some(profile) = self.profile(watch)? else {
            return Ok(None);
        };
        let most = self
            .limits
            .primitives
            .unwrap_or(MAX_PRIMITIVES)
            .min(MAX_PRIMITIVES);
        let mut best: Option<(f64, Prism)> = None;
        let rough = self.rough_target();
        for kind in [PrismKind::Roof, PrismKind::Ribbed] {
            for prism in prisms(&profile, most, kind, watch)?.into_iter().rev() {
                let limit = best.as_ref().map_or(f64::INFINITY, |best| best.0);
                let error = rough.largest_below(&prism.draft, limit.min(prism.far), watch)?;
                if let Some(error) = error {
                    best = Some((error, prism));
                }
            }
            if best.as_ref().is_some_and(|best| best.0 <= NEAR) {
                break;
            }
        }
        let Some((_, prism)) = best else {
            return Ok(None);
        };
        let enclosed = self.or_better(None, prism.draft.clone(), None, watch)?;
        Ok(Some(self.named(enclosed, &prism, watch)?))
    }

    /// The smallest of these that is off by at most `limit`.
    pub fn extruded_within(
        &self,
        limit: f64,
        watch: &mut Watch,
    ) -> Result<Option<Candidate>, BuildError> {
        let Some(profile) = self.profile(watch)? else {
            return Ok(None);
        };
        let most = self
            .limits
            .primitives
            .unwrap_or(MAX_PRIMITIVES)
            .min(MAX_PRIMITIVES);
        let mut all = prisms(&profile, most, PrismKind::Roof, watch)?;
        all.extend(prisms(&profile, most, PrismKind::Ribbed, watch)?);
        all.sort_by_key(|prism| prism.count);
        let rough = self.rough_target();
        let effort = Effort {
            enough: limit,
            ..Effort::FINE
        };
        for prism in all {
            let far = prism.far.min(limit);
            if rough.largest_below(&prism.draft, far, watch)?.is_none() {
                continue;
            }
            let enclosed = self.enclosed(prism.draft.clone(), effort, watch)?;
            if enclosed.error() <= limit {
                let mut candidate = self.named(enclosed, &prism, watch)?;
                candidate.notes.push(format!(
                    "max_error {} is kept by {} primitives: error {:.6}",
                    limit as Real,
                    prism.count,
                    candidate.error()
                ));
                return Ok(Some(candidate));
            }
        }
        Ok(None)
    }

    fn named(
        &self,
        enclosed: Enclosed,
        prism: &Prism,
        watch: &mut Watch,
    ) -> Result<Candidate, BuildError> {
        let mut candidate = self.reported(enclosed, watch)?;
        candidate.variant = Variant::Creased {
            edges: 3 * prism.edges,
        };
        candidate.notes.push(format!(
            "a prism: its profile is brought to {} edges, {}",
            prism.edges, prism.parts
        ));
        Ok(candidate)
    }

    /// The profile of a body that is a prism but for its outline.
    fn profile(&self, watch: &mut Watch) -> Result<Option<Profile>, BuildError> {
        watch.begin("samples")?;
        let surface = &self.surface;
        let keeps_creases = self.limits.creases.angle_of_flat().is_some();
        let is_solid = surface.simple && !surface.sheet.contains(&true);
        Ok(match keeps_creases && is_solid && surface.lids.is_empty() {
            true => Profile::new(surface),
            false => None,
        })
    }
}

/// Construction of prisms.
#[derive(Clone, Copy, PartialEq)]
enum PrismKind {
    /// Roofs alone.
    Roof,
    /// Roofs and ribs.
    Ribbed,
}

/// Prisms near to a profile, of at most `most` slabs: those of fewest first.
fn prisms(
    profile: &Profile,
    most: usize,
    kind: PrismKind,
    watch: &mut Watch,
) -> Result<Vec<Prism>, BuildError> {
    watch.begin("samples")?;
    // Each edge has a slab at each cap or more, but those of ribs.
    let most_edges = match kind {
        PrismKind::Roof => most / 2,
        PrismKind::Ribbed => most.min(MOST_RIBBED),
    };
    let mut prisms = Vec::new();
    let mut last = 0;
    let mut thickness = THICKEST;
    while thickness > THINNEST {
        watch.again()?;
        if let Some(loops) = profile.loops_within(thickness) {
            let edges = loops.iter().map(Vec::len).sum();
            if edges > most_edges {
                break;
            }
            if edges != last {
                last = edges;
                let mut add = |draft: Draft, far, parts| {
                    let count = draft.primitives().len();
                    if (1..=most).contains(&count) {
                        prisms.push(Prism {
                            draft,
                            count,
                            far,
                            edges,
                            parts,
                        });
                    }
                };
                match kind {
                    PrismKind::Roof => {
                        if let Some(draft) = prism_axis(&loops, profile.half, MIN_RIDGE * thickness)
                        {
                            let parts = "and the roof over that is exact".to_owned();
                            add(draft, MAX_ROUGH_ERROR * thickness, parts);
                        }
                    }
                    PrismKind::Ribbed => {
                        ribbed(&loops, profile, (thickness, most), watch, &mut add)?
                    }
                }
            }
        }
        thickness *= STEP;
    }
    for ball in prisms.iter_mut().flat_map(|p| &mut p.draft.balls) {
        ball.center = profile.place(ball.center);
        ball.radius += MARGIN;
    }
    prisms.sort_by_key(|prism| prism.count);
    Ok(prisms)
}

/// Prisms of at most `most` slabs over `loops` whose thin parts are ribs, and the rest of fewer edges.
fn ribbed(
    loops: &[Vec<Point>],
    profile: &Profile,
    (thickness, most): (f64, usize),
    watch: &mut Watch,
    add: &mut impl FnMut(Draft, f64, String),
) -> Result<(), BuildError> {
    let mut seen: Vec<Vec<bool>> = Vec::new();
    for thin in RIB_HALVES {
        watch.again()?;
        let Some(opened) = Opened::new(loops, thin) else {
            continue;
        };
        if seen.contains(&opened.is_rib) {
            continue;
        }
        seen.push(opened.is_rib.clone());
        let of_ribs = opened.is_rib.iter().filter(|is_rib| **is_rib).count();
        let mut last = usize::MAX;
        for coarser in COARSER.map(|c| c * thickness) {
            let thick: Option<Vec<_>> = opened.loops.iter().map(|l| fewer(l, coarser)).collect();
            let Some(thick) = thick else { continue };
            let edges: usize = thick.iter().map(Vec::len).sum();
            if edges == last {
                continue;
            }
            last = edges;
            let rest = match edges {
                0 => "all of it is ribs".to_owned(),
                _ => format!("that of the rest without its ribs to {edges}"),
            };
            for (rib, what) in [
                (Rib::Exact, "exact"),
                (Rib::Plate, "a round plate each"),
                (Rib::TwoPlates, "two round plates each"),
            ] {
                // Each edge has a slab at each cap or more, but those of plates.
                let least = 2 * edges + if rib == Rib::Exact { 2 * of_ribs } else { 0 };
                if least <= most
                    && let Some(draft) =
                        opened.draft(&thick, profile.half, MIN_RIDGE * coarser, rib)
                {
                    add(draft, THICKEST, format!("{rest}, and ribs are {what}"));
                }
            }
        }
    }
    Ok(())
}
