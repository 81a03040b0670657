//! First time of contact of two moving primitives, bracketed with proof.
//!
//! A sphere that moves straight from `c` to `c'` stays inside the hull of both ends. So the
//! distance over a whole interval of time is at least the distance of the corners at both of its
//! ends taken together (18 instead of 9), each grown by the sagitta of its path. Where that exceeds
//! the threshold, the interval is free of contact; where not, it is cut shorter. No dip can hide:
//! nothing is sampled. This is the Lipschitz argument with the sharpest constant there is, as the
//! common speed of all corners along the separating direction is seen with its sign.
//!
//! Guesses for the next time to look at come from the nearest spheres and their velocities. They
//! are only guesses: every claim rests on a bound of [`super::distance`], and a wrong guess costs
//! time.

use super::distance::{Distance, Goal, distance};
use super::motion::Paths;

/// Width at which a bracket counts as closed, as a fraction of the step.
pub const RESOLUTION: f64 = 1.0e-11;

/// Part of the way to a guessed contact that is left for the next round.
const SHORT_OF_CONTACT: f64 = 1.0e-3;

/// Distance from the threshold below which rounding is taken to hide the side, in units of the
/// rounding: nearer, a hull would have to be shorter than it is worth.
const CLOSE: f64 = 8.0;

/// Rounds after which a search gives up. Grazing rotations need some hundred.
const MAX_ROUNDS: usize = 10_000;

/// What is known of the first time at which the distance is at most a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstContact {
    /// Before this time the distance exceeds the threshold. 1 when it always does.
    pub free_until: f64,
    /// At this time it does not. `None` with `free_until = 1`: never; `None` otherwise: it comes
    /// as close as rounding can tell, and no closer.
    pub contact_at: Option<f64>,
}

/// Brackets the first time in the step at which the signed distance is at most `threshold`.
pub fn first_contact(paths: &Paths, threshold: f64) -> FirstContact {
    let rounding = paths.rounding();
    Search {
        paths,
        threshold,
        rounding,
    }
    .run()
}

/// Bounds of the signed distance at `time`, rounding included.
pub fn distance_at(paths: &Paths, time: f64) -> (f64, f64) {
    let found = distance(&paths.at(time), Goal::Value);
    let rounding = paths.rounding();
    (found.lower - rounding, found.upper + rounding)
}

struct Search<'a> {
    paths: &'a Paths,
    threshold: f64,
    rounding: f64,
}

/// Where a search stands after a stretch in which rounding hides on which side the distance is.
enum Left {
    /// In contact at this time.
    Contact(f64),
    /// Clear of the threshold again at this time.
    Free(f64),
    /// The step ended first.
    Never,
}

impl Search<'_> {
    fn run(&self) -> FirstContact {
        let mut time = 0.0;
        let mut doubt: Option<f64> = None;
        let mut contact: Option<f64> = None;
        let mut stride: f64 = 1.0;
        for _ in 0..MAX_ROUNDS {
            let here = distance(&self.paths.at(time), Goal::Value);
            if self.touches(here.upper) {
                contact = Some(time);
                break;
            }
            let guess = self.guess(time, &here);
            let confirmed = guess.and_then(|at| self.confirm(at, &here));
            contact = confirmed.into_iter().chain(contact).reduce(f64::min);
            if contact.is_some_and(|at| at - time <= RESOLUTION) {
                break;
            }
            let end = contact.unwrap_or(1.0);
            let short = guess.map(|at| time + (at - time) * (1.0 - SHORT_OF_CONTACT));
            let aim = short.unwrap_or(end).min(end).min(time + 4.0 * stride);
            let clear = self.is_clear(here.lower);
            if let Some(free) = clear.then(|| self.free_to(time, aim)).flatten() {
                stride = free - time;
                time = free;
            } else {
                doubt = doubt.or(Some(time));
                match self.leave(time, end) {
                    Left::Contact(at) => {
                        contact = Some(at);
                        break;
                    }
                    Left::Free(at) => time = at,
                    Left::Never => break,
                }
            }
            if time >= 1.0 {
                break;
            }
        }
        FirstContact {
            free_until: doubt.unwrap_or(time),
            contact_at: contact,
        }
    }

    fn touches(&self, upper: f64) -> bool {
        upper <= self.threshold - self.rounding
    }

    fn is_free(&self, lower: f64) -> bool {
        lower > self.threshold + self.rounding
    }

    fn is_clear(&self, lower: f64) -> bool {
        lower > self.threshold + CLOSE * self.rounding
    }

    /// When the two spheres nearest at `time` would touch if they kept their velocities: the
    /// smaller root of `|y + τ ẏ| = R + threshold`, with `|y| − R` the distance now.
    fn guess(&self, time: f64, here: &Distance) -> Option<f64> {
        let (y, radius) = self.paths.at(time).blend(&here.weights);
        let rate = self.paths.velocity(time, &here.weights);
        let reach = radius + self.threshold;
        let (a, b) = (rate.norm_squared(), y.dot(&rate));
        let c = y.norm_squared() - reach * reach;
        let root = (b * b - a * c).sqrt();
        // NaN where there is no root.
        let at = time + c / (root - b);
        (b < 0.0 && reach >= 0.0 && at > time && at < 1.0).then_some(at)
    }

    /// A time just after a guessed contact at which the guessed spheres prove contact.
    fn confirm(&self, guess: f64, here: &Distance) -> Option<f64> {
        let at = (guess + 0.25 * RESOLUTION).min(1.0);
        let (y, radius) = self.paths.at(at).blend(&here.weights);
        self.touches(y.norm() - radius).then_some(at)
    }

    /// The furthest time up to `end` that is reached free of contact, by halving.
    fn free_to(&self, time: f64, end: f64) -> Option<f64> {
        let mut end = end;
        while end - time >= 0.25 * RESOLUTION {
            let hull = self.paths.over(time, end);
            let side = Goal::Side(self.threshold + self.rounding);
            if self.is_free(distance(&hull, side).lower) {
                return Some(end);
            }
            end = time + 0.5 * (end - time);
        }
        None
    }

    /// Looks ahead in doubling steps until rounding no longer hides the side.
    fn leave(&self, time: f64, end: f64) -> Left {
        let mut step = RESOLUTION;
        loop {
            let at = (time + step).min(end);
            let found = distance(&self.paths.at(at), Goal::Value);
            if self.touches(found.upper) {
                return Left::Contact(at);
            }
            if self.is_clear(found.lower) {
                return Left::Free(at);
            }
            if at >= end {
                return Left::Never;
            }
            step *= 2.0;
        }
    }
}
