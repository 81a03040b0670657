//! The answers of the user's physics hooks, one per pair and step, so that all stages of a step go by the same answer.
//!
//! rapier asks `filter_contact_pair` in its narrow phase and again in its sweeps; this crate asks before both
//! (muting) and after them (the event loop), when bodies are elsewhere. A filter that goes by positions or
//! velocities, like a one-way platform, could then say yes to one stage and no to another, and nobody would resolve
//! the pair. So the first answer, given with the bodies as they are at the start of the step, holds for all stages.
//!
//! rapier's sweeps stop a body even at contacts that the user turned off for the solver, by an empty set of solver
//! flags or by clearing solver contacts in `modify_solver_contacts`. It stops convex shapes so once, since it drops
//! hits of shapes that overlap at the start; for medial meshes it would be told a deeper contact in every step. So
//! such pairs are noted here, and the dispatcher lets them pass.

use crate::math::fast_hash::{FastMap, FastSet};
use crate::parry::narrow_phase_plan::{PairKey, PlanExchange};
use crate::rapier::view::step_view::StepView;
use parry3d::shape::Shape;
use rapier3d::dynamics::RigidBodySet;
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, SolverFlags};
use rapier3d::pipeline::{ContactModificationContext, PairFilterContext, PhysicsHooks};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// The user's hooks in one step, seen by rapier and by the event loop.
pub struct FilterAnswers<'a> {
    hooks: &'a dyn PhysicsHooks,
    exchange: &'a PlanExchange,
    /// Verdict of the filter, by both colliders in the order of their handles.
    filtered: Mutex<FastMap<[ColliderHandle; 2], Option<SolverFlags>>>,
    /// The world at the start of the step, for pairs that nobody asked about then.
    start: OnceLock<Box<(RigidBodySet, ColliderSet)>>,
    /// Addresses of shapes that several colliders have.
    shared: OnceLock<FastSet<usize>>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Address of a shape: clones of a `SharedShape` have one.
fn place(shape: &dyn Shape) -> usize {
    std::ptr::from_ref(shape).addr()
}

impl<'a> FilterAnswers<'a> {
    /// No verdict is known yet; what may pass in rapier's sweeps is told to `exchange`.
    pub fn new(hooks: &'a dyn PhysicsHooks, exchange: &'a PlanExchange) -> Self {
        Self {
            hooks,
            exchange,
            filtered: Mutex::default(),
            start: OnceLock::new(),
            shared: OnceLock::new(),
        }
    }

    /// The verdict of the filter on two colliders, which is asked with the bodies at the start of the step:
    /// `bodies` and `colliders`, set back to where `view` had them if they moved since.
    pub fn of_pair(
        &self,
        view: &StepView,
        (bodies, colliders): (&RigidBodySet, &ColliderSet),
        [collider1, collider2]: [ColliderHandle; 2],
    ) -> Option<SolverFlags> {
        if let Some(known) = self.known([collider1, collider2]) {
            return known;
        }
        let (bodies, colliders) = if view.followed {
            let start = || Box::new(view.world_at_start(bodies, colliders));
            let start = self.start.get_or_init(start);
            (&start.0, &start.1)
        } else {
            (bodies, colliders)
        };
        let parent = |h| colliders.get(h).and_then(|c| c.parent());
        self.filter_contact_pair(&PairFilterContext {
            bodies,
            colliders,
            collider1,
            collider2,
            rigid_body1: parent(collider1),
            rigid_body2: parent(collider2),
        })
    }

    /// The keys under which a pair may be swept: either collider may be the fast one. What moves is met where the
    /// step takes it, so the pair goes by its shapes wherever they are, if no other collider has them, else by where
    /// they are at the start of the step, where all stay that do not move.
    fn keys(&self, colliders: &ColliderSet, pair: [ColliderHandle; 2]) -> Option<[PairKey; 2]> {
        let [a, b] = pair.map(|h| colliders.get(h));
        let (a, b) = (a?, b?);
        let shared = self.shared.get_or_init(|| {
            let mut seen = FastSet::default();
            let places = colliders.iter().map(|(_, c)| place(c.shape()));
            places.filter(|at| !seen.insert(*at)).collect()
        });
        let alone = [a, b].iter().all(|c| !shared.contains(&place(c.shape())));
        let key = |a: &Collider, b: &Collider| {
            if alone {
                PairKey::anywhere(a.shape(), b.shape())
            } else {
                PairKey::new(a.shape(), b.shape(), &a.position().inv_mul(b.position()))
            }
        };
        Some([key(a, b), key(b, a)])
    }

    fn known(&self, [a, b]: [ColliderHandle; 2]) -> Option<Option<SolverFlags>> {
        locked(&self.filtered).get(&sorted(a, b)).copied()
    }
}

/// The two in the order of their handles.
pub fn sorted(a: ColliderHandle, b: ColliderHandle) -> [ColliderHandle; 2] {
    if a.into_raw_parts() <= b.into_raw_parts() {
        [a, b]
    } else {
        [b, a]
    }
}

impl PhysicsHooks for FilterAnswers<'_> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let pair = [context.collider1, context.collider2];
        if let Some(known) = self.known(pair) {
            return known;
        }
        let flags = self.hooks.filter_contact_pair(context);
        let solved = |f: SolverFlags| f.contains(SolverFlags::COMPUTE_RIGID_IMPULSES);
        if flags.is_some_and(|f| !solved(f))
            && let Some(keys) = self.keys(context.colliders, pair)
        {
            self.exchange.note_contacts_off(&keys, true);
        }
        let [a, b] = pair;
        locked(&self.filtered).insert(sorted(a, b), flags);
        flags
    }

    fn filter_intersection_pair(&self, context: &PairFilterContext) -> bool {
        self.hooks.filter_intersection_pair(context)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let contacts = |c: &ContactModificationContext| {
            let rigid = c.rigid();
            rigid.map_or(0, |m| m.solver_contacts.len())
        };
        let before = contacts(context);
        self.hooks.modify_solver_contacts(context);
        if before > 0
            && let Some(keys) = self.keys(context.colliders, [context.collider1, context.collider2])
        {
            self.exchange
                .note_contacts_off(&keys, contacts(context) == 0);
        }
    }
}
