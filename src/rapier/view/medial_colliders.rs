//! The medial colliders of a world at the start of a step, with all that their contacts are predicted from: mesh,
//! motion, forces, box, skin, mass.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::contacts::contact_reduction::Turn;
use crate::rapier::view::body_velocity::{forces_per_mass, velocities};
use crate::rapier::view::participants::{Participants, enabled};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::AngularInertia;
use parry3d::query::NonlinearRigidMotion;
use parry3d::shape::Shape;
use rapier3d::dynamics::{
    ImpulseJointSet, IntegrationParameters, JointAxesMask, MultibodyJointSet, RigidBody,
    RigidBodyHandle, RigidBodySet,
};
use rapier3d::geometry::{
    Collider, ColliderHandle, ColliderSet, InteractionGroups, NarrowPhase, SharedShape,
};
use rapier3d::pipeline::ActiveHooks;

/// rapier's sets of a world, to be read at the start of a step.
#[derive(Clone, Copy)]
pub struct Sets<'a> {
    /// Gravity.
    pub gravity: Vector,
    /// Parameters of the step.
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
    /// Colliders that take part, where not all do.
    pub participants: Option<&'a Participants>,
}

#[cfg(feature = "gpu")]
impl<'a> Sets<'a> {
    /// The sets of a world.
    pub fn of(world: &'a rapier3d::pipeline::PhysicsWorld) -> Self {
        Self {
            gravity: world.gravity,
            parameters: &world.integration_parameters,
            bodies: &world.bodies,
            colliders: &world.colliders,
            impulse_joints: &world.impulse_joints,
            multibody_joints: &world.multibody_joints,
            narrow_phase: &world.narrow_phase,
            participants: None,
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
    let medial = enabled(bodies, colliders, None).filter_map(|(handle, collider)| {
        let mesh = collider.shape().as_shape::<MedialMesh>()?;
        Some((mesh.instance_id(), handle))
    });
    let mut ids: Vec<(u64, ColliderHandle)> = medial.collect();
    if ids.is_sorted_by(|one, next| one.0 < next.0) {
        return;
    }
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

/// A medial collider at the start of a step.
pub struct MedialCollider {
    /// Handle of the collider.
    pub handle: ColliderHandle,
    /// Body of the collider; `None` if it has none.
    pub body: Option<RigidBodyHandle>,
    /// Shape, whose instance id tells the collider apart from all others.
    pub mesh: MedialMesh,
    /// Whether the body is dynamic; nothing pushes fixed and kinematic ones.
    pub is_dynamic: bool,
    /// Mass and centre of mass of the body, if the solver moves it and it is awake.
    pub moving: Option<(Real, Vector)>,
    /// Motion that the velocities announce. It starts where the narrow phase will see the collider, to the bit.
    pub motion: NonlinearRigidMotion,
    /// Acceleration of the body by gravity and the user's forces, unless something holds it.
    pub acceleration: Vector,
    /// Inverse inertia of the body, world frame; zero for what nothing turns.
    pub inverse_inertia: AngularInertia,
    /// Contact skin, a length.
    pub skin: Real,
    /// Largest distance of a corner of the box from the origin, a length: of the lowest and the highest corner.
    pub reach: Real,
    /// Bound on the distance of points from the origin, a length.
    pub extent: Real,
    /// Box in the world, grown by as far as contacts are looked for.
    pub aabb: Aabb,
    /// Parent of the body in a multibody, and where the joint to it is in the collider's frame, if it lets the body
    /// turn only.
    pub joint: Option<(RigidBodyHandle, Vector)>,
    /// Hooks of the user on the collider.
    pub hooks: ActiveHooks,
    /// Whether it hangs in a contact ([`crate::rapier::contacts::hanging`]).
    pub hangs: bool,
    /// Speed of what may push it ([`crate::rapier::contacts::neighbor_speeds`]).
    pub pushed: Real,
    groups: InteractionGroups,
    is_sensor: bool,
}

impl MedialCollider {
    /// The collider of a handle; `None` if it is not medial, or its pose not finite.
    fn new(sets: &Sets, handle: ColliderHandle, collider: &Collider) -> Option<Self> {
        let mesh = collider.shape().as_shape::<MedialMesh>()?;
        let parent = collider.parent();
        let body = parent.and_then(|h| sets.bodies.get(h));
        let offset = collider.position_wrt_parent();
        let pose = match (body, offset) {
            (Some(body), Some(offset)) => *body.position() * *offset,
            _ => *collider.position(),
        };
        if !pose.is_finite() {
            return None;
        }
        let offset = offset.copied().unwrap_or(Pose::IDENTITY);
        let skin = collider.contact_skin();
        let margin = sets.parameters.prediction_distance() + skin;
        let local = mesh.aabb();
        let [linvel, angvel] =
            body.map_or([Vector::ZERO; 2], |b| velocities(b, sets.parameters.dt));
        let center = |b: &RigidBody| offset.inverse() * b.mass_properties().local_mprops.local_com;
        let moves = |body: &&RigidBody| body.is_enabled() && !body.is_sleeping();
        let dynamic = body.filter(|b| b.is_dynamic());
        let moving = dynamic.filter(moves);
        Some(Self {
            handle,
            body: parent.filter(|_| body.is_some()),
            mesh: mesh.clone(),
            is_dynamic: dynamic.is_some(),
            moving: moving.map(|body| (body.mass(), body.center_of_mass())),
            motion: NonlinearRigidMotion {
                start: pose,
                local_center: body.map_or(Vector::ZERO, center),
                linvel,
                angvel,
            },
            acceleration: dynamic.map_or(Vector::ZERO, |b| forces_per_mass(b, sets.gravity)),
            inverse_inertia: dynamic.map_or_else(AngularInertia::zero, |b| {
                b.mass_properties().effective_world_inv_inertia
            }),
            skin,
            reach: local.mins.length().max(local.maxs.length()),
            extent: local.mins.abs().max(local.maxs.abs()).length(),
            aabb: mesh.compute_aabb(&pose).loosened(margin),
            joint: parent.and_then(|h| joint(sets.multibody_joints, h, offset)),
            hooks: collider.active_hooks(),
            hangs: false,
            pushed: 0.0,
            groups: collider.collision_groups(),
            is_sensor: collider.is_sensor(),
        })
    }

    /// Pose at the start of the step.
    pub fn pose(&self) -> &Pose {
        &self.motion.start
    }

    /// Whether the user has a hook on its solver contacts.
    pub fn is_modified(&self) -> bool {
        self.hooks.contains(ActiveHooks::MODIFY_SOLVER_CONTACTS)
    }

    /// Bound on the speed at which its points turn about the centre of mass.
    pub fn swing(&self) -> Real {
        self.motion.angvel.length() * (self.motion.local_center.length() + self.extent)
    }

    /// How it turns in `seconds`; `None` if nothing turns it.
    pub fn turn(&self, seconds: Real) -> Option<Turn> {
        let motion = &self.motion;
        let angle = motion.start.rotation.inverse() * motion.angvel * seconds;
        (angle != Vector::ZERO).then_some(Turn {
            angle,
            center: motion.local_center,
        })
    }

    /// Bound on the speed of its points.
    pub fn speed(&self) -> Real {
        self.motion.linvel.length() + self.swing()
    }
}

/// The parent of a body in a multibody, and the anchor of the joint to it in the frame of a collider at `offset` in the
/// body's frame; `None` if the body has no parent, or can do more than turn about the anchor.
fn joint(
    multibodies: &MultibodyJointSet,
    body: RigidBodyHandle,
    offset: Pose,
) -> Option<(RigidBodyHandle, Vector)> {
    let id = multibodies.rigid_body_link(body)?;
    let multibody = multibodies.get_multibody(id.multibody)?;
    let link = multibody.link(id.id)?;
    let parent = multibody.link(link.parent_id()?)?;
    let joint = &link.joint.data;
    let turns_only = joint.locked_axes.contains(JointAxesMask::LIN_AXES);
    let anchor = offset.inverse() * joint.local_frame2.translation;
    turns_only.then(|| (parent.rigid_body_handle(), anchor))
}

/// The medial colliders of a world at the start of a step, whose poses are finite.
pub struct MedialColliders {
    /// All of them, in the order of their instance ids.
    pub all: Vec<MedialCollider>,
    /// Parameters of the step.
    pub parameters: IntegrationParameters,
    /// Place of each among all, by the index in its handle.
    places: Vec<u32>,
}

impl MedialColliders {
    /// The medial colliders of a world.
    pub fn new(sets: &Sets) -> Self {
        let medial = enabled(sets.bodies, sets.colliders, sets.participants);
        let medial = medial.filter_map(|(handle, c)| MedialCollider::new(sets, handle, c));
        let mut all: Vec<MedialCollider> = medial.collect();
        all.sort_by_key(|c| c.mesh.instance_id());
        let index = |c: &MedialCollider| c.handle.into_raw_parts().0 as usize;
        let mut places = vec![u32::MAX; all.iter().map(index).max().map_or(0, |last| last + 1)];
        for (place, collider) in all.iter().enumerate() {
            places[index(collider)] = place as u32;
        }
        Self {
            all,
            parameters: *sets.parameters,
            places,
        }
    }

    /// The place of a collider, if it is one of them.
    pub fn place(&self, collider: ColliderHandle) -> Option<usize> {
        let place = *self.places.get(collider.into_raw_parts().0 as usize)? as usize;
        (self.all.get(place)?.handle == collider).then_some(place)
    }

    /// The collider that has this instance of a mesh.
    pub fn of(&self, mesh: &MedialMesh) -> Option<&MedialCollider> {
        let id = mesh.instance_id();
        let place = self.all.binary_search_by_key(&id, |c| c.mesh.instance_id());
        Some(&self.all[place.ok()?])
    }

    /// Whether contacts of two of them are wanted: one at least is dynamic and awake, they are not on the
    /// same body, their groups are compatible, and neither is a sensor.
    pub fn meet(&self, pair: [usize; 2]) -> bool {
        let [a, b] = pair.map(|k| &self.all[k]);
        let same_body = a.body.is_some() && a.body == b.body;
        (a.moving.is_some() || b.moving.is_some())
            && !same_body
            && a.groups.test(b.groups)
            && !a.is_sensor
            && !b.is_sensor
    }

    /// Two of them in the narrow phase's order: lower collider index first.
    pub fn in_order(&self, [i, j]: [usize; 2]) -> [usize; 2] {
        let index = |k: usize| self.all[k].handle.into_raw_parts().0;
        if index(i) < index(j) { [i, j] } else { [j, i] }
    }
}
