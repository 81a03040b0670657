//! Rapier's events as bevy_rapier's messages: which entities, not which colliders.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier;
use rapier::geometry::{ColliderHandle, ContactPair};
use rapier::prelude::{ColliderSet, EventHandler, RigidBodySet, SoftBodySet, SoftBodyTearEvent};
use std::collections::HashMap;
use std::sync::Mutex;

/// The messages of a frame's steps.
pub(crate) struct Messages<'a> {
    /// Entities of the colliders removed since the last step.
    pub removed: &'a HashMap<ColliderHandle, Entity>,
    /// The user's own handler.
    pub user: Option<&'a (dyn EventHandler + Send + Sync)>,
    pub collisions: Mutex<Vec<CollisionEvent>>,
    pub forces: Mutex<Vec<ContactForceEvent>>,
}

impl Messages<'_> {
    /// The entities of two colliders, none if rapier removed one by itself.
    fn entities(&self, colliders: &ColliderSet, pair: [ColliderHandle; 2]) -> Option<[Entity; 2]> {
        let entity = |handle: ColliderHandle| {
            let there = colliders.get(handle);
            there
                .and_then(|collider| Entity::try_from_bits(collider.user_data as u64))
                .or_else(|| self.removed.get(&handle).copied())
        };
        Some([entity(pair[0])?, entity(pair[1])?])
    }
}

/// Appends, unless a handler has panicked while it held the list.
fn push<T>(list: &Mutex<Vec<T>>, item: T) {
    if let Ok(mut list) = list.lock() {
        list.push(item);
    }
}

impl EventHandler for Messages<'_> {
    fn handle_collision_event(
        &self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        event: rapier::prelude::CollisionEvent,
        contact_pair: Option<&ContactPair>,
    ) {
        use rapier::prelude::CollisionEvent as Told;
        if let Some([a, b]) = self.entities(colliders, [event.collider1(), event.collider2()]) {
            let message = match event {
                Told::Started(_, _, flags) => CollisionEvent::Started(a, b, flags),
                Told::Stopped(_, _, flags) => CollisionEvent::Stopped(a, b, flags),
            };
            push(&self.collisions, message);
        }
        if let Some(user) = self.user {
            user.handle_collision_event(bodies, colliders, event, contact_pair);
        }
    }

    fn handle_contact_force_event(
        &self,
        dt: f32,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        contact_pair: &ContactPair,
        total_force_magnitude: f32,
    ) {
        let told = rapier::prelude::ContactForceEvent::from_contact_pair(
            dt,
            contact_pair,
            total_force_magnitude,
        );
        if let Some([collider1, collider2]) =
            self.entities(colliders, [told.collider1, told.collider2])
        {
            let message = ContactForceEvent {
                collider1,
                collider2,
                total_force: told.total_force,
                total_force_magnitude: told.total_force_magnitude,
                max_force_direction: told.max_force_direction,
                max_force_magnitude: told.max_force_magnitude,
                started: told.started,
            };
            push(&self.forces, message);
        }
        if let Some(user) = self.user {
            user.handle_contact_force_event(
                dt,
                bodies,
                colliders,
                contact_pair,
                total_force_magnitude,
            );
        }
    }

    fn handle_soft_body_tear_event(&self, soft_bodies: &SoftBodySet, event: &SoftBodyTearEvent) {
        if let Some(user) = self.user {
            user.handle_soft_body_tear_event(soft_bodies, event);
        }
    }
}
