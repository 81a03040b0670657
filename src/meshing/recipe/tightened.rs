//! Fits a draft so that it covers the surface, and no farther than it must.
//!
//! Enclosure raises radii until all is covered, and a ball that grows for what sticks out on one side grows on all
//! sides: it doubles the error of a fit that is as much too small here as it is too large there. So what enclosure
//! made is fitted again, to lie between the surface and an offset of it that is nearer than its error, and enclosed
//! again, until a round gains little.
//!
//! The parts that stick out lie between the samples: ridges and corners most of all. Points at which the draft was
//! found not to cover the surface, or to reach far beyond it, become samples, as violated constraints do in a
//! cutting-plane method (Kelley, "The cutting-plane method for solving convex programs", 1960).

use crate::error::BuildError;
use crate::meshing::certify::inside::Solid;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::random::Random;
use crate::meshing::recipe::source::Source;
use crate::meshing::refine::refit::{FitTarget, refit};
use crate::meshing::refine::residuals::{is_far_inside, way_out};
use crate::meshing::surface::samples::{Sample, even_samples, vertex_samples};
use crate::meshing::watch::Watch;

/// How many times less an enclosed draft may be off once it is tightened.
pub const GAIN_OF_TIGHT: f64 = 1.5;

/// The offset that a fit aims at, as a share of the error: below a half there is no fit, and above two thirds
/// little is gained.
const OFFSET: f64 = 0.6;

/// Share of the least error so far at or above which a round's error ends the rounds: another would gain little.
const STALLED_RATIO: f64 = 0.98;

/// Largest number of rounds.
const ROUNDS: usize = 4;

/// Fits in a round. Between two of them, points that are off are added to the samples.
const FITS: usize = 2;

/// Iterations of each fit.
const ITERATIONS: usize = 3;

/// Share of a build's budget of fits beyond which no round begins.
const BUDGET: f64 = 1.0;

/// Points of the surface that are examined between two fits, besides its vertices.
const POINTS: usize = 30_000;

/// Distance by which a point sticks out of the draft to become a sample, in units of the error.
const SAMPLED_PROTRUSION: f64 = 0.02;

/// Depth of a point inside the draft at which it becomes a sample, in units of the error. It is above [`OFFSET`], the
/// depth that the fit aims at.
const SAMPLED_DEPTH: f64 = 0.75;

impl Source {
    /// A draft that covers the surface more closely than `loose`; `None` where none was found, or where `loose` is off
    /// by more than `most`, need not cover it, or the budget of fits is spent.
    pub fn tightened(
        &self,
        loose: &Draft,
        most: f64,
        target: &FitTarget,
        watch: &mut Watch,
    ) -> Result<Option<Draft>, BuildError> {
        if !self.limits.enclose || watch.ends_fit(BUDGET) {
            return Ok(None);
        }
        watch.begin("refit")?;
        let mut target = target.clone();
        target.budget = BUDGET;
        target.beyond = OFFSET * target.residuals(loose, watch)?.largest;
        let mut error = target.beyond + target.residuals(loose, watch)?.largest;
        if error > most {
            return Ok(None);
        }
        let surface = self.bounds().0;
        let mut points = even_samples(surface, POINTS, &mut Random::new(3));
        points.extend(vertex_samples(surface));
        let mut best = None;
        let mut draft = loose.clone();
        for _ in 0..ROUNDS {
            target.beyond = OFFSET * error;
            for fit in 0..FITS {
                if fit > 0 {
                    add_far(&mut target.samples, &points, &draft, error, watch)?;
                }
                watch.begin("refit")?;
                refit(&mut draft, &target, ITERATIONS, watch)?;
            }
            draft = self.covering(draft, watch)?.0;
            let now = target.beyond + target.residuals(&draft, watch)?.largest;
            let ends = now >= STALLED_RATIO * error || watch.ends_fit(BUDGET);
            if now < error {
                (best, error) = (Some(draft.clone()), now);
            }
            if ends {
                break;
            }
        }
        Ok(best)
    }
}

/// Adds to the samples the points that are off by much, for a draft that is off by `error`.
fn add_far(
    samples: &mut Vec<Sample>,
    points: &[Sample],
    draft: &Draft,
    error: f64,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let solid = Solid::new(draft);
    let [out, deep] = [SAMPLED_PROTRUSION * error, SAMPLED_DEPTH * error];
    let mut hint = 0;
    let mut work = 0;
    for (i, sample) in points.iter().enumerate() {
        if i % 64 == 0 {
            watch.again()?;
        }
        let near = solid.nearest(sample.point, hint);
        hint = near.primitive;
        let distance = near.signed.distance;
        let is_deep = is_far_inside(&solid, sample, &near, deep)
            && way_out(&solid, sample, hint, deep, &mut work)
                .is_some_and(|exit| (exit - sample.point).length() > deep);
        if distance > out || is_deep {
            samples.push(*sample);
        }
    }
    watch.count_fit(0, work);
    Ok(())
}
