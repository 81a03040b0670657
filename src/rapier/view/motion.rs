//! One body in a step: its pose and velocities before rapier's step, and the rigid motion that the step gave it.
//!
//! rapier turns a body in `n` linearised pieces, so a fast turn ends short of `|ω| dt`. So the motion is taken from the
//! poses before and after, and from the number of full turns in between.

use crate::math::{Pose, Real, Rotation, Vector};
use crate::rapier::view::body_velocity::{forces_per_mass, velocities, velocity};
use crate::rapier::view::link_angles::{LinkAngles, shortest, unwrapped};
use parry3d::mass_properties::MassProperties;
use parry3d::query::NonlinearRigidMotion;
use rapier3d::dynamics::{
    LockedAxes, MultibodyLink, RigidBody, RigidBodyHandle, RigidBodySet, RigidBodyType,
};

/// Turn in a step, in radians, from which the path of a body about a pivot is taken as an arc: an eighth of its square
/// is the share of the radius by which its chord misses it.
const ARC_TURN: Real = 0.1;

/// Whether an impact may move a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mobility {
    /// Never moves.
    Fixed,
    /// Moves, and nothing stops it: kinematic bodies, and links of multibodies of which a joint is kinematic or
    /// coupled to another.
    Driven,
    /// Dynamic.
    Free,
}

/// How joints bend the path of a body, of which its motion is a chord.
#[derive(Clone, Copy, Debug)]
struct Bend {
    /// Change of its velocities by joints, per second.
    rate: [Vector; 2],
    /// Seconds into the step until which they do.
    until: Real,
    /// Linear and angular velocity less the tangent of the path; `None` where joints change the velocities only, and
    /// not the path.
    excess: Option<[Vector; 2]>,
}

/// A body in a step.
#[derive(Clone, Debug)]
pub struct Body {
    /// Body of rapier; `None` for the implicit static body.
    pub handle: Option<RigidBodyHandle>,
    /// Whether an impact may move it.
    pub mobility: Mobility,
    /// Took part in rapier's step.
    pub awake: bool,
    /// Motion from [`Self::time`] on, world frame, per second.
    pub motion: NonlinearRigidMotion,
    /// Seconds into the step at which `motion` starts.
    pub time: Real,
    /// Pose at the start of the step.
    pub start: Pose,
    /// Pose at the end of rapier's step.
    pub end: Pose,
    /// Linear and angular velocity that the solver works with, per second. The angular velocity turns with
    /// the body: where the step turns it about another axis, one fixed in the world would change its energy.
    pub velocity: [Vector; 2],
    /// How joints bend its path.
    bend: Option<Bend>,
    /// Whether its motion is the one that rapier's step made, and its velocities are those at its end.
    pub is_rapiers: bool,
    /// The velocities before rapier's step.
    pub velocity_before: [Vector; 2],
    /// Linear velocity that gravity and forces of the user give it in the whole step.
    pub(super) pull: Vector,
    /// Part of [`Self::pull`] taken back for times in which the body gets nowhere.
    taken_back: Vector,
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
    /// Angular speed of the fastest link of its multibody before rapier's step, rad/s; 0 of a body of none.
    pub link_spin: Real,
    /// Linear and angular velocity after rapier's step by the joints of its multibody, where they hold and not those of
    /// rapier's body.
    pub by_joints: Option<[Vector; 2]>,
    /// Whether a joint holds it.
    pub jointed: bool,
    /// The point, in its frame, at which a joint holds it to what no impact moves; it turns about it.
    pub pivot: Option<Vector>,
    /// Angles of a link of a multibody before rapier's step.
    pub turned_before: Option<LinkAngles>,
    /// Whether rapier's step is taken back from it.
    pub is_taken_back: bool,
}

impl Body {
    /// A body at the start of a step; `is_free`: where it is dynamic, an impact may move it.
    pub fn new(handle: RigidBodyHandle, body: &RigidBody, is_free: bool) -> Self {
        let mobility = match (body.is_fixed(), body.is_dynamic() && is_free) {
            (true, _) => Mobility::Fixed,
            (false, true) => Mobility::Free,
            (false, false) => Mobility::Driven,
        };
        let properties = body.mass_properties();
        let velocity = velocity(body);
        Self {
            handle: Some(handle),
            mobility,
            awake: mobility != Mobility::Fixed && !body.is_sleeping(),
            motion: NonlinearRigidMotion {
                local_center: properties.local_mprops.local_com,
                ..NonlinearRigidMotion::constant_position(*body.position())
            },
            time: 0.0,
            start: *body.position(),
            end: *body.position(),
            velocity,
            bend: None,
            is_rapiers: true,
            velocity_before: velocity,
            pull: Vector::ZERO,
            taken_back: Vector::ZERO,
            reach: 0.0,
            mass: properties.local_mprops,
            inverse_mass: properties.effective_inv_mass,
            locked: properties.flags,
            dominance: body.effective_dominance_group(),
            link_spin: 0.0,
            by_joints: None,
            jointed: false,
            pivot: None,
            turned_before: None,
            is_taken_back: false,
        }
    }

