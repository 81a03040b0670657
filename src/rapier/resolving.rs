//! Resolves the impacts within the step that rapier has just taken: among the colliders that take part, or among all
//! where something may get to another ([decision 23](../../docs/decisions/0023-bystanders.md)).

use crate::math::Real;
use crate::rapier::impacts::event_loop;
use crate::rapier::impacts::outcome::Outcome;
use crate::rapier::impacts::toi_query::Work;
use crate::rapier::state::PipelineState;
use crate::rapier::step_args::StepArgs;
use crate::rapier::step_plan::StepPlan;
use crate::rapier::view::participants::{Contacts, Participants};
use crate::rapier::view::step_view::StepView;
use crate::rapier::world::World;

impl PipelineState {
    /// Finds and resolves the impacts within the step that rapier has just taken. `depth` is that of the deepest
    /// contact that rapier was given, a length. Where all colliders had to be looked at, the plan has no participants
    /// afterwards.
    pub fn impacts(
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
        let sets = (&*world.bodies, &*world.colliders);
        plan.view.follow(parameters, sets, world.multibody_joints);
        let rules = world.rules(args.filters);
        let fast_multibodies = std::mem::take(&mut plan.fast_multibodies);
        fast_multibodies.take_back(&mut plan.view, &rules, world.narrow_phase, parameters.dt);
        let depth = plan.depth.max(depth);
        let Some(participants) = plan.participants.take() else {
            return self.among_all(world, args, (plan, depth), work);
        };
        let among = self.among_participants(world, args, (plan, &participants, depth), work);
        let still = participants.still();
        if let Some(outcome) = among {
            plan.participants = Some(participants);
            return outcome;
        }
        let whole = StepView::take(world.sets(parameters, None));
        let view = &mut plan.view;
        view.complete(whole, still, parameters, sets, world.multibody_joints);
        // How deep the others are was not looked at.
        self.among_all(world, args, (plan, Real::INFINITY), work)
    }

    /// The impacts among all colliders of the plan's view.
    fn among_all(
        &mut self,
        world: &World,
        args: StepArgs,
        (plan, depth): (&mut StepPlan, Real),
        work: &mut Work,
    ) -> Outcome {
        let contacts = Contacts::of_all(world.narrow_phase, depth);
        let resolved = self.resolve(world, args, (plan, contacts), work);
        // Only participants can leave some out.
        resolved.unwrap_or_default()
    }

    /// The impacts among those that take part; `None` if something may get to a collider that does not. View and work
    /// are then as they were.
    fn among_participants(
        &mut self,
        world: &World,
        args: StepArgs,
        (plan, participants, depth): (&mut StepPlan, &Participants, Real),
        work: &mut Work,
    ) -> Option<Outcome> {
        let still = participants.still();
        let mut active = world.islands.active_bodies();
        if active.any(|h| !plan.view.index.contains_key(&h) && still.pose(h).is_some()) {
            return None;
        }
        let before = (
            plan.view.clone(),
            *work,
            self.initial_overlaps.left_to_solver(),
        );
        let contacts = Contacts {
            participants: Some(participants),
            ..Contacts::of_all(world.narrow_phase, depth)
        };
        let resolved = self.resolve(world, args, (plan, contacts), work);
        if resolved.is_none() {
            let left;
            (plan.view, *work, left) = before;
            self.initial_overlaps.leave_again(left);
        }
        resolved
    }

    fn resolve(
        &mut self,
        world: &World,
        args: StepArgs,
        (plan, contacts): (&mut StepPlan, Contacts),
        work: &mut Work,
    ) -> Option<Outcome> {
        let policy = self.settings.policy(args, world.gravity, plan.bouncing);
        let rules = world.rules(args.filters);
        let (initial_overlaps, batch) = (&mut self.initial_overlaps, &mut self.batch);
        event_loop::resolve(
            &mut plan.view,
            policy,
            rules,
            contacts,
            initial_overlaps,
            batch,
            work,
        )
    }
}
