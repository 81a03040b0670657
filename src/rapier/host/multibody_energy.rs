//! Multibodies that turn fast: rapier's step has them gain energy, until their velocities leave the range of floats.
//!
//! It integrates with the mass matrix of each sub-step's start, and solves contacts with the Jacobian of the step's
//! start, however far links turn. So where a multibody of medial links, with what pushed it, has a tenth more energy
//! after rapier's step than it had before and its forces gave it, its motion is taken back: joints take it through the
//! step from its start, which gains none ([`crate::rapier::joints::jointed_bodies`]), less what damping takes. One that
//! turns so fast that it is unstable ([`UNSTABLE_TURN`]) is at rest for rapier's step, and what it touches is the event
//! loop's ([`crate::rapier::contacts::muting`]).
//!
//! Multibodies with motors or springs, those that other joints hold, and those that bear on what is held or pushed by
//! others are left to rapier.

use crate::math::{Real, Rotation, Vector};
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::inertia::Inertia;
use crate::rapier::view::link_velocity::FAST_LINK_TURN;
use crate::rapier::view::motion::{Body, Mobility};
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::{
    Multibody, MultibodyIndex, MultibodyJointSet, MultibodyLink, RigidBody, RigidBodyHandle,
};
use rapier3d::geometry::{ColliderHandle, NarrowPhase};

/// Rotation of the fastest link in a step, in radians, above which a multibody is at rest for rapier's step, and joints
/// alone move it: the velocities of faster ones may leave the range of floats within the step, and then nothing is left
/// to take back.
const UNSTABLE_TURN: Real = 4.0;

/// Share of its energy that a multibody may gain in rapier's step. Free ones gain and lose some hundredths by turns;
/// taking back the gains alone would leave the losses.
const MAX_ENERGY_GAIN: f64 = 0.1;

/// Multibodies that turn fast in a step, and that nothing drives.
#[derive(Default)]
pub struct FastMultibodies(Vec<FastMultibody>);

/// A multibody whose fastest link turns by more than [`FAST_LINK_TURN`] in this step.
struct FastMultibody {
    handle: MultibodyIndex,
    /// Free links, in the view.
    links: Vec<usize>,
    /// Whether it is at rest for rapier's step.
    is_at_rest: bool,
}

/// Whether a body is of a multibody whose fastest link turns by more than [`UNSTABLE_TURN`] in a step of `dt` seconds.
pub fn is_unstable(body: &Body, dt: Real) -> bool {
    body.link_spin * dt > UNSTABLE_TURN
}

impl FastMultibodies {
    /// The fast multibodies of a world before rapier's step.
    pub fn find(view: &StepView, rules: &Rules, narrow_phase: &NarrowPhase, dt: Real) -> Self {
        let multibodies = rules.multibody_joints;
        let mut found: Vec<FastMultibody> = Vec::new();
        for (b, body) in view.bodies.iter().enumerate() {
            let link = body.handle.filter(|_| body.link_spin * dt > FAST_LINK_TURN);
            let link = link.and_then(|h| multibodies.rigid_body_link(h));
            let Some(handle) = link.map(|l| l.multibody) else {
                continue;
            };
            if body.mobility != Mobility::Free {
                continue;
            }
            match found.iter_mut().find(|w| w.handle == handle) {
                Some(fast) => fast.links.push(b),
                None => found.push(FastMultibody {
                    handle,
                    links: vec![b],
                    is_at_rest: is_unstable(body, dt),
                }),
            }
        }
        found.retain(|fast| {
            let medial = |links: &[usize]| {
                let mut parts = view.colliders.iter();
                parts.any(|p| p.medial().is_some() && links.contains(&p.body))
            };
            let multibody = multibodies.get_multibody(fast.handle);
            medial(&fast.links) && multibody.is_some_and(|m| is_left_alone(m, rules))
        });
        for fast in &mut found {
            fast.is_at_rest &= partners(view, (rules, narrow_phase), &fast.links).is_some();
        }
        Self(found)
    }

    /// Sets the unstable ones at rest for rapier's step.
    pub fn bring_to_rest(&self, multibodies: &mut MultibodyJointSet) {
        for fast in self.0.iter().filter(|w| w.is_at_rest) {
            if let Some(multibody) = multibodies.get_multibody_mut(fast.handle) {
                multibody.generalized_velocity_mut().fill(0.0);
            }
        }
    }

    /// Whether rapier's step has a body at rest.
    pub fn rests(&self, body: usize) -> bool {
        self.0
            .iter()
            .any(|w| w.is_at_rest && w.links.contains(&body))
    }

    /// Takes back what rapier's step did with those that gained energy, and with what pushed them.
    pub fn take_back(
        self,
        view: &mut StepView,
        rules: &Rules,
        narrow_phase: &NarrowPhase,
        dt: Real,
    ) {
        for fast in self.0 {
            let Some(multibody) = rules.multibody_joints.get_multibody(fast.handle) else {
                continue;
            };
            let mut bodies = fast.links;
            if !fast.is_at_rest {
                let Some(partners) = partners(view, (rules, narrow_phase), &bodies) else {
                    continue;
                };
                bodies.extend(partners);
                if gained(view, &bodies) <= MAX_ENERGY_GAIN {
                    continue;
                }
            }
            for &b in &bodies {
                view.bodies[b].take_back();
            }
            damp(view, multibody, dt);
        }
    }
}

