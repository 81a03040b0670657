//! [`Outcome`]: the result of the event loop in a step.

use crate::math::Real;
use crate::rapier::host::reported_impulse::Impulse;

/// Result of the event loop in a step.
#[derive(Default)]
pub struct Outcome {
    /// Pairs of medial meshes asked about at the start.
    pub jobs: usize,
    /// Impacts.
    pub events: usize,
    /// Bodies that stopped before the step's end after too many impacts.
    pub frozen: usize,
    /// Bodies that stopped before the step's end because the budget was spent.
    pub waiting: usize,
    /// Pairs that exchanged an impulse.
    pub impulses: Vec<Impulse>,
    /// Bodies to be written back: index, and whether their velocity changed.
    pub changed: Vec<(usize, bool)>,
    /// Seconds into the step at which the world stopped, all bodies with it.
    pub stopped: Option<Real>,
}
