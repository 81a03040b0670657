//! Makes rapier compute contacts anew although their pair has hardly moved: it would keep them until the pair has moved
//! by the recycle distance. Which contacts these are is decided in [`crate::rapier::contacts::hanging`] and
//! [`crate::rapier::contacts::outnumbered`].
//!
//! rapier notes that distance with each pair when it computes it, and goes by it until it computes the pair again. So
//! after steps with the user's distance, pairs of medial colliders would be kept for too long. A bit in the world, and
//! not a record of the pipeline, says which colliders have such pairs: worlds that are saved or copied go on alike.

use crate::medial::MedialMesh;
use rapier3d::dynamics::RigidBodySet;
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, NarrowPhase};
use rapier3d::pipeline::ActiveHooks;
use std::collections::HashSet;

/// A bit of a collider's hooks that means nothing to rapier but that there are some: it keeps no contacts
/// of such a collider, and calls no hook. It stays until the next step: a collider that is changed after
/// a step counts as changed by the user.
const FORCE_UPDATE_BIT: ActiveHooks = ActiveHooks::from_bits_retain(1 << 31);

/// The mark: a second bit that does the same, of colliders of which rapier may have pairs noted with the user's
/// distance. It stays until all of these have been computed with the smaller one.
const KEPT_LONGER_BIT: ActiveHooks = ActiveHooks::from_bits_retain(1 << 30);

/// Both bits.
const OWN_BITS: ActiveHooks = FORCE_UPDATE_BIT.union(KEPT_LONGER_BIT);

/// Colliders whose contacts rapier must compute anew in its next step.
pub struct Forced {
    /// Colliders whose contacts are computed anew in this step only.
    pub once: HashSet<ColliderHandle>,
    /// Whether every medial collider is one of them, because rapier goes by the user's recycle distance in this step
    /// ([`crate::rapier::contacts::outnumbered`]).
    pub all_medial: bool,
    /// Whether rapier keeps no contacts in this step, and so notes nothing.
    pub notes_nothing: bool,
}

/// Makes rapier compute all contacts of these colliders anew in its next step, and those of colliders of which it may
/// have kept some for longer.
pub fn force_updates(
    forced: &Forced,
    (bodies, narrow_phase): (&RigidBodySet, &NarrowPhase),
    colliders: &mut ColliderSet,
) {
    let is_marked = |c: &Collider| kept_longer(c.active_hooks());
    // Contacts of bodies that sleep on a fixed collider are not computed in the step, so those take over its mark where
    // it ends.
    let all_stay = forced.all_medial || forced.notes_nothing;
    let marked = colliders.iter().filter(|(_, c)| is_marked(c));
    let ends = marked.filter(|(_, c)| !(all_stay || is_asleep(bodies, c)));
    let pairs = ends.flat_map(|(handle, _)| narrow_phase.contact_pairs_with(handle));
    let partners: HashSet<ColliderHandle> = pairs
        .flat_map(|pair| [pair.collider1, pair.collider2])
        .collect();
    let bits = |handle: ColliderHandle, collider: &Collider| {
        let is_medial = || collider.shape().as_shape::<MedialMesh>().is_some();
        let is_marked = is_marked(collider) || partners.contains(&handle);
        let stays = forced.notes_nothing || is_asleep(bodies, collider);
        if forced.all_medial && is_medial() || is_marked && stays {
            KEPT_LONGER_BIT
        } else if kept_longer(collider.active_hooks()) || forced.once.contains(&handle) {
            FORCE_UPDATE_BIT
        } else {
            ActiveHooks::empty()
        }
    };
    let changed = colliders.iter().filter_map(|(handle, collider)| {
        let hooks = collider.active_hooks();
        let wanted = hooks.difference(OWN_BITS) | bits(handle, collider);
        (wanted != hooks).then_some((handle, wanted))
    });
    let changed: Vec<(ColliderHandle, ActiveHooks)> = changed.collect();
    for (handle, hooks) in changed {
        if let Some(collider) = colliders.get_mut(handle) {
            collider.set_active_hooks(hooks);
        }
    }
}

/// Whether a collider is on a body that sleeps: rapier leaves out its pairs with what sleeps or is fixed.
fn is_asleep(bodies: &RigidBodySet, collider: &Collider) -> bool {
    let body = collider.parent().and_then(|body| bodies.get(body));
    body.is_some_and(|body| body.is_dynamic() && body.is_sleeping())
}

/// Whether the user has hooks on a collider with these.
pub fn is_hooked(hooks: ActiveHooks) -> bool {
    !hooks.difference(OWN_BITS).is_empty()
}

/// Whether a collider with these is marked: rapier may have kept its contacts for as long as the user says.
pub fn kept_longer(hooks: ActiveHooks) -> bool {
    hooks.contains(KEPT_LONGER_BIT)
}