    /// How far a link that goes on from this body's motion has turned: at the end of rapier's step, or at its start, if
    /// the step was taken back.
    pub fn turned(&self, link: &MultibodyLink) -> LinkAngles {
        match self.turned_before {
            Some(before) if self.is_taken_back => before,
            _ => LinkAngles::of(link),
        }
    }

    /// The implicit static body, which carries the colliders without a body.
    pub fn ground() -> Self {
        Self {
            handle: None,
            mobility: Mobility::Fixed,
            awake: false,
            motion: NonlinearRigidMotion::identity(),
            time: 0.0,
            start: Pose::IDENTITY,
            end: Pose::IDENTITY,
            velocity: [Vector::ZERO; 2],
            bend: None,
            is_rapiers: true,
            velocity_before: [Vector::ZERO; 2],
            pull: Vector::ZERO,
            taken_back: Vector::ZERO,
            reach: 0.0,
            mass: MassProperties::default(),
            inverse_mass: Vector::ZERO,
            locked: LockedAxes::empty(),
            dominance: i16::from(i8::MAX) + 1,
            link_spin: 0.0,
            by_joints: None,
            jointed: false,
            pivot: None,
            turned_before: None,
            is_taken_back: false,
        }
    }

    /// Velocity with which the solver starts, before contacts: gravity and forces of the user.
    pub fn predict(&mut self, body: &RigidBody, gravity: Vector, dt: Real) {
        if self.mobility == Mobility::Fixed || !self.awake {
            return;
        }
        [self.motion.linvel, self.motion.angvel] = velocities(body, dt);
        if body.is_dynamic() {
            self.pull = forces_per_mass(body, gravity) * dt;
            self.motion.linvel += self.pull;
        }
    }

    /// The motion that took it to where it is after rapier's step.
    pub fn moved(&mut self, body: &RigidBody, iterations: usize, dt: Real) {
        let [linear, angular] = self.by_joints.unwrap_or_else(|| velocity(body));
        // rapier computes the mass of a body that is new in this step only now.
        let properties = body.mass_properties();
        let com = properties.local_mprops.local_com;
        self.reach += (com - self.mass.local_com).length();
        self.mass = properties.local_mprops;
        self.inverse_mass = properties.effective_inv_mass;
        self.locked = properties.flags;
        self.dominance = body.effective_dominance_group();
        let (start, end) = (self.motion.start, *body.position());
        self.end = end;
        let spin = start.rotation * (end.rotation.inverse() * angular);
        self.velocity = [linear, spin];
        let turn = shortest(end.rotation * start.rotation.inverse()).to_scaled_axis();
        let turn = unwrapped(turn, angular * dt, iterations.max(1) as Real);
        // The path of a centre that goes round a pivot is an arc, of which rapier's step tells the chord.
        let is_arc = turn.length() > ARC_TURN;
        let center = self.pivot.filter(|_| is_arc).unwrap_or(com);
        self.reach += (center - com).length();
        self.motion.local_center = center;
        self.motion.linvel = (end * center - start * center) / dt;
        self.motion.angvel = turn / dt;
        self.awake |= self.motion.linvel != Vector::ZERO || self.motion.angvel != Vector::ZERO;
    }

    /// Linear velocity that gravity and forces of the user give it in the whole step.
    pub fn pull(&self) -> Vector {
        self.pull
    }

    /// Takes back rapier's step but for what gravity and forces gave it.
    pub fn take_back(&mut self) {
        self.velocity = self.velocity_before;
        self.velocity[0] += self.pull;
        self.end = self.start;
        self.go(self.velocity);
        self.is_taken_back = true;
    }

    /// Takes back what forces did to the velocities in the last `share` of rapier's step.
    pub fn undo_forces(&mut self, share: Real) {
        for (now, before) in self.velocity.iter_mut().zip(self.velocity_before) {
            *now += (before - *now) * share;
        }
    }

    /// Linear velocity that gravity and forces of the user give it in the last `share` of the step, but for what was
    /// taken back of it.
    pub fn gains(&self, share: Real) -> Vector {
        self.pull * share - self.taken_back
    }

    /// Changes its velocities so that it loses what forces give it.
    pub fn lose_gains(&mut self, [linear, angular]: [Vector; 2]) {
        self.velocity[0] += linear;
        self.velocity[1] += angular;
        self.taken_back -= linear;
    }

    /// Stops it for the last `share` of the step: it gains no speed by forces in a time in which it gets nowhere. The
    /// part that contacts took already is not taken twice.
    pub fn hold(&mut self, share: Real) {
        let along = self.pull.normalize_or_zero();
        let length = self.gains(share).dot(along).max(0.0);
        let gained = self.velocity[0].dot(along).clamp(0.0, length);
        self.velocity[0] -= along * gained;
        self.taken_back += along * length;
        self.motion = NonlinearRigidMotion::constant_position(self.motion.start);
        self.bend = None;
    }

