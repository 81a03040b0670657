//! What the event loop did in a step.

use crate::math::Real;
use crate::rapier::impacts::reported_impulse::ReportedImpulse;
use rapier3d::geometry::ColliderHandle;

/// What two colliders gave each other in the impacts of a step.
#[derive(Clone, Debug)]
pub struct Impulse {
    /// Both colliders, in the narrow phase's order.
    pub colliders: [ColliderHandle; 2],
    /// Where and how much.
    pub blows: Vec<ReportedImpulse>,
}

/// What the event loop did.
#[derive(Default)]
pub struct Outcome {
    /// Pairs of medial meshes asked about at the start.
    pub jobs: usize,
    /// Impacts.
    pub events: usize,
    /// Bodies that stayed where they were before the step's end, after too many impacts, and because the budget was spent.
    pub frozen: usize,
    /// As above.
    pub waiting: usize,
    /// Pairs that exchanged an impulse.
    pub impulses: Vec<Impulse>,
    /// Bodies to be written back: index, and whether their velocity changed.
    pub changed: Vec<(usize, bool)>,
    /// Seconds into the step at which the world stopped, all bodies with it.
    pub stopped: Option<Real>,
}
