//! Lets bodies that impacts move fall asleep. rapier takes a body whose pose was set between two steps for one that the
//! user moved, and in its next step restarts the time for which this body, and those in contact with it, have been
//! slow: what is struck in each step, because it is pressed, would never sleep. For the length of rapier's step these
//! bodies need to be slow only for the time that is left of theirs; after it they get back what they had.
//!
//! rapier judges how slow a body is by how far it has moved since the step before. What an impact holds where it is may
//! have a speed all the same, with which it goes on in the next step: it has to have none.

use crate::math::Real;
use crate::rapier::host::change_marks::{SlightChange, slight_change};
use rapier3d::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::{Collider, ColliderSet, NarrowPhase};

/// Bodies whose time rapier restarts in this step, although no user moved them.
pub struct SleepTimers(Vec<Timer>);

/// The time of one body, in seconds.
struct Timer {
    body: RigidBodyHandle,
    /// For how long it has been slow.
    slow: Real,
    /// For how long a body must have been slow to fall asleep.
    needed: Real,
}

/// The bodies that impacts moved in the step before, found from the world alone, for a world that this pipeline has not
/// stepped before and that may have been loaded: the bodies of all colliders whose pose alone was changed, fast ones
/// too, since slow ones may touch them. None if no body is slow. To be called before the step moves colliders to where
/// the user put their bodies.
pub fn moved_before(
    bodies: &RigidBodySet,
    colliders: &ColliderSet,
    length_unit: Real,
) -> Vec<RigidBodyHandle> {
    // A new world has none that is slow, and its colliders need not be looked at.
    if bodies.iter().all(|(_, b)| !is_slow(b, length_unit)) {
        return Vec::new();
    }
    let modified = colliders.clone().take_modified();
    let moved = modified.iter().filter_map(|h| colliders.get(*h));
    let moved = moved.filter(|c| slight_change(c) == Some(SlightChange::Pose));
    moved.filter_map(Collider::parent).collect()
}

impl SleepTimers {
    /// Shortens the time that is needed of bodies that impacts `moved` in the last step, and of those in contact with
    /// them.
    pub fn shorten(
        moved: &[RigidBodyHandle],
        bodies: &mut RigidBodySet,
        (colliders, narrow_phase): (&ColliderSet, &NarrowPhase),
        length_unit: Real,
    ) -> Self {
        let of_collider = |handle| colliders.get(handle).and_then(|c| c.parent());
        let mut restarted: Vec<RigidBodyHandle> = Vec::new();
        for &body in moved {
            restarted.push(body);
            let own = bodies.get(body).map_or(&[][..], |b| b.colliders());
            let pairs = own.iter().flat_map(|c| narrow_phase.contact_pairs_with(*c));
            let both = pairs.flat_map(|pair| [pair.collider1, pair.collider2]);
            restarted.extend(both.filter_map(of_collider));
        }
        restarted.sort_unstable_by_key(|body| body.into_raw_parts());
        restarted.dedup();
        let mut timers = Vec::new();
        for body in restarted {
            let Some(b) = bodies.get(body).filter(|b| is_slow(b, length_unit)) else {
                continue;
            };
            let slow = b.activation().time_since_can_sleep;
            let needed = b.activation().time_until_sleep;
            timers.push(Timer { body, slow, needed });
            if let Some(b) = bodies.get_mut(body) {
                b.activation_mut().time_until_sleep = (needed - slow).max(0.0);
            }
        }
        Self(timers)
    }

    /// Gives the bodies back what they had, after rapier's step; those that were slow in it have been so for longer.
    pub fn restore(self, bodies: &mut RigidBodySet) {
        for Timer { body, slow, needed } in self.0 {
            let Some(b) = bodies.get_mut(body) else {
                continue;
            };
            let is_sleeping = b.is_sleeping();
            let activation = b.activation_mut();
            activation.time_until_sleep = needed;
            if is_sleeping {
                activation.time_since_can_sleep = needed;
            } else if activation.time_since_can_sleep > 0.0 {
                activation.time_since_can_sleep += slow;
            }
        }
    }
}

/// Whether a body was slow in the last step, and has no speed with which it would go on.
fn is_slow(body: &RigidBody, length_unit: Real) -> bool {
    let activation = body.activation();
    let may_sleep = activation.time_until_sleep > 0.0 && !body.is_sleeping();
    let was_slow = may_sleep && activation.time_since_can_sleep > 0.0;
    body.is_dynamic() && was_slow && has_no_speed(body, length_unit)
}

/// Whether no point of a body is faster by its velocities than a body may move that falls asleep.
fn has_no_speed(body: &RigidBody, length_unit: Real) -> bool {
    let extent = body.mass_properties().max_extent();
    let speed = body.linvel().length() + body.angvel().length() * extent;
    0.5 * speed < body.activation().normalized_linear_threshold * length_unit
}
