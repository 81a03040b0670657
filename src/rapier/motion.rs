//! Who moves in a step, and how: bodies and colliders before rapier's step, and the motion it then
//! gave them. rapier turns a body in `n` linearised pieces, so a fast turn ends short of `|ω| dt`;
//! what counts is where the body is, and the turns it made on the way.

use super::enabled::enabled;
use super::links;
use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Rotation, Vector};
use crate::medial::MedialMesh;
use parry3d::bounding_volume::{Aabb, BoundingSphere, BoundingVolume};
use parry3d::mass_properties::MassProperties;
use parry3d::query::NonlinearRigidMotion;
use rapier3d::dynamics::{
    ImpulseJointSet, IntegrationParameters, LockedAxes, MultibodyJointSet, RigidBody,
    RigidBodyHandle, RigidBodySet, RigidBodyType,
};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, SharedShape};
use std::f32::consts::TAU;

/// Turn in a step, in radians, from which the end rotation alone may hide whole turns.
const MAY_WRAP: Real = 2.5;

/// Turn in a step, in radians, up to which the boxes at both ends, grown by the sagitta, bound it.
const SMALL_TURN: Real = 0.5;

/// Whether an impact may move a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Never moves.
    Fixed,
    /// Moves, and nothing stops it: kinematic bodies, and links of multibodies of which a joint is kinematic or
    /// coupled to another.
    Driven,
    /// Dynamic.
    Free,
}

/// A body in a step.
#[derive(Clone, Debug)]
pub struct Body {
    /// `None` for what colliders without a body stand on.
    pub handle: Option<RigidBodyHandle>,
    /// Whether an impact may move it.
    pub kind: Kind,
    /// Took part in rapier's step.
    pub awake: bool,
    /// Motion from [`Self::time`] on, world frame, per second.
    pub motion: NonlinearRigidMotion,
    /// Seconds into the step at which `motion` starts.
    pub time: Real,
    /// Pose at the start of the step.
    start: Pose,
    /// Linear and angular velocity that the solver works with, per second. The angular velocity turns with
    /// the body: where the step turns it about another axis, one fixed in the world would change its energy.
    pub velocity: [Vector; 2],
    /// What joints add to them in a second: they turn velocities.
    bend: [Vector; 2],
    /// The velocities before rapier's step.
    velocity_before: [Vector; 2],
    /// Largest distance of a point of its colliders from the centre of mass, a length.
    pub reach: Real,
    /// Mass, centre and inertia in the body's frame.
    pub mass: MassProperties,
    /// Inverse mass along the world's axes, 0 where locked.
    pub inverse_mass: Vector,
    /// Locked axes.
    pub locked: LockedAxes,
    /// rapier's dominance group.
    pub dominance: i16,
}

impl Body {
    fn new(handle: RigidBodyHandle, body: &RigidBody, is_free: bool) -> Self {
        let kind = match (body.is_fixed(), body.is_dynamic() && is_free) {
            (true, _) => Kind::Fixed,
            (false, true) => Kind::Free,
            (false, false) => Kind::Driven,
        };
        let properties = body.mass_properties();
        Self {
            handle: Some(handle),
            kind,
            awake: kind != Kind::Fixed && !body.is_sleeping(),
            motion: NonlinearRigidMotion {
                local_center: properties.local_mprops.local_com,
                ..NonlinearRigidMotion::constant_position(*body.position())
            },
            time: 0.0,
            start: *body.position(),
            velocity: [body.linvel(), body.angvel()],
            bend: [Vector::ZERO; 2],
            velocity_before: [body.linvel(), body.angvel()],
            reach: 0.0,
            mass: properties.local_mprops,
            inverse_mass: properties.effective_inv_mass,
            locked: properties.flags,
            dominance: body.effective_dominance_group(),
        }
    }

    fn ground() -> Self {
        Self {
            handle: None,
            kind: Kind::Fixed,
            awake: false,
            motion: NonlinearRigidMotion::identity(),
            time: 0.0,
            start: Pose::IDENTITY,
            velocity: [Vector::ZERO; 2],
            bend: [Vector::ZERO; 2],
            velocity_before: [Vector::ZERO; 2],
            reach: 0.0,
            mass: MassProperties::default(),
            inverse_mass: Vector::ZERO,
            locked: LockedAxes::empty(),
            dominance: i16::from(i8::MAX) + 1,
        }
    }

    /// Velocity with which the solver starts, before contacts: gravity and forces of the user.
    fn predict(&mut self, body: &RigidBody, gravity: Vector, dt: Real) {
        if self.kind == Kind::Fixed || !self.awake {
            return;
        }
        [self.motion.linvel, self.motion.angvel] = velocities(body, dt);
        if body.is_dynamic() {
            let forces = gravity * body.gravity_scale() + body.user_force() * self.inverse_mass;
            self.motion.linvel += forces * dt;
        }
    }

