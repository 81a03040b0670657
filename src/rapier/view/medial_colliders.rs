//! The medial colliders of a world at the start of a step, with what the batch needs of them: mesh, pose, box, skin,
//! mass.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::rapier::contacts::predicted_contacts::Start;
use crate::rapier::host::enabled::enabled;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::{
    ImpulseJointSet, IntegrationParameters, JointAxesMask, MultibodyJointSet, RigidBody,
    RigidBodyHandle, RigidBodySet,
};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, NarrowPhase, SharedShape};
use rapier3d::pipeline::ActiveHooks;

/// The world at the start of a step.
#[derive(Clone, Copy)]
pub struct Sets<'a> {
    /// Gravity.
    pub gravity: Vector,
    /// Of the step.
    pub parameters: &'a IntegrationParameters,
    /// Bodies.
    pub bodies: &'a RigidBodySet,
    /// Colliders.
    pub colliders: &'a ColliderSet,
    /// Joints.
    pub impulse_joints: &'a ImpulseJointSet,
    /// Multibodies.
    pub multibody_joints: &'a MultibodyJointSet,
    /// Contacts of the step before.
    pub narrow_phase: &'a NarrowPhase,
}

#[cfg(feature = "gpu")]
impl<'a> Sets<'a> {
    /// Those of a world.
    pub fn of(world: &'a rapier3d::pipeline::PhysicsWorld) -> Self {
        Self {
            gravity: world.gravity,
            parameters: &world.integration_parameters,
            bodies: &world.bodies,
            colliders: &world.colliders,
            impulse_joints: &world.impulse_joints,
            multibody_joints: &world.multibody_joints,
            narrow_phase: &world.narrow_phase,
        }
    }
}

/// How many medial colliders are enabled.
pub fn count(colliders: &ColliderSet) -> usize {
    let medial = |c: &Collider| c.shape().as_shape::<MedialMesh>().is_some();
    colliders.iter_enabled().filter(|(_, c)| medial(c)).count()
}

/// Gives every medial collider an instance id of its own; colliders that share a shape would share
/// answers.
pub fn make_unique(bodies: &RigidBodySet, colliders: &mut ColliderSet) {
    let medial = enabled(bodies, colliders).filter_map(|(handle, collider)| {
        let mesh = collider.shape().as_shape::<MedialMesh>()?;
        Some((mesh.instance_id(), handle))
    });
    let mut ids: Vec<(u64, ColliderHandle)> = medial.collect();
    // The first of several keeps its id.
    ids.sort_by_key(|(id, _)| *id);
    for two in ids.windows(2).filter(|two| two[0].0 == two[1].0) {
        if let Some(collider) = colliders.get_mut(two[1].1)
            && let Some(mesh) = collider.shape().as_shape::<MedialMesh>()
        {
            let own = SharedShape::new(mesh.instance());
            collider.set_shape(own);
        }
    }
}

/// A medial collider.
pub struct MedialCollider<'a> {
    /// Its handle.
    pub handle: ColliderHandle,
    /// The collider.
    pub collider: &'a Collider,
    /// Its body, if it has one.
    pub parent: Option<(RigidBodyHandle, &'a RigidBody)>,
    /// Its shape.
    pub mesh: &'a MedialMesh,
    /// What tells it apart in caches.
    pub id: u64,
    /// Its body, if the solver moves it and it is awake: mass and centre of mass.
    pub moving: Option<(Real, Vector)>,
    /// Its contact skin.
    pub skin: Real,
    /// Largest distance of a corner of its box from its origin.
    pub reach: Real,
    /// Where the narrow phase will see it, to the bit.
    pub pose: Pose,
    /// Its box, as far as contacts are looked for.
    pub aabb: Aabb,
}

impl<'a> MedialCollider<'a> {
    /// Its motion, in a step of this gravity and length.
    pub fn start(&self, sets: &Sets) -> Start {
        let aabb = self.mesh.aabb();
        let offset = self.collider.position_wrt_parent();
        let extent = aabb.mins.abs().max(aabb.maxs.abs()).length();
        let mut start = Start::new(
            self.parent.map(|(_, body)| body),
            [self.pose, offset.copied().unwrap_or(Pose::IDENTITY)],
            [extent, self.skin],
            sets.gravity,
            sets.parameters.dt,
        );
        start.body = self.parent.map(|(handle, _)| handle);
        start.joint = self.joint(sets.multibody_joints, offset.copied());
        let hooks = self.collider.active_hooks();
        start.modified = hooks.contains(ActiveHooks::MODIFY_SOLVER_CONTACTS);
        start
    }

