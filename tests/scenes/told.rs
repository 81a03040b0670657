//! An event handler that writes down what it is told.

use rapier3d::prelude::*;
use std::sync::Mutex;

/// Collision starts and stops, in their order.
#[derive(Default)]
pub struct Record(pub Mutex<Vec<bool>>);

impl EventHandler for Record {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        event: CollisionEvent,
        _: Option<&ContactPair>,
    ) {
        self.0.lock().expect("not poisoned").push(event.started());
    }
    fn handle_contact_force_event(
        &self,
        _: Real,
        _: &RigidBodySet,
        _: &ColliderSet,
        _: &ContactPair,
        _: Real,
    ) {
    }
    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}
