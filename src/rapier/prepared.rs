//! What a step is prepared with: who may meet whom, and the contacts that rapier will ask for. In a world in which
//! nothing moves it holds for the next step too.

use super::census::Census;
use super::effects::Wanted;
use super::first_contact::{Asker, Work};
use super::items::{self, Sets};
use super::pipeline::MedialPipeline;
use super::recycled::RECYCLE_DISTANCE;
use super::report::StepReport;
use super::snapshot::Snapshot;
use super::tuning::Tuning;
use super::verdicts::Verdicts;
use super::whirls::Whirls;
use super::world::World;
use super::{candidates, hanging, muting};
use crate::math::Real;
use rapier3d::dynamics::IntegrationParameters;
use web_time::Instant;

/// What is known before rapier's step.
pub struct Prepared {
    census: Census,
    /// Bodies and colliders.
    pub snapshot: Snapshot,
    /// How deep the deepest contact of all is, a length.
    pub depth: Real,
    /// Multibodies that whirl.
    pub whirls: Whirls,
}

impl MedialPipeline {
    /// Prepares a step, and hands the contacts to come to the narrow phase.
    pub(super) fn prepare_step(
        &mut self,
        world: &mut World,
        parameters: &IntegrationParameters,
        (census, may_stop): (Census, bool),
        verdicts: &Verdicts,
        (report, work): (&mut StepReport, &mut Work),
    ) -> Prepared {
        let clock = Instant::now();
        items::make_unique(world.bodies, world.colliders);
        self.effects.clean(world.colliders);
        let snapshot = if census.medial == 0 || self.effects.none() {
            Snapshot::default()
        } else {
            let (bodies, colliders) = (&*world.bodies, &*world.colliders);
            Snapshot::take(
                world.gravity,
                parameters.dt,
                bodies,
                colliders,
                world.joints(),
            )
        };
        self.placed.begin(&snapshot, world.narrow_phase);
        let rules = world.rules(verdicts);
        let asker = asker(
            &self.effects,
            (self.tuning, self.budget),
            parameters,
            may_stop,
        );
        let whirls = Whirls::find(&snapshot, &rules, world.narrow_phase, parameters.dt);
        let prediction = parameters.prediction_distance();
        let muted = muting::muted(&snapshot, &asker, &rules, prediction, work);
        report.muted = muted.len();
        report.mute_seconds = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let found = candidates::find(world.sets(parameters), &mut self.recycled, &muted);
        hanging::ask_anew(&found.fresh, world.colliders);
        let mut results = self.batch.run(&found.jobs);
        report.pairs = found.pairs;
        report.jobs = found.jobs.len();
        let jobs = found.jobs.iter().zip(&found.ahead);
        for ((job, ahead), result) in jobs.clone().zip(&mut results) {
            ahead.bring_back(result);
            self.recycled.set_touching(job, !result.contacts.is_empty());
            report.add_contacts(result);
        }
        let keys = jobs.map(|(job, ahead)| ahead.key(job));
        let answers = keys.zip(results);
        let starts = found.starts;
        let compute = Box::new(move |job| starts.contacts(job));
        self.answers.replace(answers, compute);
        self.answers.mute(muted);
        self.answers
            .give_one_point(self.effects.one_point(world.colliders));
        report.batch_seconds = clock.elapsed().as_secs_f64();
        Prepared {
            census,
            snapshot,
            depth: found.depth,
            whirls,
        }
    }

    /// The poses are final: a device has the time until the next step for its contacts.
    pub(super) fn send_early(&mut self, sets: Sets, report: &mut StepReport) {
        if !self.batch.has_device() || self.kept.is_some() {
            return;
        }
        let before = self.batch.report().clone();
        let parameters = lowered(sets.parameters);
        let sets = Sets {
            parameters: &parameters,
            ..sets
        };
        let next = candidates::expect(sets, &self.recycled);
        self.batch.submit(&next);
        report.add_sent(&before, self.batch.report());
    }
}

impl Prepared {
    /// Whether it holds in this world: nothing moved when it was prepared, and nothing has changed.
    pub fn holds_in(&self, census: &Census) -> bool {
        census.still.is_some() && self.census == *census
    }
}

/// Who asks for first contacts in a step of these parameters.
pub fn asker<'a>(
    effects: &'a Wanted,
    (tuning, budget): (Tuning, u64),
    parameters: &IntegrationParameters,
    may_stop: bool,
) -> Asker<'a> {
    Asker {
        effects,
        dt: parameters.dt,
        unit: parameters.length_unit,
        tuning,
        may_stop,
        budget,
    }
}

/// Parameters of a step with medial colliders: contacts are kept no longer than [`RECYCLE_DISTANCE`] says.
pub fn lowered(parameters: &IntegrationParameters) -> IntegrationParameters {
    let mut parameters = *parameters;
    let distance = &mut parameters.normalized_contact_recycle_distance;
    *distance = distance.min(RECYCLE_DISTANCE);
    parameters
}
