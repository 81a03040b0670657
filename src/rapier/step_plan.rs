//! Plan of a step, made before rapier's: what the world was, who may meet whom, which multibodies gain energy. In a
//! world in which nothing moves a plan holds for the next step too.

use crate::math::Real;
use crate::parry::narrow_phase_plan::NarrowPhasePlan;
use crate::rapier::host::multibody_energy::FastMultibodies;
use crate::rapier::view::census::Census;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::step_view::StepView;
use std::sync::Arc;

/// Plan of a step, made before rapier's.
pub struct StepPlan {
    /// Census of the world when the plan was made.
    pub census: Census,
    /// Bodies and colliders.
    pub view: StepView,
    /// Colliders that take part, where not all do.
    pub participants: Option<Participants>,
    /// Plan that the dispatcher goes by while rapier steps.
    pub narrow_phase: Arc<NarrowPhasePlan>,
    /// How deep the deepest contact of a medial collider that takes part is, a length.
    pub depth: Real,
    /// Whether few of the pairs that move have a medial collider, so that rapier goes by the user's recycle distance.
    pub outnumbered: bool,
    /// Multibodies that gain energy in rapier's step.
    pub fast_multibodies: FastMultibodies,
    /// Whether pairs may bounce ([`Effects::restitution`](crate::Effects::restitution)).
    pub bouncing: bool,
}

impl StepPlan {
    /// Whether it holds in this world: nothing moved when it was made, and nothing has changed.
    pub fn holds_in(&self, census: &Census) -> bool {
        census.still.is_some() && self.census == *census
    }
}
