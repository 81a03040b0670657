//! Colliders that stay where they are as long as nothing gets to them: fixed ones, and those of sleeping bodies that no
//! joint holds. A world may have thousands, and a step need not look at those that are far from all that moves
//! (`participants.rs`). Where they have been the same for some steps, a tree of their boxes is kept.

use crate::math::fast_hash::{FastHasher, FastMap};
use crate::math::{Pose, Real, Vector};
use crate::rapier::view::enabled::will_be_enabled;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use rapier3d::dynamics::{ImpulseJointSet, MultibodyJointSet, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet};
use std::hash::Hasher;
use std::sync::Arc;

/// Bound of the coordinates of boxes that the tree holds: with larger ones, as of a half-space, sums are no longer
/// exact.
const MAX_COORDINATE: Real = 1.0e6;

/// Steps in turn with the same still colliders after which the tree is built: where bodies wake and fall asleep all the
/// time it would be built in vain.
const SETTLING_STEPS: u32 = 3;

/// Still colliders, with a tree of their boxes.
pub struct StillColliders {
    handles: Vec<ColliderHandle>,
    boxes: Vec<Aabb>,
    tree: Bvh,
    /// Places of colliders whose boxes the tree cannot hold ([`MAX_COORDINATE`]).
    everywhere: Vec<u32>,
    /// Place of each among all, by the index in its handle.
    places: Vec<u32>,
    /// Where the dynamic bodies among them are.
    poses: FastMap<RigidBodyHandle, Pose>,
    /// Whether one has restitution.
    bounces: bool,
}

impl StillColliders {
    /// Boxes are grown by `margin` and the collider's skin.
    fn new(
        handles: Vec<ColliderHandle>,
        (bodies, colliders): (&RigidBodySet, &ColliderSet),
        (bounces, margin): (bool, Real),
    ) -> Self {
        let index = |h: &ColliderHandle| h.into_raw_parts().0 as usize;
        let mut places = vec![u32::MAX; handles.iter().map(index).max().map_or(0, |last| last + 1)];
        let (mut boxes, mut everywhere) = (Vec::new(), Vec::new());
        for (place, handle) in handles.iter().enumerate() {
            places[index(handle)] = place as u32;
            let aabb = colliders.get(*handle).map(|collider| {
                let grown = margin + collider.contact_skin();
                collider.compute_aabb().loosened(grown)
            });
            let held =
                aabb.filter(|b| b.mins.abs().max(b.maxs.abs()).max_element() < MAX_COORDINATE);
            if held.is_none() {
                everywhere.push(place as u32);
            }
            boxes.push(held.unwrap_or_else(Aabb::new_invalid));
        }
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let parents = handles.iter().filter_map(|h| colliders.get(*h)?.parent());
        let dynamic = parents.filter_map(|h| Some((h, bodies.get(h)?)));
        let dynamic = dynamic.filter(|(_, body)| body.is_dynamic());
        let poses = dynamic.map(|(h, body)| (h, *body.position())).collect();
        Self {
            handles,
            boxes,
            tree,
            everywhere,
            places,
            poses,
            bounces,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.handles.len()
    }

    /// The collider at a place.
    pub fn handle(&self, place: u32) -> ColliderHandle {
        self.handles[place as usize]
    }

    /// The place of a collider, if it is one of them.
    pub fn place(&self, collider: ColliderHandle) -> Option<u32> {
        let place = *self.places.get(collider.into_raw_parts().0 as usize)?;
        (*self.handles.get(place as usize)? == collider).then_some(place)
    }

    /// The colliders whose boxes the tree cannot hold.
    pub fn everywhere(&self) -> impl Iterator<Item = ColliderHandle> + '_ {
        self.everywhere.iter().map(|place| self.handle(*place))
    }

    /// Their dynamic bodies.
    pub fn dynamic_bodies(&self) -> impl Iterator<Item = RigidBodyHandle> + '_ {
        self.poses.keys().copied()
    }

    /// Where a dynamic body of theirs is.
    pub fn pose(&self, body: RigidBodyHandle) -> Option<Pose> {
        self.poses.get(&body).copied()
    }

    /// Whether one has restitution.
    pub fn bounce(&self) -> bool {
        self.bounces
    }

    /// Places of those whose boxes meet this one; of a box that is no number all.
    pub fn meeting(&self, aabb: &Aabb) -> Vec<u32> {
        if aabb.mins.is_nan() || aabb.maxs.is_nan() {
            return (0..self.handles.len() as u32).collect();
        }
        let near = self.tree.intersect_aabb(aabb);
        near.filter(|k| aabb.intersects(&self.boxes[*k as usize]))
            .collect()
    }
}

/// Record, from step to step, of the still colliders of a world.
#[derive(Default)]
pub struct StillRecord {
    /// Hash of who is where.
    key: u64,
    /// Steps for which that has been so.
    steps: u32,
    /// The colliders that moved, in the order of the set, and what decides with whom each collides.
    moving: Vec<(ColliderHandle, u64)>,
    known: Option<Arc<StillColliders>>,
}

