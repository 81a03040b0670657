//! Collision and contact-force events of impacts within a step: emitted once, and not a second time
//! when rapier finds the same contact in a later step.

use super::events::Impulse;
use crate::math::Real;
use rapier3d::dynamics::{RigidBodySet, SoftBodySet, SoftBodyTearEvent};
use rapier3d::geometry::{
    ColliderHandle, ColliderSet, CollisionEvent, CollisionEventFlags, ContactPair, NarrowPhase,
};
use rapier3d::pipeline::{ActiveEvents, EventHandler};
use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};

type Pair = [ColliderHandle; 2];

/// Pairs whose start was told here, and not yet by rapier.
#[derive(Default)]
pub struct Told {
    started: Vec<Pair>,
}

/// The user's handler, seen by rapier: starts already told are not told again.
pub struct Once<'a> {
    events: &'a dyn EventHandler,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    started: Vec<Pair>,
    forces: HashSet<Pair>,
}

fn sorted(a: ColliderHandle, b: ColliderHandle) -> Pair {
    if a.into_raw_parts() <= b.into_raw_parts() {
        [a, b]
    } else {
        [b, a]
    }
}

impl<'a> Once<'a> {
    /// A handler for one step of rapier.
    pub fn new(events: &'a dyn EventHandler, told: &mut Told) -> Self {
        let started = std::mem::take(&mut told.started);
        let state = State {
            started,
            forces: HashSet::new(),
        };
        Self {
            events,
            state: Mutex::new(state),
        }
    }

    fn change<T>(&self, with: impl FnOnce(&mut State) -> T) -> T {
        with(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Tells of the impacts after rapier's step, and of those that have ended.
    pub fn finish(
        self,
        told: &mut Told,
        impulses: &[Impulse],
        dt: Real,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        narrow_phase: &NarrowPhase,
    ) {
        let state = self
            .state
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        let hit: HashSet<Pair> = impulses
            .iter()
            .map(|i| sorted(i.colliders[0], i.colliders[1]))
            .collect();
        let tell = |event| {
            self.events
                .handle_collision_event(bodies, colliders, event, None)
        };
        let mut started = Vec::new();
        for pair in state.started {
            let [a, b] = pair;
            if hit.contains(&pair) {
                started.push(pair);
                continue;
            }
            let removed = !(colliders.contains(a) && colliders.contains(b));
            let flags = if removed {
                CollisionEventFlags::REMOVED
            } else {
                CollisionEventFlags::empty()
            };
            tell(CollisionEvent::Stopped(a, b, flags));
        }
        for Impulse {
            colliders: [a, b],
            impulse,
        } in impulses
        {
            let (Some(c1), Some(c2)) = (colliders.get(*a), colliders.get(*b)) else {
                continue;
            };
            let pair = sorted(*a, *b);
            let active = c1.active_events() | c2.active_events();
            let contact = narrow_phase.contact_pair(*a, *b);
            if active.contains(ActiveEvents::COLLISION_EVENTS)
                && !contact.is_some_and(ContactPair::has_any_active_contact)
                && !started.contains(&pair)
            {
                tell(CollisionEvent::Started(
                    *a,
                    *b,
                    CollisionEventFlags::empty(),
                ));
                started.push(pair);
            }
            let threshold = [c1, c2]
                .iter()
                .filter(|c| {
                    c.active_events()
                        .contains(ActiveEvents::CONTACT_FORCE_EVENTS)
                })
                .map(|c| c.contact_force_event_threshold())
                .fold(Real::INFINITY, Real::min);
            if let Some(contact) = contact
                && impulse / dt > threshold
                && !state.forces.contains(&pair)
            {
                let force = impulse / dt;
                self.events
                    .handle_contact_force_event(dt, bodies, colliders, contact, force);
            }
        }
        told.started = started;
    }
}

impl EventHandler for Once<'_> {
    fn handle_collision_event(
        &self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        event: CollisionEvent,
        contact_pair: Option<&ContactPair>,
    ) {
        let (CollisionEvent::Started(a, b, _) | CollisionEvent::Stopped(a, b, _)) = event;
        let pair = sorted(a, b);
        let known = self.change(|state| {
            let at = state.started.iter().position(|p| *p == pair);
            at.map(|i| state.started.remove(i)).is_some()
        });
        if !(known && event.started()) {
            self.events
                .handle_collision_event(bodies, colliders, event, contact_pair);
        }
    }

    fn handle_contact_force_event(
        &self,
        dt: Real,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        contact_pair: &ContactPair,
        total_force_magnitude: Real,
    ) {
        self.change(|state| {
            state
                .forces
                .insert(sorted(contact_pair.collider1, contact_pair.collider2));
        });
        self.events.handle_contact_force_event(
            dt,
            bodies,
            colliders,
            contact_pair,
            total_force_magnitude,
        );
    }

    fn handle_soft_body_tear_event(&self, soft_bodies: &SoftBodySet, event: &SoftBodyTearEvent) {
        self.events.handle_soft_body_tear_event(soft_bodies, event);
    }
}
