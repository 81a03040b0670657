//! One step, in order: the plan (who may meet whom, and the contacts that rapier will ask for), rapier's own step, the
//! impacts within it, and the report. The work itself is in the rooms of this folder.

use crate::math::{Real, Vector};
use crate::parry::narrow_phase_plan::{NarrowPhasePlan, Sweeps, Tally};
use crate::rapier::contacts::candidates;
use crate::rapier::contacts::muting::{self, Muted};
use crate::rapier::contacts::outnumbered::{are_outnumbered, keeps_nothing};
use crate::rapier::contacts::predicted_contacts::predicted;
use crate::rapier::effects::{Effect, EffectSettings, Effects};
use crate::rapier::host::events_of_impacts::{DedupEventHandler, Scene};
use crate::rapier::host::forced_updates::{self, Forced};
use crate::rapier::host::multibody_energy::WildMultibodies;
use crate::rapier::host::new_links::place_links;
use crate::rapier::host::sleep_timers::moved_before;
use crate::rapier::impacts::event_loop;
use crate::rapier::impacts::outcome::Outcome;
use crate::rapier::impacts::toi_query::{CcdPolicy, Work};
use crate::rapier::loans::Loans;
use crate::rapier::report::StepReport;
use crate::rapier::state::State;
use crate::rapier::step_plan::{StepPlan, lowered};
use crate::rapier::tuning::Tuning;
use crate::rapier::view::census::Census;
use crate::rapier::view::filter_answers::FilterAnswers;
use crate::rapier::view::medial_colliders::{self, Sets};
use crate::rapier::view::participants::Contacts;
use crate::rapier::view::step_view::StepView;
use crate::rapier::world::World;
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::pipeline::{EventHandler, PhysicsHooks};
use std::sync::Arc;
use web_time::Instant;

/// Arguments of a part of a step.
#[derive(Clone, Copy)]
struct StepArgs<'a> {
    /// The user's parameters, with the time that is left of the step.
    users_parameters: &'a IntegrationParameters,
    /// The same, but that contacts are kept no longer than medial colliders can bear.
    parameters: &'a IntegrationParameters,
    filters: &'a FilterAnswers<'a>,
    events: &'a dyn EventHandler,
    /// Whether the world may stop within the step, and go on from there.
    may_stop: bool,
}

impl StepArgs<'_> {
    /// How first contacts are searched.
    fn policy<'e>(
        &self,
        effects: &'e EffectSettings,
        (tuning, budget): (Tuning, u64),
        gravity: Vector,
        bouncing: bool,
    ) -> CcdPolicy<'e> {
        let frequency = self.parameters.contact_softness.natural_frequency;
        let angular_frequency = std::f32::consts::TAU * frequency;
        CcdPolicy {
            effects,
            dt: self.parameters.dt,
            unit: self.parameters.length_unit,
            prediction: self.parameters.prediction_distance(),
            sag: gravity.length() / angular_frequency.powi(2),
            substeps: self.parameters.num_solver_iterations.max(1),
            tuning,
            may_stop: self.may_stop,
            budget,
            bouncing,
        }
    }
}

