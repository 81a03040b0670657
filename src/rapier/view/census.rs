//! Census of a world before a step: whether one look at all bodies and colliders finds anything to prepare.

use crate::math::fast_hash::FastHasher;
use crate::math::{Pose, Vector};
use crate::medial::MedialMesh;
use crate::rapier::view::enabled::will_be_enabled;
use rapier3d::dynamics::{
    GenericJoint, ImpulseJointSet, MultibodyJointSet, RigidBody, RigidBodyHandle, RigidBodySet,
    SoftBodySet,
};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet};
use rapier3d::pipeline::ActiveHooks;
use std::hash::Hasher;

/// A world at the start of a step, as far as medial colliders may meet something in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Medial colliders, also disabled ones.
    pub all: usize,
    /// Medial colliders that take part.
    pub medial: usize,
    /// Whether the user modifies any contacts.
    pub any_modified: bool,
    /// Hash of who is where, if nothing moves that a medial collider could meet; while it stays the same, what was
    /// prepared for the step before holds.
    pub still: Option<u64>,
}

impl Census {
    /// Takes the census of a world whose colliders are where the user put their bodies.
    pub fn take(
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        (joints, multibodies): (&ImpulseJointSet, &MultibodyJointSet),
        soft: &SoftBodySet,
    ) -> Self {
        // A sleeping or fixed body with a speed, or with one that is NaN, counts as moving: rapier wakes or disables
        // it.
        let has_speed =
            |body: &RigidBody| body.linvel() != Vector::ZERO || body.angvel() != Vector::ZERO;
        let moves = |body: &RigidBody| {
            body.is_enabled() && (has_speed(body) || !(body.is_fixed() || body.is_sleeping()))
        };
        let mut places = (soft.is_empty() && !bodies.iter().any(|(_, body)| moves(body)))
            .then(FastHasher::default);
        let mut census = Self::default();
        for (handle, collider) in colliders.iter() {
            let hooks = collider.active_hooks();
            census.any_modified |= hooks.contains(ActiveHooks::MODIFY_SOLVER_CONTACTS);
            let medial = collider.shape().as_shape::<MedialMesh>().is_some();
            census.all += usize::from(medial);
            if !medial && places.is_none() || !will_be_enabled(bodies, collider) {
                continue;
            }
            census.medial += usize::from(medial);
            if let Some(hash) = &mut places {
                add(hash, handle, collider);
            }
        }
        census.still = match places {
            _ if census.medial == 0 => Some(0),
            Some(mut hash) => {
                add_bodies(&mut hash, bodies, (joints, multibodies));
                Some(hash.finish())
            }
            None => None,
        };
        census
    }
}

/// Adds the bodies' kinds and what joints tie together: with the colliders that take part, their shapes and poses, all
/// that rapier itself may wake within its step.
fn add_bodies(
    hash: &mut FastHasher,
    bodies: &RigidBodySet,
    (joints, multibodies): (&ImpulseJointSet, &MultibodyJointSet),
) {
    let mut tie = |a: RigidBodyHandle, b: RigidBodyHandle, joint: &GenericJoint| {
        hash.write_u64(whole(a.into_raw_parts()));
        hash.write_u64(whole(b.into_raw_parts()));
        hash.write_u32(u32::from(joint.contacts_enabled()) << 1 | u32::from(joint.is_enabled()));
    };
    for (_, joint) in joints.iter() {
        tie(joint.body1(), joint.body2(), &joint.data);
    }
    for multibody in multibodies.multibodies() {
        for link in multibody.links() {
            let parent = link.parent_id().and_then(|id| multibody.link(id));
            let parent = parent.map_or(link.rigid_body_handle(), |l| l.rigid_body_handle());
            tie(parent, link.rigid_body_handle(), &link.joint.data);
        }
    }
    for (handle, body) in bodies.iter() {
        let locked = body.locked_axes().bits();
        hash.write_u64(whole(handle.into_raw_parts()));
        hash.write_u32((body.body_type() as u32) << 8 | u32::from(locked));
    }
}

fn add(hash: &mut FastHasher, handle: ColliderHandle, collider: &Collider) {
    hash.write_u64(whole(handle.into_raw_parts()));
    hash.write_u64(std::ptr::from_ref(collider.shape()).addr() as u64);
    // The place beside its body is the user's until rapier's step moves the collider there.
    for pose in [Some(collider.position()), collider.position_wrt_parent()] {
        let pose = pose.copied().unwrap_or(Pose::IDENTITY);
        let (t, r) = (pose.translation, pose.rotation);
        let [x, y, z, i, j, k, w] = [t.x, t.y, t.z, r.x, r.y, r.z, r.w].map(f32::to_bits);
        for word in [(x, y), (z, i), (j, k), (w, 0)] {
            hash.write_u64(whole(word));
        }
    }
    let skin = collider.contact_skin().to_bits();
    hash.write_u64(whole((skin, collider.is_sensor().into())));
}

/// Two words as one.
fn whole((a, b): (u32, u32)) -> u64 {
    u64::from(a) << 32 | u64::from(b)
}
