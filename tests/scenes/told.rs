//! An event handler that writes down what it is told.

use rapier3d::prelude::*;
use std::sync::Mutex;

/// A start or a stop of a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    pub started: bool,
    /// Whether its contact pair came with it, with points.
    pub has_points: bool,
}

/// What was told, in its order.
#[derive(Debug, Default)]
pub struct Told {
    pub events: Vec<Event>,
    /// Of the contact-force events, N s.
    pub impulse: Real,
    /// The same as vectors, each with the pair's first collider, which it pushes back.
    pub impulses: Vec<(ColliderHandle, Vector)>,
}

impl Told {
    /// Of each collision event whether it is a start.
    pub fn starts(&self) -> Vec<bool> {
        self.events.iter().map(|event| event.started).collect()
    }
}

#[derive(Default)]
pub struct Record(Mutex<Told>);

impl Record {
    /// What was told since it was asked last.
    pub fn take(&self) -> Told {
        std::mem::take(&mut self.0.lock().expect("not poisoned"))
    }
}

impl EventHandler for Record {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        event: CollisionEvent,
        pair: Option<&ContactPair>,
    ) {
        let has_points = pair.is_some_and(|p| p.manifolds().iter().any(|m| !m.points.is_empty()));
        let started = event.started();
        let mut told = self.0.lock().expect("not poisoned");
        told.events.push(Event {
            started,
            has_points,
        });
    }

    fn handle_contact_force_event(
        &self,
        dt: Real,
        _: &RigidBodySet,
        _: &ColliderSet,
        pair: &ContactPair,
        force: Real,
    ) {
        let event = ContactForceEvent::from_contact_pair(dt, pair, force);
        let sum = event.total_force.length();
        let mut normals = pair.manifolds().iter().map(|m| m.data.normal);
        let first = normals.next().unwrap_or_default();
        // Forces of one direction add up to their sum, others to less.
        let is_equal = (sum - force).abs() < 1.0e-3 * force;
        let is_less = sum < force && normals.any(|normal| normal.dot(first) < 0.999);
        assert!(is_equal || is_less, "{sum} N of {force}");
        let mut told = self.0.lock().expect("not poisoned");
        told.impulse += force * dt;
        told.impulses.push((pair.collider1, event.total_force * dt));
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}