    /// Lets it be carried along by a motion, as if it were part of that body.
    pub fn follow(&mut self, carrying: &NonlinearRigidMotion) {
        let center = carrying.start * carrying.local_center;
        self.bend = None;
        self.motion = NonlinearRigidMotion {
            local_center: self.motion.start.inverse_transform_point(center),
            linvel: carrying.linvel,
            angvel: carrying.angvel,
            ..self.motion
        };
    }

    /// Motion from `time` on; at its own time it starts where the body is, to the bit.
    pub fn motion_from(&self, time: Real) -> NonlinearRigidMotion {
        if time == self.time {
            return self.motion;
        }
        NonlinearRigidMotion {
            start: self.motion.position_at_time(time - self.time),
            ..self.motion
        }
    }

    /// Linear velocity of its centre of mass at `time`, where it is advanced to, and angular velocity: of its path,
    /// where that is bent.
    pub fn twist(&self, time: Real) -> [Vector; 2] {
        let bend = self.bend.filter(|_| self.time == time);
        if let Some(excess) = bend.and_then(|bend| bend.excess) {
            return [0, 1].map(|i| self.velocity[i] - excess[i]);
        }
        let m = self.motion_from(time);
        // A body that is carried along turns about another's centre.
        let arm = m.start.rotation * (self.mass.local_com - m.local_center);
        [m.linvel + m.angvel.cross(arm), m.angvel]
    }

    /// Sets the motion that takes its centre of mass by `way` and turns it by `turn`, and whole turns as before, in
    /// `seconds`. `tangent`: velocities of its path now; `gained`: change of its velocities by joints until then.
    pub fn aim(
        &mut self,
        (way, turn): (Vector, Rotation),
        [tangent, gained]: [[Vector; 2]; 2],
        seconds: Real,
    ) {
        let turned = shortest(turn).to_scaled_axis();
        let turned = unwrapped(turned, self.motion.angvel * seconds, Real::MAX.sqrt());
        self.motion.local_center = self.mass.local_com;
        self.motion.linvel = way / seconds;
        self.motion.angvel = turned / seconds;
        let spin = self.velocity[1] + gained[1] - turn * self.velocity[1];
        self.bend = Some(Bend {
            rate: [gained[0] / seconds, spin / seconds],
            until: self.time + seconds,
            excess: Some([0, 1].map(|i| self.velocity[i] - tangent[i])),
        });
        self.is_rapiers = false;
    }

    /// Keeps its path, while joints change its velocities by `gained` in `seconds`.
    pub fn gain(&mut self, gained: [Vector; 2], seconds: Real) {
        self.bend = Some(Bend {
            rate: gained.map(|gained| gained / seconds),
            until: self.time + seconds,
            excess: None,
        });
    }

    /// Ends what joints add to the velocities of a body that they leave on its path.
    pub fn gain_no_more(&mut self) {
        self.bend = self.bend.filter(|bend| bend.excess.is_some());
    }

    /// Gives it a motion along these velocities.
    pub fn go(&mut self, [linear, angular]: [Vector; 2]) {
        self.motion.local_center = self.mass.local_com;
        self.motion.linvel = linear;
        self.motion.angvel = angular;
        self.bend = None;
        self.is_rapiers = false;
    }

    /// Moves it to where it is at `time`.
    pub fn advance(&mut self, time: Real) {
        let before = self.motion.start.rotation;
        self.motion = self.motion_from(time);
        self.motion.start.rotation = self.motion.start.rotation.normalize();
        self.velocity[1] = self.motion.start.rotation * (before.inverse() * self.velocity[1]);
        if let Some(bend) = self.bend {
            let seconds = (time.min(bend.until) - self.time).max(0.0);
            for (velocity, rate) in self.velocity.iter_mut().zip(bend.rate) {
                *velocity += rate * seconds;
            }
            if time > bend.until {
                self.bend = None;
            }
        }
        self.time = time;
    }

    /// Gives rapier's body the pose of this one, and where it was `struck` the velocities.
    pub fn write_back(&self, struck: bool, bodies: &mut RigidBodySet) {
        let Some(body) = self.handle.and_then(|h| bodies.get_mut(h)) else {
            return;
        };
        if !self.motion.start.is_finite() {
            return;
        }
        // An awake body keeps its time of being slow, so that pressed bodies that are struck in each step fall asleep.
        let wakes = struck && body.is_sleeping();
        let end = *body.position();
        body.set_position(self.motion.start, wakes);
        if body.body_type() == RigidBodyType::KinematicPositionBased {
            // Where it was going, it still is.
            body.set_next_kinematic_position(end);
        }
        if struck {
            body.set_linvel(self.velocity[0], wakes);
            body.set_angvel(self.velocity[1], wakes);
        }
    }
}
