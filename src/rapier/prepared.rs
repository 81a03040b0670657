//! What a step is prepared with: who may meet whom, and the contacts that rapier will ask for. In a world in which
//! nothing moves it holds for the next step too.

use super::census::Census;
use super::effects::Wanted;
use super::first_contact::{Asker, Work};
use super::items::{self, Sets};
use super::pairs::Rules;
use super::pipeline::MedialPipeline;
use super::recycled::RECYCLE_DISTANCE;
use super::report::StepReport;
use super::snapshot::Snapshot;
use super::tuning::Tuning;
use super::verdicts::Verdicts;
use super::whirls::Whirls;
use super::{candidates, hanging, muting};
use crate::math::{Real, Vector};
use rapier3d::dynamics::{ImpulseJointSet, IntegrationParameters, MultibodyJointSet, RigidBodySet};
use rapier3d::geometry::{ColliderSet, NarrowPhase};
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
        (gravity, parameters): (Vector, &IntegrationParameters),
        (bodies, colliders, narrow_phase): (&RigidBodySet, &mut ColliderSet, &NarrowPhase),
        joints: (&ImpulseJointSet, &MultibodyJointSet),
        (census, may_stop): (Census, bool),
        verdicts: &Verdicts,
        (report, work): (&mut StepReport, &mut Work),
    ) -> Prepared {
        let clock = Instant::now();
        items::make_unique(bodies, colliders);
        self.effects.clean(colliders);
        let snapshot = if census.medial == 0 || self.effects.none() {
            Snapshot::default()
        } else {
            Snapshot::take(gravity, parameters.dt, bodies, colliders, joints)
        };
        self.placed.begin(&snapshot, narrow_phase);
        let (impulse_joints, multibody_joints) = joints;
        let rules = Rules {
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            verdicts,
        };
        let asker = asker(
            &self.effects,
            (self.tuning, self.budget),
            parameters,
            may_stop,
        );
        let whirls = Whirls::find(&snapshot, &rules, narrow_phase, parameters.dt);
        let prediction = parameters.prediction_distance();
        let muted = muting::muted(&snapshot, &asker, &rules, prediction, work);
        report.muted = muted.len();
        report.mute_seconds = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let sets = Sets {
            gravity,
            parameters,
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            narrow_phase,
        };
        let found = candidates::find(sets, &mut self.recycled, &muted);
        hanging::ask_anew(&found.fresh, colliders);
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
            .give_one_point(self.effects.one_point(colliders));
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