/// Whether nothing but gravity, forces and contacts works on a multibody.
fn is_left_alone(multibody: &Multibody, rules: &Rules) -> bool {
    let is_free = |link: &MultibodyLink| {
        let handle = link.rigid_body_handle();
        let driven = !link.joint.data.motor_axes.is_empty()
            || (0..6).any(|axis| link.joint.spring(axis).0 != 0.0);
        let driven_body = |b: &RigidBody| b.user_torque() != Vector::ZERO || b.is_kinematic();
        !driven
            && !rules.bodies.get(handle).is_some_and(driven_body)
            && rules
                .impulse_joints
                .attached_joints(handle)
                .next()
                .is_none()
    };
    multibody.links().all(is_free)
}

/// The bodies that pushed some links in rapier's last step; `None` if any of these is held or pushed by another.
fn partners(
    view: &StepView,
    (rules, narrow_phase): (&Rules, &NarrowPhase),
    links: &[usize],
) -> Option<Vec<usize>> {
    let place = |h: ColliderHandle| {
        let body = rules.colliders.get(h)?.parent()?;
        view.index.get(&body).copied()
    };
    let pushing = |b: usize| {
        let parts = view.colliders.iter().filter(move |p| p.body == b);
        let pairs = parts.flat_map(|p| narrow_phase.contact_pairs_with(p.handle));
        let pairs = pairs.filter(|pair| pair.total_impulse_magnitude() > 0.0);
        pairs.flat_map(|pair| [place(pair.collider1), place(pair.collider2)])
    };
    let is_loose = |h: RigidBodyHandle| {
        rules.impulse_joints.attached_joints(h).next().is_none()
            && rules.multibody_joints.rigid_body_link(h).is_none()
    };
    let is_free = |b: usize| {
        let body = &view.bodies[b];
        body.mobility == Mobility::Free && body.handle.is_some_and(is_loose)
    };
    let mut partners = Vec::new();
    for other in links.iter().flat_map(|b| pushing(*b)) {
        let other = other?;
        if !links.contains(&other) && !partners.contains(&other) {
            partners.push(other);
        }
    }
    let known = |b: &Option<usize>| b.is_some_and(|b| links.contains(&b) || partners.contains(&b));
    let alone = |b: usize| is_free(b) && pushing(b).all(|other| known(&other));
    partners.iter().all(|b| alone(*b)).then_some(partners)
}

/// Share of their energy that bodies gained in rapier's step beyond what forces gave them.
fn gained(view: &StepView, bodies: &[usize]) -> f64 {
    let (mut had, mut has) = (0.0, 0.0);
    for body in bodies.iter().map(|b| &view.bodies[*b]) {
        let inertia = Inertia::of(body);
        let work = (inertia.masses() * body.pull()).dot(body.twist(0.0)[0]);
        had += inertia.energy(body.velocity_before) + f64::from(work);
        has += inertia.energy(body.velocity);
    }
    let share = has / had.max(f64::MIN_POSITIVE) - 1.0;
    if share.is_nan() { f64::INFINITY } else { share }
}

/// Damps the turns of a multibody's joints for the length of a step, one after the other, each implicitly: rapier gives
/// all of them a little damping.
fn damp(view: &mut StepView, multibody: &Multibody, dt: Real) {
    let mut damping = multibody.damping().iter().copied();
    for link in multibody.links() {
        let place = |l: &MultibodyLink| view.index.get(&l.rigid_body_handle()).copied();
        let parent = link.parent_id().and_then(|id| multibody.link(id));
        let ends = [(parent.and_then(place), -1.0), (place(link), 1.0)];
        let ends: Vec<(usize, Real)> = ends
            .into_iter()
            .filter_map(|(b, sign)| Some((b?, sign)))
            .collect();
        let data = &link.joint.data;
        let base = match parent.and_then(place) {
            Some(parent) => view.bodies[parent].start.rotation,
            None => Rotation::IDENTITY,
        };
        for axis in (0..6).filter(|i| data.locked_axes.bits() & (1 << i) == 0) {
            let damping = damping.next().unwrap_or(0.0) * dt;
            if axis < 3 {
                continue;
            }
            let axis = base * data.local_frame1.rotation * Vector::AXES[axis - 3];
            let turned = |body: &Body, torque: Vector| {
                let inertia = if body.mobility == Mobility::Free {
                    Inertia::of(body)
                } else {
                    Inertia::INFINITE
                };
                inertia.apply([Vector::ZERO, torque])[1]
            };
            let (mut speed, mut response) = (0.0, 0.0);
            for &(b, sign) in &ends {
                let body = &view.bodies[b];
                speed += sign * body.velocity[1].dot(axis);
                response += turned(body, axis).dot(axis);
            }
            let torque = axis * (-speed * damping / (1.0 + damping * response));
            for &(b, sign) in &ends {
                let body = &mut view.bodies[b];
                let change = turned(body, torque) * sign;
                body.velocity[1] += change;
                if body.mobility == Mobility::Free {
                    body.go(body.velocity);
                }
            }
        }
    }
}
