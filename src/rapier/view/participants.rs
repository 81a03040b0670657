//! The colliders that may take part in a step, where a world has many that may not: all that moves, and of the still
//! ones (`still_colliders.rs`) those near it. The others are bystanders.

use crate::math::Real;
use crate::rapier::view::enabled::will_be_enabled;
use crate::rapier::view::still_colliders::StillColliders;
use parry3d::bounding_volume::Aabb;
use rapier3d::dynamics::RigidBodySet;
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, ContactPair, NarrowPhase};
use std::sync::Arc;

/// Who takes part.
pub struct Participants {
    /// All of them, in the order of the set of colliders.
    handles: Vec<ColliderHandle>,
    still: Arc<StillColliders>,
    /// Which of the still ones are near what moves.
    near: Vec<bool>,
}

impl Participants {
    /// Participants are the colliders that move, and so far no still ones.
    pub fn new(moving: Vec<ColliderHandle>, still: Arc<StillColliders>) -> Self {
        Self {
            handles: moving,
            near: vec![false; still.len()],
            still,
        }
    }

    /// The still colliders, near or not; the same from step to step while they stay as they are.
    pub fn still(&self) -> &Arc<StillColliders> {
        &self.still
    }

    /// Adds a collider, if it is a bystander.
    pub fn add(&mut self, collider: ColliderHandle) -> bool {
        let Some(place) = self.still.place(collider) else {
            return false;
        };
        let is_new = !std::mem::replace(&mut self.near[place as usize], true);
        if is_new {
            self.handles.push(collider);
        }
        is_new
    }

    /// Puts them in order again.
    pub fn sort(&mut self) {
        self.handles.sort_unstable_by_key(|h| h.into_raw_parts().0);
    }

    /// All of them, in the order of the set of colliders.
    pub fn handles(&self) -> &[ColliderHandle] {
        &self.handles
    }

    /// Whether a collider is a bystander.
    pub fn is_bystander(&self, collider: ColliderHandle) -> bool {
        let place = self.still.place(collider);
        place.is_some_and(|place| !self.near[place as usize])
    }

    /// Bystanders whose boxes meet this one.
    pub fn bystanders_in<'a>(&'a self, aabb: &Aabb) -> impl Iterator<Item = ColliderHandle> + 'a {
        let met = self.still.meeting(aabb).into_iter();
        let far = met.filter(|place| !self.near[*place as usize]);
        far.map(|place| self.still.handle(place))
    }
}

/// Contacts of rapier at the end of its step.
#[derive(Clone, Copy)]
pub struct Contacts<'a> {
    /// All of them.
    pub narrow_phase: &'a NarrowPhase,
    /// Colliders that take part, where not all do.
    pub participants: Option<&'a Participants>,
    /// Depth of the deepest of a medial collider that takes part, a length, or more.
    pub depth: Real,
}

impl<'a> Contacts<'a> {
    /// Where all colliders take part.
    pub fn of_all(narrow_phase: &'a NarrowPhase, depth: Real) -> Self {
        Self {
            narrow_phase,
            participants: None,
            depth,
        }
    }
}

/// Colliders that will be enabled in the next step: those that take part, where not all do.
pub fn enabled<'a>(
    bodies: &'a RigidBodySet,
    colliders: &'a ColliderSet,
    participants: Option<&'a Participants>,
) -> Box<dyn Iterator<Item = (ColliderHandle, &'a Collider)> + 'a> {
    let Some(participants) = participants else {
        return Box::new(colliders.iter().filter(|(_, c)| will_be_enabled(bodies, c)));
    };
    let handles = participants.handles().iter();
    Box::new(handles.filter_map(|h| Some((*h, colliders.get(*h)?))))
}

/// The contact pairs of those that take part; of all where all do.
pub fn contact_pairs<'a>(
    narrow_phase: &'a NarrowPhase,
    participants: Option<&'a Participants>,
) -> Box<dyn Iterator<Item = &'a ContactPair> + 'a> {
    let Some(participants) = participants else {
        return Box::new(narrow_phase.contact_pairs());
    };
    let handles = participants.handles().iter();
    Box::new(handles.flat_map(|handle| {
        let pairs = narrow_phase.contact_pairs_with(*handle);
        // A pair of two that take part is counted at its first.
        pairs.filter(|pair| pair.collider1 == *handle || participants.is_bystander(pair.collider1))
    }))
}
