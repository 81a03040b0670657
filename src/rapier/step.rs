//! One step, in order: the plan (`planning.rs`: who may meet whom, and the contacts that rapier will ask for), rapier's
//! own step, the impacts within it (`resolving.rs`), and the report.

use crate::math::Real;
use crate::parry::narrow_phase_plan::Tally;
use crate::rapier::contacts::candidates;
use crate::rapier::host::events_of_impacts::{DedupEventHandler, Scene};
use crate::rapier::host::recycling::lowered;
use crate::rapier::host::sleep_timers::moved_before;
use crate::rapier::impacts::toi_query::Work;
use crate::rapier::loans::Loans;
use crate::rapier::report::StepReport;
use crate::rapier::state::PipelineState;
use crate::rapier::step_args::StepArgs;
use crate::rapier::step_plan::StepPlan;
use crate::rapier::view::filter_answers::FilterAnswers;
use crate::rapier::view::medial_colliders;
use crate::rapier::world::World;
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::pipeline::{EventHandler, PhysicsHooks};
use std::sync::Arc;
use web_time::Instant;

impl PipelineState {
    /// Steps the world by `parameters.dt`, in as many parts as it stops. All parts together have one budget.
    pub fn step(
        &mut self,
        world: &mut World,
        parameters: &IntegrationParameters,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> StepReport {
        let before = self.batch.report().counts;
        let mut rest = *parameters;
        let mut report = StepReport::default();
        let mut work = Work::default();
        let exchange = Arc::clone(&self.exchange);
        let filters = FilterAnswers::new(hooks, &exchange);
        let can_stop = !world.has_links_or_particles();
        loop {
            let args = StepArgs {
                users_parameters: &rest,
                parameters: &rest,
                filters: &filters,
                events,
                may_stop: can_stop && report.stops < self.settings.tuning.max_stops,
            };
            let (done, stopped) = self.until_stop(world, args, &mut work);
            // No sum: how many there are in the end.
            report.medial_colliders = 0;
            report += done;
            let Some(time) = stopped else { break };
            report.stops += 1;
            rest.dt -= time;
        }
        // For the next step, since the poses are final.
        if self.batch.has_device() && self.kept.is_none() {
            let next = candidates::expect(world.sets(parameters, None), &self.recycled);
            self.batch.submit(&next);
        }
        report.add_searched(work);
        report.batch += self.batch.report().counts - before;
        report
    }

    /// A step, or what of it comes before the world stops; the second result is when, in seconds.
    fn until_stop(
        &mut self,
        world: &mut World,
        args: StepArgs,
        work: &mut Work,
    ) -> (StepReport, Option<Real>) {
        let unit = args.parameters.length_unit;
        if self.moved.is_none() {
            self.moved = Some(moved_before(world.bodies, world.colliders, unit));
        }
        let multibodies = &mut *world.multibody_joints;
        let parameters = args.parameters;
        self.links
            .place_new(world.bodies, multibodies, world.colliders, parameters);
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
        let kept = self.kept.take().filter(|kept| kept.holds_in(&census));
        let is_kept = kept.is_some();
        let mut plan = kept.unwrap_or_else(|| self.plan(world, args, census, (&mut report, work)));

        let events = DedupEventHandler::new(args.events, &mut self.reported);
        let tally = self.rapiers_step(world, args, (&mut plan, is_kept), &events, &mut report);

        let clock = Instant::now();
        let left_out = plan.participants.is_some();
        let outcome = self.impacts(world, args, (&mut plan, tally.depth), work);
        report.completed = usize::from(left_out && plan.participants.is_none());
        self.moved = Some(world.write_back(&plan.view, &outcome, args.parameters));
        if !is_kept || plan.view.followed {
            let participants = plan.participants.as_ref();
            self.initial_overlaps
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
            report.participants = plan.view.colliders.len();
        }
        report.add_impacts(&outcome);
        report.event_seconds = clock.elapsed().as_secs_f64();
        for ids in tally.missed {
            self.recycled.forget(ids);
        }
        report.add_answered(tally.counts);
        self.links
            .note(world.bodies, world.multibody_joints, world.colliders);
        self.kept = (!plan.view.followed).then_some(plan);
        (report, outcome.stopped)
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
        let asked = (&plan.view, &plan.fast_multibodies);
        let effects = (&self.settings.effects, moved);
        let loans = (!is_kept).then(|| Loans::give(asked, effects, parameters, world));
        report.speculative = loans.as_ref().map_or(0, Loans::speculative);
        plan.fast_multibodies.bring_to_rest(world.multibody_joints);
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
}
