//! Stable least-squares refit of centres and radii. Rows and their derivatives: `residuals.rs`; the
//! linear step: `least_squares.rs`.
//!
//! Minimised is `Σ w |d|³`: the third power leans towards the largest error, which is what counts,
//! and stays smooth; as reweighted squares its weights are `|d|`, with a floor.
//!
//! # What keeps it stable
//! Samples change their primitives from step to step, so the linear model is often wrong. Each ball
//! has a damping of its own, which falls while the energy `Σ α w |d|³` of its samples falls, and
//! rises when it grows; a ball whose energy grew by half is put back. A ball moves by no more than
//! its own samples ask for. The best draft by score is kept; after two failures the fit goes on
//! from it with ten times the damping, and ends after four.

use crate::error::BuildError;
use crate::meshing::certify::inside::Solid;
use crate::meshing::draft::Draft;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::{GUESS, TriangleTree};
use crate::meshing::refine::residuals::{
    EnvelopeSample, ResidualRow, Residuals, UNKNOWN, envelope_samples, residuals,
};
use crate::meshing::surface::samples::Sample;
use crate::meshing::watch::Watch;

/// Least weight of a row, in units of the largest weight. Without it, rows without error would not hold what is right
/// already.
const WEIGHT_FLOOR: f64 = 0.02;

/// Damping of each ball at the start of a fit (no unit; larger means smaller steps).
const DAMPING: f64 = 1e-2;

/// Least damping. A ball whose energy falls again and again would otherwise reach 0, and then move freely.
const LEAST_DAMPING: f64 = 1e-4;

/// Largest damping. A ball whose energy grew several times would otherwise hardly move again.
const MOST_DAMPING: f64 = 1e3;

/// Share of the linear step that is taken: assignments lag behind.
const STEP: f64 = 0.9;

/// Envelope samples move with their balls and are taken anew every so many iterations.
const REFRESH: usize = 3;

/// Short fits and insertion have envelope samples this much farther apart.
const COARSE_SPACING: f64 = 1.4;

/// Least radius of a ball (longest side 1).
const LEAST_RADIUS: f64 = 1e-4;

/// The samples that a draft is fitted to.
#[derive(Clone)]
pub struct FitTarget<'a> {
    /// The surface.
    pub tree: &'a TriangleTree,
    /// Points of it.
    pub samples: Vec<Sample>,
    /// Spacing of the envelope's samples (longest side 1).
    pub spacing: f64,
    /// Convex creases of it that are kept.
    pub creases: &'a [[Point; 2]],
    /// How far the solid may reach beyond the surface without being wrong (longest side 1): 0 but where it is to
    /// cover the surface.
    pub beyond: f64,
    /// Share of a build's budget of fits beyond which a fit to this ends.
    pub budget: f64,
}

impl FitTarget<'_> {
    /// Rows of a draft, with fresh envelope samples.
    pub fn residuals(&self, draft: &Draft, watch: &mut Watch) -> Result<Residuals, BuildError> {
        let mut envelope =
            envelope_samples(&Solid::new(draft), COARSE_SPACING * self.spacing, watch)?;
        let mut hints = vec![UNKNOWN; self.samples.len()];
        self.examine(draft, &mut hints, &mut envelope, watch)
    }

    /// The largest residual of a draft if it is below `limit`; the search ends at the first that is not,
    /// which for bad drafts is soon.
    pub fn largest_below(
        &self,
        draft: &Draft,
        limit: f64,
        watch: &mut Watch,
    ) -> Result<Option<f64>, BuildError> {
        let solid = Solid::new(draft);
        let (mut largest, mut hint) = (0.0f64, 0);
        for (i, sample) in self.samples.iter().enumerate() {
            if i % 512 == 0 {
                watch.again()?;
            }
            let near = solid.nearest(sample.point, hint);
            hint = near.primitive;
            largest = largest.max(near.signed.distance.abs());
            if largest >= limit {
                return Ok(None);
            }
        }
        let envelope = envelope_samples(&solid, COARSE_SPACING * self.spacing, watch)?;
        for (i, sample) in envelope.iter().enumerate() {
            if i % 512 == 0 {
                watch.again()?;
            }
            let (point, _) = sample.at(draft, &solid);
            let off = self.tree.closest(point, GUESS) - point;
            largest = largest.max(off.length());
            if largest >= limit {
                return Ok(None);
            }
        }
        Ok(Some(largest))
    }

    fn examine(
        &self,
        draft: &Draft,
        hints: &mut [u32],
        envelope: &mut [EnvelopeSample],
        watch: &mut Watch,
    ) -> Result<Residuals, BuildError> {
        residuals(
            draft,
            self.tree,
            &self.samples,
            hints,
            envelope,
            self.beyond,
            watch,
        )
    }
}