    /// The motion that took it to where it is after rapier's step.
    fn moved(&mut self, body: &RigidBody, iterations: usize, dt: Real) {
        // rapier computes the mass of a body that is new in this step only now.
        let properties = body.mass_properties();
        let com = properties.local_mprops.local_com;
        self.reach += (com - self.mass.local_com).length();
        self.mass = properties.local_mprops;
        self.inverse_mass = properties.effective_inv_mass;
        self.locked = properties.flags;
        self.dominance = body.effective_dominance_group();
        self.motion.local_center = com;
        let (start, end) = (self.motion.start, *body.position());
        let spin = start.rotation * (end.rotation.inverse() * body.angvel());
        self.velocity = [body.linvel(), spin];
        let turn = shortest(end.rotation * start.rotation.inverse()).to_scaled_axis();
        let turn = unwrapped(turn, body.angvel() * dt, iterations.max(1) as Real);
        self.motion.linvel = (end * com - start * com) / dt;
        self.motion.angvel = turn / dt;
        self.awake |= self.motion.linvel != Vector::ZERO || self.motion.angvel != Vector::ZERO;
    }

    /// Takes back what forces did to the velocities in the last `share` of rapier's step.
    pub fn undo_forces(&mut self, share: Real) {
        for (now, before) in self.velocity.iter_mut().zip(self.velocity_before) {
            *now += (before - *now) * share;
        }
    }

    /// Motion from `time` on.
    pub fn motion_from(&self, time: Real) -> NonlinearRigidMotion {
        NonlinearRigidMotion {
            start: self.motion.position_at_time(time - self.time),
            ..self.motion
        }
    }

    /// Gives it the motion that takes it to a pose in some seconds, with the whole turns that it makes; by then its
    /// velocities have gained so much.
    pub fn aim(&mut self, end: Pose, gained: [Vector; 2], seconds: Real) {
        let start = self.motion.start;
        let com = self.mass.local_com;
        let turn = shortest(end.rotation * start.rotation.inverse()).to_scaled_axis();
        let turn = unwrapped(turn, self.motion.angvel * seconds, Real::MAX.sqrt());
        self.motion.local_center = com;
        self.motion.linvel = (end * com - start * com) / seconds;
        self.motion.angvel = turn / seconds;
        let carried = end.rotation * (start.rotation.inverse() * self.velocity[1]);
        let spin = self.velocity[1] + gained[1] - carried;
        self.bend = [gained[0] / seconds, spin / seconds];
    }

    /// Moves it to where it is at `time`.
    pub fn advance(&mut self, time: Real) {
        let before = self.motion.start.rotation;
        self.motion = self.motion_from(time);
        self.motion.start.rotation = self.motion.start.rotation.normalize();
        self.velocity[1] = self.motion.start.rotation * (before.inverse() * self.velocity[1]);
        for (velocity, bend) in self.velocity.iter_mut().zip(self.bend) {
            *velocity += bend * (time - self.time);
        }
        self.time = time;
    }
}

/// Linear and angular velocity with which a body starts into a step of `dt` seconds. Of a body that is
/// driven by its position rapier computes them only in its step.
pub fn velocities(body: &RigidBody, dt: Real) -> [Vector; 2] {
    if body.body_type() != RigidBodyType::KinematicPositionBased {
        return [body.linvel(), body.angvel()];
    }
    let (start, end) = (body.position(), body.next_position());
    let com = body.mass_properties().local_mprops.local_com;
    let turn = shortest(end.rotation * start.rotation.inverse());
    [*end * com - *start * com, turn.to_scaled_axis()].map(|moved| moved / dt)
}

/// The same rotation, by no more than half a turn.
pub fn shortest(q: Rotation) -> Rotation {
    if q.w < 0.0 { -q } else { q }
}

/// The turn `turn` plus whole turns, as rapier's integration of `expected` in `n` pieces made it.
fn unwrapped(turn: Vector, expected: Vector, n: Real) -> Vector {
    let asked = expected.length();
    if asked <= MAY_WRAP {
        return turn;
    }
    let made = expected * (n * 2.0 * (asked / (2.0 * n)).atan() / asked);
    let axis = turn.normalize_or_zero();
    if axis == Vector::ZERO {
        // Whole turns only: about the axis expected.
        return made.normalize() * (made.length() / TAU).round() * TAU;
    }
    turn + axis * (((made.dot(axis) - turn.length()) / TAU).round() * TAU)
}

