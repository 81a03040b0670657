//! State that a pipeline keeps from step to step.

use crate::batch::Batch;
use crate::parry::narrow_phase_plan::PlanExchange;
use crate::rapier::effects::EffectSettings;
use crate::rapier::host::events_of_impacts::ReportedStarts;
use crate::rapier::host::recycling::RecyclingRecord;
use crate::rapier::impacts::initial_overlaps::InitialOverlaps;
use crate::rapier::step_plan::StepPlan;
use crate::rapier::tuning::Tuning;
use crate::rapier::view::still_colliders::StillRecord;
use rapier3d::dynamics::RigidBodyHandle;
use std::sync::Arc;

/// State that a [`MedialPipeline`](crate::MedialPipeline) keeps from step to step.
pub struct State {
    /// The backend that computes contacts and first contacts of many pairs at once.
    pub batch: Batch,
    /// Place where the dispatcher in rapier's narrow phase finds the plan of a step.
    pub exchange: Arc<PlanExchange>,
    /// Which contacts rapier keeps.
    pub recycled: RecyclingRecord,
    pub effects: EffectSettings,
    pub tuning: Tuning,
    /// [`MedialOptions::budget`](crate::MedialOptions::budget).
    pub budget: u64,
    pub reported: ReportedStarts,
    pub placed: InitialOverlaps,
    /// The colliders that stood still in the last step.
    pub still: StillRecord,
    /// The bodies that impacts moved in the last step; `None` before the first.
    pub moved: Option<Vec<RigidBodyHandle>>,
    /// The plan of the last step, if nothing moved in it.
    pub kept: Option<StepPlan>,
}
