//! The bodies of a world with locked axes, for contacts that cannot move them
//! ([`crate::parry::corrections::locked_axes`]), and pairs whose contacts rapier has kept from the time before axes
//! were locked or let go.

use crate::math::Vector;
use crate::medial::MedialMesh;
use crate::parry::contacts::manifold_points::places;
use crate::parry::corrections::locked_axes::{LockedBodies, Moved, Response, UNSOLVED};
use crate::parry::shape_id::ShapeId;
use crate::rapier::view::medial_colliders::{MedialColliders, Sets};
use crate::rapier::view::participants::enabled;
use rapier3d::dynamics::{LockedAxes, RigidBody, RigidBodyHandle};
use rapier3d::geometry::{Collider, ContactPair};

/// All bodies that impulses move, if one of them has some axes locked, but not all.
pub fn find(sets: &Sets, medial: &MedialColliders) -> Option<LockedBodies> {
    if !any_locked(sets) {
        return None;
    }
    let response = |body| response(sets, body);
    let mut bodies = LockedBodies::default();
    for collider in &medial.all {
        let shape = ShapeId::new(&collider.mesh);
        bodies.add(shape, *collider.pose(), response(collider.body));
    }
    let is_other = |c: &Collider| c.shape().as_shape::<MedialMesh>().is_none();
    let others = enabled(sets.bodies, sets.colliders, sets.participants);
    for (_, collider) in others.filter(|(_, c)| is_other(c)) {
        if let Some(moved) = response(collider.parent()) {
            let shape = ShapeId::new(collider.shape());
            bodies.add(shape, *collider.position(), Some(moved));
        }
    }
    Some(bodies)
}

/// Whether axes were locked or let go since rapier computed the contacts of a pair: it solves one that cannot move
/// anything, or does not solve one that can. `any_locked`: what [`any_locked`] says of the world.
pub fn is_stale(sets: &Sets, pair: &ContactPair, any_locked: bool) -> bool {
    let colliders = [pair.collider1, pair.collider2].map(|h| sets.colliders.get(h));
    let [Some(first), Some(second)] = colliders else {
        return false;
    };
    let bodies = match any_locked {
        true => [first, second].map(|c| response(sets, c.parent())),
        false => [None, None],
    };
    let moved = Moved::of(&bodies);
    pair.manifolds().iter().any(|m| {
        let is_held = |i: usize| {
            let moved = moved.as_ref();
            moved.is_some_and(|moved| {
                moved.is_held(first.position() * places(m, i)[0], m.data.normal)
            })
        };
        (0..m.points.len()).any(|i| is_held(i) == (m.points[i].dist < UNSOLVED))
    })
}

/// Whether impulses move a body of which some axes are locked, but not all.
pub fn any_locked(sets: &Sets) -> bool {
    let mut all = sets.bodies.iter();
    all.any(|(_, body)| body.is_dynamic() && is_partly_locked(body))
}

fn is_partly_locked(body: &RigidBody) -> bool {
    let locked = body.locked_axes();
    !locked.is_empty() && locked != LockedAxes::all()
}

/// How a body responds to impulses; `None` if they do not move it. A link of a multibody moves as its joints let it,
/// which is not looked at.
fn response(sets: &Sets, handle: Option<RigidBodyHandle>) -> Option<Response> {
    let handle = handle?;
    let body = sets.bodies.get(handle)?;
    let is_link = sets.multibody_joints.rigid_body_link(handle).is_some();
    let mass = body.mass_properties();
    let unlocked = mass.local_mprops.inv_mass;
    (body.is_dynamic() && unlocked > 0.0).then(|| Response {
        center: mass.world_com,
        inverse_mass: if is_link {
            Vector::splat(unlocked)
        } else {
            mass.effective_inv_mass
        },
        inverse_inertia: mass.effective_world_inv_inertia,
        unlocked,
        is_partly_locked: is_partly_locked(body) && !is_link,
        dominance: body.dominance_group(),
    })
}