/// A collider in a step.
#[derive(Clone)]
pub struct Part {
    /// Its handle.
    pub handle: ColliderHandle,
    /// Index of its body.
    pub body: usize,
    /// Its shape.
    pub shape: SharedShape,
    /// Pose in the body's frame; in the world's without a body.
    pub offset: Pose,
    /// Its box at the start, world frame.
    pub aabb: Aabb,
    /// Sphere round it, in its own frame.
    pub bound: BoundingSphere,
    /// How thin it is, a length: the radius that nearly all of a medial mesh has, or what rapier's
    /// own test of fast bodies goes by. Infinite for surfaces.
    pub thickness: Real,
    /// How thin its thinnest part is.
    pub least: Real,
    /// How far outside its shape it is solid.
    pub skin: Real,
}

impl Part {
    /// The medial mesh, if it is one.
    pub fn medial(&self) -> Option<&MedialMesh> {
        self.shape.as_shape::<MedialMesh>()
    }
}

/// All bodies and colliders that can meet a medial one in a step.
#[derive(Default)]
pub struct Snapshot {
    /// Bodies; the first stands for no body.
    pub bodies: Vec<Body>,
    /// Colliders that are solid and enabled.
    pub parts: Vec<Part>,
    /// Whether the motions are those that rapier's step made.
    pub followed: bool,
    /// Place of each body in `bodies`.
    pub index: FastMap<RigidBodyHandle, usize>,
}

impl Snapshot {
    /// The world before a step, bodies in the motion that their velocities and forces announce.
    pub fn take(
        gravity: Vector,
        dt: Real,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        (joints, multibodies): (&ImpulseJointSet, &MultibodyJointSet),
    ) -> Self {
        let mut snapshot = Self {
            bodies: vec![Body::ground()],
            parts: Vec::new(),
            followed: false,
            index: FastMap::default(),
        };
        let add = |snapshot: &mut Self, h: RigidBodyHandle| {
            let body = bodies.get(h)?;
            if let Some(known) = snapshot.index.get(&h) {
                return Some(*known);
            }
            let link = multibodies.rigid_body_link(h);
            let multibody = link.and_then(|l| multibodies.get_multibody(l.multibody));
            let mut new = Body::new(h, body, multibody.is_none_or(links::is_free));
            new.predict(body, gravity, dt);
            snapshot.bodies.push(new);
            snapshot.index.insert(h, snapshot.bodies.len() - 1);
            Some(snapshot.bodies.len() - 1)
        };
        for (handle, collider) in enabled(bodies, colliders) {
            if collider.is_sensor() {
                continue;
            }
            let index = collider.parent().and_then(|h| add(&mut snapshot, h));
            snapshot.add_part(handle, collider, index.unwrap_or(0));
        }
        // Joints hand impulses on to bodies without colliders too.
        let tied = joints.iter().flat_map(|(_, j)| [j.body1(), j.body2()]);
        let links = multibodies.multibodies().flat_map(|m| m.links());
        for handle in tied.chain(links.map(|l| l.rigid_body_handle())) {
            add(&mut snapshot, handle);
        }
        snapshot
    }

    fn add_part(&mut self, handle: ColliderHandle, collider: &Collider, index: usize) {
        let offset = match collider.position_wrt_parent() {
            Some(offset) if index != 0 => *offset,
            _ => *collider.position(),
        };
        let body = &mut self.bodies[index];
        let pose = body.motion.start * offset;
        let shape = collider.shared_shape().clone();
        if !pose.is_finite() {
            return;
        }
        let bound = shape.compute_local_bounding_sphere();
        let arm = offset * bound.center() - body.motion.local_center;
        body.reach = body.reach.max(arm.length() + bound.radius());
        let [thickness, least] = match shape.as_shape::<MedialMesh>() {
            Some(mesh) => [mesh.thickness(), mesh.thicknesses().least()],
            None if shape.ccd_thickness() > 0.0 => [shape.ccd_thickness(); 2],
            None => [Real::INFINITY; 2],
        };
        self.parts.push(Part {
            handle,
            body: index,
            offset,
            aabb: shape.compute_aabb(&pose),
            bound,
            shape,
            thickness,
            least,
            skin: collider.contact_skin(),
        });
    }

    /// Replaces the announced motions by those that rapier's step made, of colliders that were in it.
    pub fn follow(
        &mut self,
        parameters: &IntegrationParameters,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) {
        self.followed = true;
        let enabled = |p: &Part| colliders.get(p.handle).is_some_and(Collider::is_enabled);
        self.parts.retain(enabled);
        for body in &mut self.bodies {
            if let Some(b) = body.handle.and_then(|h| bodies.get(h))
                && body.kind != Kind::Fixed
            {
                body.moved(b, parameters.num_solver_iterations, parameters.dt);
            }
        }
    }

