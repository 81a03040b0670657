//! Which colliders take part in a step. rapier tells colliders only within the step that their body was enabled or
//! disabled, so what runs before the step has to ask the body.

use rapier3d::dynamics::RigidBodySet;
use rapier3d::geometry::Collider;

/// Whether a collider will be enabled in the next step.
pub fn will_be_enabled(bodies: &RigidBodySet, collider: &Collider) -> bool {
    match collider.parent().and_then(|h| bodies.get(h)) {
        Some(body) => {
            body.is_enabled() && (collider.is_enabled() || !is_disabled_by_user(collider))
        }
        None => collider.is_enabled(),
    }
}

/// Whether the user disabled the collider itself, and not its body. rapier does not say which, but `set_enabled(true)`
/// works on those only.
fn is_disabled_by_user(collider: &Collider) -> bool {
    let mut tried = collider.clone();
    tried.set_enabled(true);
    !collider.is_enabled() && tried.is_enabled()
}
