//! The medial mesh of a prism: its profile with as many edges as the count allows, and the roof over that, which is exact
//! for it (`prism_axis.rs`).

use crate::error::BuildError;
use crate::meshing::axis::prism_axis::prism_axis;
use crate::meshing::draft::Draft;
use crate::meshing::options::Variant;
use crate::meshing::recipe::candidate::Candidate;
use crate::meshing::recipe::polyhedron::MOST;
use crate::meshing::recipe::source::Source;
use crate::meshing::surface::profile::Profile;
use crate::meshing::watch::Watch;

/// Thicknesses within which profiles are brought to fewer edges (longest side 1), and their ratio.
const THICKEST: f64 = 0.05;
const THINNEST: f64 = 1e-4;
const STEP: f64 = 0.85;

/// Ridges shorter than this share of the thickness are points. With 1 the count is hardly less.
const SAME: f64 = 0.25;

/// Radii are larger by this (longest side 1): what is covered needs no proof by the smallest pieces then.
const MARGIN: f64 = 1e-5;

/// A draft that is off by more than so many thicknesses, at few samples, is not of the body: it is no prism, but for its
/// outline.
const FAR: f64 = 4.0;

impl Source {
    /// The medial mesh of the prism nearest to a body that is one, or nearly, of as many primitives as are allowed.
    pub fn extruded(&self, watch: &mut Watch) -> Result<Option<Candidate>, BuildError> {
        watch.begin("samples")?;
        let surface = &self.surface;
        let keeps_creases = self.limits.creases.angle_of_flat().is_some();
        let is_solid = surface.simple && !surface.sheet.contains(&true);
        if !keeps_creases || !is_solid || !surface.lids.is_empty() {
            return Ok(None);
        }
        let Some(profile) = Profile::new(surface) else {
            return Ok(None);
        };
        let Some((thickness, edges, draft)) = self.prism(&profile, watch)? else {
            return Ok(None);
        };
        let limit = FAR * thickness;
        let error = self.rough_target().largest_below(&draft, limit, watch)?;
        if error.is_none() {
            return Ok(None);
        }
        let enclosed = self.or_better(None, draft, None, watch)?;
        let mut candidate = self.reported(enclosed, watch)?;
        candidate.variant = Variant::Creased { edges: 3 * edges };
        candidate.notes.push(format!(
            "a prism: its profile is brought to {edges} edges, and the roof over that is exact"
        ));
        Ok(Some(candidate))
    }

    /// Of the thinnest prisms about a profile the one that is within the count: its thickness, the edges of its profile, and
    /// its balls and slabs.
    fn prism(
        &self,
        profile: &Profile,
        watch: &mut Watch,
    ) -> Result<Option<(f64, usize, Draft)>, BuildError> {
        let most = self.limits.primitives.unwrap_or(MOST).min(MOST);
        let mut best = None;
        let mut last = 0;
        let mut thickness = THICKEST;
        while thickness > THINNEST {
            watch.again()?;
            if let Some(loops) = profile.loops_within(thickness) {
                let edges = loops.iter().map(Vec::len).sum();
                // Each edge has a slab at each cap or more.
                if 2 * edges > most {
                    break;
                }
                let is_new = edges != last;
                last = edges;
                if is_new
                    && let Some(draft) = prism_axis(&loops, profile.half, SAME * thickness)
                    && draft.primitives().len() <= most
                {
                    best = Some((thickness, edges, draft));
                }
            }
            thickness *= STEP;
        }
        if let Some((_, _, draft)) = &mut best {
            for ball in &mut draft.balls {
                ball.center = profile.place(ball.center);
                ball.radius += MARGIN;
            }
        }
        Ok(best)
    }
}
