//! Plans a step before rapier takes it: the view of the world, the pairs that are muted, and the contacts that rapier
//! will ask for.

use crate::parry::narrow_phase_plan::{NarrowPhasePlan, Sweeps};
use crate::rapier::contacts::candidates::{self, Candidates};
use crate::rapier::contacts::locked_bodies;
use crate::rapier::contacts::muting::{self, Muted};
use crate::rapier::contacts::outnumbered::{are_outnumbered, keeps_nothing};
use crate::rapier::contacts::predicted_contacts::predicted;
use crate::rapier::effects::{Effect, Effects};
use crate::rapier::host::forced_updates::{self, Forced};
use crate::rapier::host::multibody_energy::FastMultibodies;
use crate::rapier::impacts::toi_query::Work;
use crate::rapier::report::StepReport;
use crate::rapier::state::PipelineState;
use crate::rapier::step_args::StepArgs;
use crate::rapier::step_plan::StepPlan;
use crate::rapier::view::census::Census;
use crate::rapier::view::medial_colliders;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::step_view::StepView;
use crate::rapier::world::World;
use std::sync::Arc;
use web_time::Instant;

impl PipelineState {
    /// Plans a step. Contacts of medial pairs are computed here, in one batch.
    pub fn plan(
        &mut self,
        world: &mut World,
        args: StepArgs,
        census: Census,
        (report, work): (&mut StepReport, &mut Work),
    ) -> StepPlan {
        let clock = Instant::now();
        let parameters = args.parameters;
        let participants = self.participants(world, parameters, &census);
        medial_colliders::make_unique(world.bodies, world.colliders);
        self.settings.effects.clean(world.colliders);
        let view = if census.medial == 0 || self.settings.effects.none() {
            StepView::default()
        } else {
            StepView::take(world.sets(parameters, participants.as_ref()))
        };
        let rules = world.rules(args.filters);
        self.initial_overlaps
            .begin(&view, world.narrow_phase, &rules);
        let fast_multibodies =
            FastMultibodies::find(&view, &rules, world.narrow_phase, parameters.dt);
        let policy = self.settings.policy(args, world.gravity, false);
        let contacts = (&*world.narrow_phase, parameters.prediction_distance());
        let Muted {
            keys: muted,
            bouncing,
            stale,
        } = muting::muted(&view, &policy, &rules, contacts, work);
        report.muted = muted.len();
        report.mute_seconds = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let sets = world.sets(parameters, participants.as_ref());
        let outnumbered = are_outnumbered(&sets, args.users_parameters);
        let found = candidates::find(sets, &mut self.recycled, &muted, outnumbered);
        let forced = Forced {
            once: found.forced.union(&stale).copied().collect(),
            all_medial: outnumbered,
            notes_nothing: keeps_nothing(parameters),
        };
        let contacts = (&*world.bodies, &*world.narrow_phase);
        forced_updates::force_updates(&forced, contacts, world.colliders);
        let depth = found.depth;
        let narrow_phase = NarrowPhasePlan {
            muted,
            sweeps: self.sweeps(world, &census),
            ..self.known_contacts(world, args, found, (participants.as_ref(), report))
        };
        report.batch_seconds = clock.elapsed().as_secs_f64();
        StepPlan {
            census,
            view,
            participants,
            narrow_phase: Arc::new(narrow_phase),
            depth,
            outnumbered,
            fast_multibodies,
            bouncing,
        }
    }

    /// Computes the contacts of the pairs that were found; a plan that has these, and can compute others.
    fn known_contacts(
        &mut self,
        world: &World,
        args: StepArgs,
        found: Candidates,
        (participants, report): (Option<&Participants>, &mut StepReport),
    ) -> NarrowPhasePlan {
        let mut results = self.batch.run(&found.jobs);
        report.pairs = found.pairs;
        report.jobs = found.jobs.len();
        let jobs = found.jobs.iter().zip(&found.predicted_motions);
        for ((job, ahead), result) in jobs.clone().zip(&mut results) {
            ahead.rebase_to_step_start(result);
            self.recycled.set_touching(job, !result.contacts.is_empty());
            report.add_contacts(result);
        }
        let keys = jobs.map(|(job, ahead)| ahead.key(job));
        let known = keys.zip(results);
        let known = known.map(|((key, prediction), result)| (key, (prediction, result)));
        let known = known.collect();
        let sets = world.sets(args.parameters, participants);
        let locked_bodies = locked_bodies::find(&sets, &found.colliders);
        let colliders = Arc::new(found.colliders);
        let (turning, dt) = (Arc::clone(&colliders), args.parameters.dt);
        let others = self.bystanders(world, args.parameters, participants);
        NarrowPhasePlan {
            known,
            compute: Some(Box::new(move |job| {
                predicted(&colliders, others.as_deref(), job)
            })),
            turns: Some(Box::new(move |mesh| turning.of(mesh)?.turn(dt))),
            locked_bodies,
            single_point_pairs: self.settings.effects.single_point_pairs(world.colliders),
            ..NarrowPhasePlan::default()
        }
    }

    /// Which bodies rapier's own sweeps may stop. Fixed partners are the event loop's as all others are, and rapier
    /// would stop bodies before.
    fn sweeps(&self, world: &World, census: &Census) -> Sweeps {
        let off = |e: &Effects| e.continuous == Effect::Off;
        let takes_all = !self.settings.effects.any(off) && !census.any_modified;
        match takes_all && !world.has_links_or_particles() {
            true => Sweeps::FindNothing,
            false => Sweeps::PassOverlaps,
        }
    }
}
