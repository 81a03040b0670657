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

/// Whether the user disabled it, and not its body. rapier tells no difference, but only what the user disabled can
/// be enabled again.
fn is_disabled_by_user(collider: &Collider) -> bool {
    let mut tried = collider.clone();
    tried.set_enabled(true);
    !collider.is_enabled() && tried.is_enabled()
}
