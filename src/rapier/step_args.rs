//! Input of a step: the user's arguments, and the settings of the pipeline.

use crate::math::Vector;
use crate::rapier::effects::EffectSettings;
use crate::rapier::impacts::toi_query::CcdPolicy;
use crate::rapier::tuning::Tuning;
use crate::rapier::view::filter_answers::FilterAnswers;
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::pipeline::EventHandler;

/// Arguments of a step, or of the rest of one in which the world stopped.
#[derive(Clone, Copy)]
pub struct StepArgs<'a> {
    /// The user's parameters, with the time that is left of the step.
    pub users_parameters: &'a IntegrationParameters,
    /// The same, but that contacts are kept no longer than medial colliders can bear.
    pub parameters: &'a IntegrationParameters,
    /// The user's filters.
    pub filters: &'a FilterAnswers<'a>,
    /// The user's handler of events.
    pub events: &'a dyn EventHandler,
    /// Whether the world may stop within the step, and go on from there.
    pub may_stop: bool,
}

/// Settings of a pipeline.
pub struct Settings {
    /// Effects of the scene and of single colliders.
    pub effects: EffectSettings,
    /// Constants of the event loop.
    pub tuning: Tuning,
    /// [`MedialOptions::budget`](crate::MedialOptions::budget).
    pub budget: u64,
}

impl Settings {
    /// How first contacts are searched in a step. `bouncing` tells whether pairs may bounce in it.
    pub fn policy(&self, args: StepArgs, gravity: Vector, bouncing: bool) -> CcdPolicy<'_> {
        let parameters = args.parameters;
        let frequency = parameters.contact_softness.natural_frequency;
        let angular_frequency = std::f32::consts::TAU * frequency;
        CcdPolicy {
            effects: &self.effects,
            dt: parameters.dt,
            unit: parameters.length_unit,
            prediction: parameters.prediction_distance(),
            sag: gravity.length() / angular_frequency.powi(2),
            substeps: parameters.num_solver_iterations.max(1),
            tuning: self.tuning,
            may_stop: args.may_stop,
            budget: self.budget,
            bouncing,
        }
    }
}