    /// The parent of its body in a multibody, and where the joint to it is in the collider's frame, if that lets it
    /// turn only.
    fn joint(
        &self,
        multibodies: &MultibodyJointSet,
        offset: Option<Pose>,
    ) -> Option<(RigidBodyHandle, Vector)> {
        let id = multibodies.rigid_body_link(self.parent?.0)?;
        let multibody = multibodies.get_multibody(id.multibody)?;
        let link = multibody.link(id.id)?;
        let parent = multibody.link(link.parent_id()?)?;
        let joint = &link.joint.data;
        let turns_only = joint.locked_axes.contains(JointAxesMask::LIN_AXES);
        let anchor = offset.unwrap_or(Pose::IDENTITY).inverse() * joint.local_frame2.translation;
        turns_only.then(|| (parent.rigid_body_handle(), anchor))
    }
}

/// All of them, by instance id.
pub struct MedialColliders<'a> {
    /// In this order.
    pub all: Vec<MedialCollider<'a>>,
    /// By the index in their handle, the place among all of them.
    places: Vec<u32>,
}

impl<'a> MedialColliders<'a> {
    /// Those of a world, as far as their poses are finite.
    pub fn new(sets: &Sets<'a>) -> Self {
        let prediction = sets.parameters.prediction_distance();
        let medial = enabled(sets.bodies, sets.colliders);
        let medial =
            medial.filter_map(|(handle, collider)| item(sets, prediction, handle, collider));
        let mut all: Vec<MedialCollider> = medial.collect();
        all.sort_by_key(|item| item.id);
        let index = |item: &MedialCollider| item.handle.into_raw_parts().0 as usize;
        let mut places = vec![u32::MAX; all.iter().map(index).max().map_or(0, |last| last + 1)];
        for (place, item) in all.iter().enumerate() {
            places[index(item)] = place as u32;
        }
        Self { all, places }
    }

    /// The place of a collider, if it is one of them.
    pub fn place(&self, collider: ColliderHandle) -> Option<usize> {
        let place = *self.places.get(collider.into_raw_parts().0 as usize)? as usize;
        (self.all.get(place)?.handle == collider).then_some(place)
    }

    /// Whether contacts of two of them are wanted: one at least is dynamic and awake, they are not on the
    /// same body, their groups are compatible, and neither is a sensor.
    pub fn meet(&self, pair: [usize; 2]) -> bool {
        let [a, b] = pair.map(|k| &self.all[k]);
        let same_body = match (a.parent, b.parent) {
            (Some((x, _)), Some((y, _))) => x == y,
            _ => false,
        };
        (a.moving.is_some() || b.moving.is_some())
            && !same_body
            && a.collider
                .collision_groups()
                .test(b.collider.collision_groups())
            && !a.collider.is_sensor()
            && !b.collider.is_sensor()
    }

    /// In the narrow phase's order: lower collider index first.
    pub fn in_order(&self, [i, j]: [usize; 2]) -> [usize; 2] {
        let index = |k: usize| self.all[k].handle.into_raw_parts().0;
        if index(i) < index(j) { [i, j] } else { [j, i] }
    }
}

fn item<'a>(
    sets: &Sets<'a>,
    prediction: Real,
    handle: ColliderHandle,
    collider: &'a Collider,
) -> Option<MedialCollider<'a>> {
    let mesh = collider.shape().as_shape::<MedialMesh>()?;
    let parent = collider
        .parent()
        .and_then(|h| sets.bodies.get(h).map(|body| (h, body)));
    let pose = match (parent, collider.position_wrt_parent()) {
        (Some((_, body)), Some(offset)) => *body.position() * *offset,
        _ => *collider.position(),
    };
    let skin = collider.contact_skin();
    let aabb = parry3d::shape::Shape::compute_aabb(mesh, &pose).loosened(prediction + skin);
    let local = mesh.aabb();
    let moving = |body: &RigidBody| body.is_dynamic() && body.is_enabled() && !body.is_sleeping();
    let body = parent.map(|(_, body)| body).filter(|body| moving(body));
    pose.is_finite().then_some(MedialCollider {
        handle,
        collider,
        parent,
        mesh,
        id: mesh.instance_id(),
        moving: body.map(|body| (body.mass(), body.center_of_mass())),
        skin,
        reach: local.mins.length().max(local.maxs.length()),
        pose,
        aabb,
    })
}