/// Moves balls so that the solid fits the surface better, in up to `iterations` steps; the draft is
/// never made worse by its score, which is returned. Ends early where the budget of fits is spent.
pub fn refit(
    draft: &mut Draft,
    target: &FitTarget,
    iterations: usize,
    watch: &mut Watch,
) -> Result<f64, BuildError> {
    let n = draft.balls.len();
    let mut damping = vec![DAMPING; n];
    let mut best: Option<(f64, Draft)> = None;
    let mut before: Option<(Draft, Vec<f64>)> = None;
    let mut hints = vec![UNKNOWN; target.samples.len()];
    let mut envelope = Vec::new();
    let mut failures = 0;
    let short = iterations <= 2;
    let spacing = target.spacing * if short { COARSE_SPACING } else { 1.0 };
    for iteration in 0..=iterations {
        // The last score of a long fit must not rest on samples that have moved far.
        let last = iteration == iterations && !short;
        if iteration % REFRESH == 0 || last {
            envelope = envelope_samples(&Solid::new(draft), spacing, watch)?;
        }
        let mut found = target.examine(draft, &mut hints, &mut envelope, watch)?;
        if best.as_ref().is_none_or(|b| found.score < b.0) {
            best = Some((found.score, draft.clone()));
            failures = 0;
        } else {
            failures += 1;
        }
        if iteration == iterations || failures >= 4 || watch.ends_fit(target.budget) {
            break;
        }
        let mut energy = energies(&found.rows, n);
        if failures >= 2 {
            if let Some((_, kept)) = &best {
                draft.clone_from(kept);
            }
            damping
                .iter_mut()
                .for_each(|d| *d = (*d * 10.0).min(MOST_DAMPING));
            found = target.examine(draft, &mut hints, &mut envelope, watch)?;
            energy = energies(&found.rows, n);
        } else if let Some((old, old_energy)) = &before
            && put_back(draft, old, &energy, old_energy, &mut damping)
        {
            found = target.examine(draft, &mut hints, &mut envelope, watch)?;
            energy = energies(&found.rows, n);
        }
        before = Some((draft.clone(), energy));
        step(draft, found, &damping);
    }
    let (score, kept) = best.unwrap_or((f64::INFINITY, draft.clone()));
    *draft = kept;
    Ok(score)
}

/// Energy of the samples that answer to each ball.
fn energies(rows: &[ResidualRow], balls: usize) -> Vec<f64> {
    let mut energies = vec![0.0; balls];
    for row in rows {
        let energy = row.weight * row.residual.abs().powi(3);
        for (&v, &w) in row.corners.iter().zip(&row.weights) {
            energies[v as usize] += w * energy;
        }
    }
    energies
}

/// Adapts each ball's damping; balls whose energy grew by half return to where they were. Whether
/// any did.
fn put_back(
    draft: &mut Draft,
    old: &Draft,
    energy: &[f64],
    old_energy: &[f64],
    damping: &mut [f64],
) -> bool {
    let mut any = false;
    for i in 0..damping.len() {
        // Energies below this are rounding.
        if energy[i] > 1.02 * old_energy[i] + 1e-14 {
            damping[i] = (damping[i] * 6.0).min(MOST_DAMPING);
            if energy[i] > 1.5 * old_energy[i] {
                draft.balls[i] = old.balls[i];
                any = true;
            }
        } else {
            damping[i] = (damping[i] * 0.4).max(LEAST_DAMPING);
        }
    }
    any
}

/// One damped step, limited ball by ball.
fn step(draft: &mut Draft, found: Residuals, damping: &[f64]) {
    let Residuals {
        mut rows, largest, ..
    } = found;
    let mut limit = vec![0.0f64; draft.balls.len()];
    for row in &mut rows {
        let size = row.residual.abs();
        row.weight *= (size / largest.max(1e-9)).max(WEIGHT_FLOOR);
        for (&v, &w) in row.corners.iter().zip(&row.weights) {
            let asked = &mut limit[v as usize];
            *asked = asked.max(2.0 * w.min(0.5) * size);
        }
    }
    let changes = crate::meshing::refine::least_squares::solve(&rows, damping);
    for ((ball, change), asked) in draft.balls.iter_mut().zip(changes).zip(limit) {
        let limit = (1.2 * asked + 1e-5).min(0.5 * ball.radius + 0.002);
        let moved = Point::new(change[0], change[1], change[2]);
        let length = moved.length();
        let shortened = if length > limit { limit / length } else { 1.0 };
        ball.center = ball.center + moved * (STEP * shortened);
        if ball.radius == 0.0 {
            // It is on a crease, and stays there.
            continue;
        }
        let grown = STEP * change[3].clamp(-limit, limit);
        ball.radius = (ball.radius + grown).max(LEAST_RADIUS);
    }
}