impl StillRecord {
    /// Splits the enabled colliders into the moving ones, in the order of the set, and the still ones. `None` if the
    /// still ones have not been the same for [`SETTLING_STEPS`] steps, if there are fewer than `least` of them or fewer
    /// than `times` for each moving one, and for [`SETTLING_STEPS`] steps after a moving collider was removed or came
    /// to collide with others than before, since rapier may then wake what rested on it. The boxes in the tree are
    /// grown by `margin`, a length.
    pub fn look(
        &mut self,
        (bodies, colliders): (&RigidBodySet, &ColliderSet),
        joints: (&ImpulseJointSet, &MultibodyJointSet),
        ([least, times], margin): ([usize; 2], Real),
    ) -> Option<(Vec<ColliderHandle>, Arc<StillColliders>)> {
        let (mut moving, mut still) = (Vec::new(), Vec::new());
        let mut bounces = false;
        let mut hash = FastHasher::default();
        hash.write_u32(margin.to_bits());
        for (handle, collider) in colliders.iter() {
            if !will_be_enabled(bodies, collider) {
                continue;
            }
            if is_still(bodies, joints, collider) {
                add_place(&mut hash, handle, collider);
                hash.write_u64(partners(bodies, collider));
                bounces |= collider.restitution() > 0.0;
                still.push(handle);
            } else {
                moving.push((handle, partners(bodies, collider)));
            }
        }
        hash.write_u32(bounces.into());
        let key = hash.finish();
        let is_same = key == self.key && go_on(&self.moving, &moving);
        self.key = key;
        self.moving = moving;
        self.steps = if is_same { self.steps + 1 } else { 0 };
        let enough = still.len() >= least.max(times * self.moving.len());
        if self.steps < SETTLING_STEPS || !enough {
            self.known = None;
            return None;
        }
        let moving = self.moving.iter().map(|(handle, _)| *handle).collect();
        let known = self.known.get_or_insert_with(|| {
            let sets = (bodies, colliders);
            Arc::new(StillColliders::new(still, sets, (bounces, margin)))
        });
        Some((moving, Arc::clone(known)))
    }
}

/// Whether a collider stays where it is unless something gets to it.
fn is_still(
    bodies: &RigidBodySet,
    (joints, multibodies): (&ImpulseJointSet, &MultibodyJointSet),
    collider: &Collider,
) -> bool {
    let Some(handle) = collider.parent() else {
        return true;
    };
    let Some(body) = bodies.get(handle) else {
        return true;
    };
    let has_speed = body.linvel() != Vector::ZERO || body.angvel() != Vector::ZERO;
    let is_tied = |h: RigidBodyHandle| {
        joints.attached_joints(h).next().is_some() || multibodies.rigid_body_link(h).is_some()
    };
    let sleeps = body.is_dynamic() && body.is_sleeping() && !is_tied(handle);
    (body.is_fixed() || sleeps) && !has_speed
}

/// Whether all of some colliders are among others, unchanged; both in the order of the set.
fn go_on(before: &[(ColliderHandle, u64)], now: &[(ColliderHandle, u64)]) -> bool {
    let mut now = now.iter();
    before.iter().all(|known| now.any(|other| other == known))
}

/// Adds who it is, and where.
fn add_place(hash: &mut FastHasher, handle: ColliderHandle, collider: &Collider) {
    let (index, generation) = handle.into_raw_parts();
    hash.write_u64(u64::from(index) << 32 | u64::from(generation));
    // The place beside its body is the user's until rapier's step moves the collider there.
    let beside = collider.position_wrt_parent();
    for pose in [collider.position(), beside.unwrap_or(&Pose::IDENTITY)] {
        let (t, r) = (pose.translation, pose.rotation);
        for word in [t.x, t.y, t.z, r.x, r.y, r.z, r.w] {
            hash.write_u32(word.to_bits());
        }
    }
}

/// Hash of what decides with what a collider collides where it is, and who gives way.
fn partners(bodies: &RigidBodySet, collider: &Collider) -> u64 {
    let mut hash = FastHasher::default();
    hash.write_u64(std::ptr::from_ref(collider.shape()).addr() as u64);
    // A game may change a shape in place.
    let aabb = collider.shape().compute_local_aabb();
    for side in [aabb.mins, aabb.maxs] {
        for x in side.to_array() {
            hash.write_u32(x.to_bits());
        }
    }
    for groups in [collider.collision_groups(), collider.solver_groups()] {
        hash.write_u32(groups.memberships.bits());
        hash.write_u32(groups.filter.bits());
    }
    let body = collider.parent().and_then(|h| bodies.get(h));
    let body_type = body.map_or(u32::MAX, |body| body.body_type() as u32);
    let dominance = body.map_or(0, |body| body.effective_dominance_group());
    hash.write_i32(dominance.into());
    hash.write_u32(body_type << 1 | u32::from(collider.is_sensor()));
    hash.write_u32(collider.contact_skin().to_bits());
    hash.finish()
}