    /// Copies of bodies and colliders as they were at the start of the step.
    pub fn world_at_start(
        &self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) -> (RigidBodySet, ColliderSet) {
        let (mut bodies, mut colliders) = (bodies.clone(), colliders.clone());
        for body in &self.bodies {
            if let Some(b) = body.handle.and_then(|h| bodies.get_mut(h)) {
                b.set_position(body.start, false);
                b.set_linvel(body.velocity_before[0], false);
                b.set_angvel(body.velocity_before[1], false);
            }
        }
        for part in &self.parts {
            if let Some(collider) = colliders.get_mut(part.handle)
                && part.body != 0
            {
                collider.set_position(self.bodies[part.body].start * part.offset);
            }
        }
        (bodies, colliders)
    }

    /// Motion of a collider from `time` on.
    pub fn motion(&self, part: usize, time: Real) -> NonlinearRigidMotion {
        let part = &self.parts[part];
        let motion = self.bodies[part.body].motion_from(time);
        NonlinearRigidMotion {
            start: motion.start * part.offset,
            local_center: part.offset.inverse() * motion.local_center,
            ..motion
        }
    }

    /// How thin the thinner of two colliders is as a whole, a length; surfaces do not count.
    pub fn thickness(&self, [i, j]: [usize; 2]) -> Real {
        self.parts[i].thickness.min(self.parts[j].thickness)
    }

    /// How thin the thinner of two colliders is where these primitives of theirs are.
    pub fn thickness_at(&self, pair: [usize; 2], primitives: [u32; 2]) -> Real {
        let of = |k: usize| {
            let part = &self.parts[pair[k]];
            let local = part.medial().map(|mesh| &mesh.thicknesses().primitives);
            let local = local.and_then(|all| all.get(primitives[k] as usize));
            local.copied().unwrap_or(part.thickness)
        };
        of(0).min(of(1))
    }

    /// How thick the thinner of two colliders is that is not medial, a length; infinite where there is
    /// none.
    pub fn foreign_thickness(&self, pair: [usize; 2]) -> Real {
        let parts = pair.map(|k| &self.parts[k]);
        let foreign = parts.into_iter().filter(|p| p.medial().is_none());
        foreign.map(|p| p.thickness).fold(Real::INFINITY, Real::min)
    }

    /// How thin the thinnest collider is as a whole, a length; surfaces do not count.
    pub fn least_thickness(&self) -> Real {
        self.parts
            .iter()
            .map(|p| p.thickness)
            .fold(Real::INFINITY, Real::min)
    }

    /// How thin the thinnest part of any collider is, a length.
    pub fn thinnest_part(&self) -> Real {
        self.parts
            .iter()
            .map(|p| p.least)
            .fold(Real::INFINITY, Real::min)
    }

    /// Bound on how far a point of any collider moves in `seconds`.
    pub fn most_travel(&self, seconds: Real) -> Real {
        let speed = |b: &Body| b.motion.linvel.length() + b.motion.angvel.length() * b.reach;
        self.bodies.iter().map(speed).fold(0.0, Real::max) * seconds
    }

    /// Bound on how far a point of one collider moves relative to the other in `seconds`.
    pub fn travel(&self, [i, j]: [usize; 2], seconds: Real) -> Real {
        let [a, b] = [i, j].map(|k| &self.bodies[self.parts[k].body]);
        let slide = (a.motion.linvel - b.motion.linvel).length();
        let swing = |body: &Body| body.motion.angvel.length() * body.reach;
        (slide + swing(a) + swing(b)) * seconds
    }

    /// Box that holds a collider from `time` to `end` seconds.
    pub fn swept_aabb(&self, part: usize, time: Real, end: Real) -> Aabb {
        let p = &self.parts[part];
        let body = &self.bodies[p.body];
        let still = body.motion.linvel == Vector::ZERO && body.motion.angvel == Vector::ZERO;
        if still && body.time == 0.0 {
            return p.aabb;
        }
        let motion = self.motion(part, time);
        let last = motion.position_at_time(end - time);
        let turn = motion.angvel.length() * (end - time);
        let bound = &p.bound;
        // A body carried along by another turns about that one's centre.
        let reach = (bound.center() - motion.local_center).length() + bound.radius();
        if turn <= SMALL_TURN {
            let sagitta = 0.125 * turn * turn * reach;
            let ends = p.shape.compute_aabb(&motion.start);
            return ends.merged(&p.shape.compute_aabb(&last)).loosened(sagitta);
        }
        let center = |pose: &Pose| *pose * motion.local_center;
        let (c0, c1) = (center(&motion.start), center(&last));
        Aabb::new(c0.min(c1), c0.max(c1)).loosened(reach)
    }
}
