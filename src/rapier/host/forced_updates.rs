//! Makes rapier compute contacts anew although their pair has hardly moved: it would keep them until the pair has moved by
//! the recycle distance. Which contacts these are is decided in [`crate::rapier::contacts::hanging`].

use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet};
use rapier3d::pipeline::ActiveHooks;
use std::collections::HashSet;

/// A bit of a collider's hooks that means nothing to rapier but that there are some: it keeps no contacts
/// of such a collider, and calls no hook. It stays until the next step: a collider that is changed after
/// a step counts as changed by the user.
const FORCE_UPDATE_BIT: ActiveHooks = ActiveHooks::from_bits_retain(1 << 31);

/// Makes rapier compute all contacts of these colliders anew in its next step, and of no others.
pub fn force_updates(forced: &HashSet<ColliderHandle>, colliders: &mut ColliderSet) {
    let is_asked = |c: &Collider| c.active_hooks().contains(FORCE_UPDATE_BIT);
    let wrong = colliders
        .iter()
        .filter(|(h, c)| is_asked(c) != forced.contains(h));
    let wrong: Vec<ColliderHandle> = wrong.map(|(handle, _)| handle).collect();
    for handle in wrong {
        if let Some(collider) = colliders.get_mut(handle) {
            let mut hooks = collider.active_hooks();
            hooks.toggle(FORCE_UPDATE_BIT);
            collider.set_active_hooks(hooks);
        }
    }
}

/// Whether the user has hooks on a collider with these.
pub fn is_hooked(hooks: ActiveHooks) -> bool {
    !hooks.difference(FORCE_UPDATE_BIT).is_empty()
}
