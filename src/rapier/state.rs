//! State that a pipeline keeps from step to step.

use crate::batch::Batch;
use crate::math::Vector;
use crate::parry::narrow_phase_plan::PlanExchange;
use crate::rapier::effects::{EffectSettings, MedialOptions};
use crate::rapier::host::events_of_impacts::ReportedStarts;
use crate::rapier::host::new_links::KnownLinks;
use crate::rapier::host::recycling::RecyclingRecord;
use crate::rapier::impacts::initial_overlaps::InitialOverlaps;
use crate::rapier::step_args::Settings;
use crate::rapier::step_plan::StepPlan;
use crate::rapier::tuning::Tuning;
use crate::rapier::view::census::Census;
use crate::rapier::view::medial_colliders::MedialColliders;
use crate::rapier::view::near_what_moves;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::still_colliders::{StillColliders, StillRecord};
use crate::rapier::world::World;
use rapier3d::dynamics::{IntegrationParameters, RigidBodyHandle};
use std::sync::Arc;

/// State that a [`MedialPipeline`](crate::MedialPipeline) keeps from step to step.
pub struct PipelineState {
    /// The backend that computes contacts and first contacts of many pairs at once.
    pub batch: Batch,
    /// Place where the dispatcher in rapier's narrow phase finds the plan of a step.
    pub exchange: Arc<PlanExchange>,
    /// Which contacts rapier keeps.
    pub recycled: RecyclingRecord,
    /// Settings of the pipeline.
    pub settings: Settings,
    /// Which starts of contacts were reported.
    pub reported: ReportedStarts,
    /// Bodies that were put into each other.
    pub initial_overlaps: InitialOverlaps,
    /// The colliders that stood still in the last step.
    pub still: StillRecord,
    /// All medial colliders of the world, with what they were made for: the still colliders and gravity.
    pub still_medial: Option<(Arc<StillColliders>, Vector, Arc<MedialColliders>)>,
    /// Joints of multibodies in the last step.
    pub links: KnownLinks,
    /// The bodies that impacts moved in the last step; `None` before the first.
    pub moved: Option<Vec<RigidBodyHandle>>,
    /// The plan of the last step, if nothing moved in it.
    pub kept: Option<StepPlan>,
}

impl PipelineState {
    /// The state before the first step.
    pub fn new(options: MedialOptions, batch: Batch) -> Self {
        let mut effects = EffectSettings::default();
        effects.scene = options.effects;
        Self {
            batch,
            exchange: Arc::default(),
            recycled: RecyclingRecord::default(),
            settings: Settings {
                effects,
                tuning: Tuning::default(),
                budget: options.budget,
            },
            reported: ReportedStarts::default(),
            initial_overlaps: InitialOverlaps::default(),
            still: StillRecord::default(),
            still_medial: None,
            links: KnownLinks::default(),
            moved: None,
            kept: None,
        }
    }

    /// Who takes part in a step; `None` where all do.
    pub fn participants(
        &mut self,
        world: &World,
        parameters: &IntegrationParameters,
        census: &Census,
    ) -> Option<Participants> {
        if census.medial == 0 || census.still.is_some() || !world.soft_bodies.is_empty() {
            return None;
        }
        let sets = world.sets(parameters, None);
        let least = self.settings.tuning.least_still;
        near_what_moves::find(&mut self.still, sets, world.islands, least)
    }

    /// The medial colliders of the whole world, of which those that do not take part are where they were; `None` where
    /// all take part. rapier asks for contacts of some that touch although none of them moves.
    pub fn bystanders(
        &mut self,
        world: &World,
        parameters: &IntegrationParameters,
        participants: Option<&Participants>,
    ) -> Option<Arc<MedialColliders>> {
        let still = participants?.still();
        let holds = |known: &(Arc<StillColliders>, Vector, _)| {
            Arc::ptr_eq(&known.0, still) && known.1 == world.gravity
        };
        if !self.still_medial.as_ref().is_some_and(holds) {
            let all = MedialColliders::new(&world.sets(parameters, None));
            self.still_medial = Some((Arc::clone(still), world.gravity, Arc::new(all)));
        }
        self.still_medial.as_ref().map(|known| Arc::clone(&known.2))
    }
}