impl State {
    /// Steps the world by `parameters.dt`, in as many parts as it stops.
    pub fn step(
        &mut self,
        world: &mut World,
        parameters: &IntegrationParameters,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> StepReport {
        let mut rest = *parameters;
        let mut report = StepReport::default();
        let exchange = Arc::clone(&self.exchange);
        let filters = FilterAnswers::new(hooks, &exchange);
        let can_stop = !world.has_links_or_particles();
        loop {
            let args = StepArgs {
                users_parameters: &rest,
                parameters: &rest,
                filters: &filters,
                events,
                may_stop: can_stop && report.stops < self.tuning.max_stops,
            };
            let (done, stopped) = self.part(world, args);
            // No sum: how many there are in the end.
            report.medial_colliders = 0;
            report += done;
            let Some(time) = stopped else {
                self.send_early(world.sets(parameters, None), &mut report);
                return report;
            };
            report.stops += 1;
            rest.dt -= time;
        }
    }

    /// A step, or what of it comes before the world stops; the second result is when, in seconds.
    fn part(&mut self, world: &mut World, args: StepArgs) -> (StepReport, Option<Real>) {
        let before = self.batch.report().counts;
        if self.moved.is_none() {
            let unit = args.parameters.length_unit;
            self.moved = Some(moved_before(world.bodies, world.colliders, unit));
        }
        place_links(
            world.bodies,
            world.multibody_joints,
            world.colliders,
            args.parameters.length_unit,
        );
        // Filters are asked before rapier has moved colliders to where the user put their bodies.
        world
            .bodies
            .propagate_modified_body_positions_to_colliders(world.colliders);
        let census = world.census();
        let lowered = lowered(args.parameters);
        let args = StepArgs {
            parameters: match census.medial {
                0 => args.parameters,
                _ => &lowered,
            },
            ..args
        };
        let mut report = StepReport::default();
        let mut work = Work::default();
        let kept = self.kept.take().filter(|kept| kept.holds_in(&census));
        let is_kept = kept.is_some();
        let mut plan =
            kept.unwrap_or_else(|| self.plan(world, args, census, (&mut report, &mut work)));

        let events = DedupEventHandler::new(args.events, &mut self.reported);
        let tally = self.rapiers_step(world, args, (&mut plan, is_kept), &events, &mut report);

        let clock = Instant::now();
        let left_out = plan.participants.is_some();
        let outcome = self.impacts(world, args, (&mut plan, tally.depth), &mut work);
        report.completed = usize::from(left_out && plan.participants.is_none());
        self.moved = Some(world.write_back(&plan.view, &outcome, args.parameters));
        if !is_kept || plan.view.followed {
            let participants = plan.participants.as_ref();
            self.placed
                .end(&plan.view, participants, &world.rules(args.filters));
        }
        let scene = Scene {
            dt: args.parameters.dt,
            bodies: world.bodies,
            colliders: world.colliders,
            narrow_phase: world.narrow_phase,
        };
        events.finish(&mut self.reported, &outcome.impulses, scene);
        if plan.census.all > 0 {
            report.medial_colliders = medial_colliders::count(world.colliders);
        }
        if plan.view.followed {
            report.participants = plan.view.parts.len();
        }
        report.add_impacts(&outcome);
        report.event_seconds = clock.elapsed().as_secs_f64();
        for ids in tally.missed {
            self.recycled.forget(ids);
        }
        report.add_answered(tally.counts);
        report.add_searched(work);
        report.batch += self.batch.report().counts - before;
        self.kept = (!plan.view.followed).then_some(plan);
        (report, outcome.stopped)
    }

    /// Plans a step, and hands the contacts to come to the narrow phase.
    fn plan(
        &mut self,
        world: &mut World,
        args: StepArgs,
        census: Census,
        (report, work): (&mut StepReport, &mut Work),
    ) -> StepPlan {
        let clock = Instant::now();
        let parameters = args.parameters;
        let participants = self.participants(world, parameters, &census);
        let taking_part = participants.as_ref();
        medial_colliders::make_unique(world.bodies, world.colliders);
        self.effects.clean(world.colliders);
        let view = if census.medial == 0 || self.effects.none() {
            StepView::default()
        } else {
            StepView::take(world.sets(parameters, taking_part))
        };
        let rules = world.rules(args.filters);
        self.placed.begin(&view, world.narrow_phase, &rules);
        let wild = WildMultibodies::find(&view, &rules, world.narrow_phase, parameters.dt);
        let prediction = parameters.prediction_distance();
        let policy = args.policy(
            &self.effects,
            (self.tuning, self.budget),
            world.gravity,
            false,
        );
        let Muted {
            keys: muted,
            bouncing,
            stale,
        } = muting::muted(
            &view,
            &policy,
            &rules,
            (world.narrow_phase, prediction),
            work,
        );
        report.muted = muted.len();
        report.mute_seconds = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let sets = world.sets(parameters, taking_part);
        let outnumbered = are_outnumbered(&sets, args.users_parameters);
        let found = candidates::find(sets, &mut self.recycled, &muted, outnumbered);
        let forced = Forced {
            once: found.forced.union(&stale).copied().collect(),
            all_medial: outnumbered,
            notes_nothing: keeps_nothing(parameters),
        };
        let contacts = (&*world.bodies, &*world.narrow_phase);
        forced_updates::force_updates(&forced, contacts, world.colliders);
        let mut results = self.batch.run(&found.jobs);
        report.pairs = found.pairs;
        report.jobs = found.jobs.len();
        let jobs = found.jobs.iter().zip(&found.ahead);
        for ((job, ahead), result) in jobs.clone().zip(&mut results) {
            ahead.rebase_to_step_start(result);
            self.recycled.set_touching(job, !result.contacts.is_empty());
            report.add_contacts(result);
        }
        let keys = jobs.map(|(job, ahead)| ahead.key(job));
        let known = keys.zip(results);
        let colliders = Arc::new(found.colliders);
        let (turning, dt) = (Arc::clone(&colliders), parameters.dt);
        let others = self.bystanders(world, parameters, participants.as_ref());
        let narrow_phase = Arc::new(NarrowPhasePlan {
            known: known.map(|((k, p), result)| (k, (p, result))).collect(),
            compute: Some(Box::new(move |job| {
                predicted(&colliders, others.as_deref(), job)
            })),
            turns: Some(Box::new(move |mesh| turning.of(mesh)?.turn(dt))),
            muted,
            single_point_pairs: self.effects.single_point_pairs(world.colliders),
            sweeps: self.sweeps(world, &census),
        });
        report.batch_seconds = clock.elapsed().as_secs_f64();
        StepPlan {
            census,
            view,
            participants,
            narrow_phase,
            depth: found.depth,
            outnumbered,
            wild,
            bouncing,
        }
    }

    /// What rapier's own sweeps find. Fixed partners are the event loop's as all others are, and rapier would stop bodies
    /// before.
    fn sweeps(&self, world: &World, census: &Census) -> Sweeps {
        let off = |e: &Effects| e.continuous == Effect::Off;
        let takes_all = !self.effects.any(off) && !census.any_modified;
        match takes_all && !world.has_links_or_particles() {
            true => Sweeps::FindNothing,
            false => Sweeps::PassOverlaps,
        }
    }

    /// Takes rapier's step, in which the narrow phase asks for what was planned.
    fn rapiers_step(
        &self,
        world: &mut World,
        args: StepArgs,
        (plan, is_kept): (&mut StepPlan, bool),
        events: &DedupEventHandler,
        report: &mut StepReport,
    ) -> Tally {
        let clock = Instant::now();
        let parameters = args.parameters;
        let moved = self.moved.as_deref().unwrap_or_default();
        let loans =
            (!is_kept).then(|| Loans::give(plan, (&self.effects, moved), parameters, world));
        report.speculative = loans.as_ref().map_or(0, Loans::speculative);
        plan.wild.bring_to_rest(world.multibody_joints);
        report.batch_seconds += clock.elapsed().as_secs_f64();

        self.exchange.begin_step(Arc::clone(&plan.narrow_phase));
        let clock = Instant::now();
        let rapiers = match plan.outnumbered {
            true => args.users_parameters,
            false => parameters,
        };
        world.step(rapiers, args.filters, events);
        report.step_seconds = clock.elapsed().as_secs_f64();
        let tally = self.exchange.end_step();
        if let Some(loans) = loans {
            loans.take_back(world.bodies);
        }
        tally
    }

    /// Finds and resolves the impacts within the step that rapier has just taken.
    fn impacts(
        &mut self,
        world: &World,
        args: StepArgs,
        (plan, depth): (&mut StepPlan, Real),
        work: &mut Work,
    ) -> Outcome {
        let moved = plan.census.medial > 0 && world.islands.num_active_bodies() > 0;
        if plan.census.still.is_some() && !moved {
            return Outcome::default();
        }
        let parameters = args.parameters;
        let view = &mut plan.view;
        let sets = (&*world.bodies, &*world.colliders);
        view.follow(parameters, sets, world.multibody_joints);
        let rules = world.rules(args.filters);
        let wild = std::mem::take(&mut plan.wild);
        wild.take_back(view, &rules, world.narrow_phase, parameters.dt);
        let depth = plan.depth.max(depth);
        let bouncing = plan.bouncing;
        let policy = args.policy(
            &self.effects,
            (self.tuning, self.budget),
            world.gravity,
            bouncing,
        );
        let narrow_phase = &*world.narrow_phase;
        let (placed, batch) = (&mut self.placed, &mut self.batch);
        let Some(participants) = plan.participants.take() else {
            let contacts = Contacts::of_all(narrow_phase, depth);
            let outcome = event_loop::resolve(view, policy, rules, contacts, placed, batch, work);
            return outcome.unwrap_or_default();
        };
        let still = participants.still();
        let mut active = world.islands.active_bodies();
        let wakes = active.any(|h| !view.index.contains_key(&h) && still.pose(h).is_some());
        if !wakes {
            let before = (view.clone(), *work, placed.left());
            let contacts = Contacts {
                participants: Some(&participants),
                ..Contacts::of_all(narrow_phase, depth)
            };
            let outcome = event_loop::resolve(view, policy, rules, contacts, placed, batch, work);
            if let Some(outcome) = outcome {
                plan.participants = Some(participants);
                return outcome;
            }
            let left;
            (*view, *work, left) = before;
            placed.leave_again(left);
        }
        let whole = StepView::take(world.sets(parameters, None));
        let sets = (&*world.bodies, &*world.colliders);
        view.complete(whole, still, parameters, sets, world.multibody_joints);
        // How deep the others are was not looked at.
        let contacts = Contacts::of_all(narrow_phase, Real::INFINITY);
        let outcome = event_loop::resolve(view, policy, rules, contacts, placed, batch, work);
        outcome.unwrap_or_default()
    }

    /// Sends the contacts of the next step to a device, since the poses are final.
    fn send_early(&mut self, sets: Sets, report: &mut StepReport) {
        if !self.batch.has_device() || self.kept.is_some() {
            return;
        }
        let before = self.batch.report().counts;
        let parameters = lowered(sets.parameters);
        let sets = Sets {
            parameters: &parameters,
            ..sets
        };
        let next = candidates::expect(sets, &self.recycled);
        self.batch.submit(&next);
        report.batch += self.batch.report().counts - before;
    }
}
