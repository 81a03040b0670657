//! Joints in an impact within the step: bodies that they hold together take the impulse together, at once.
//!
//! An impulse on one body of a chain moves all of them ([`crate::rapier::joints::tied_system`]). After it, bodies do
//! not move along their velocities, which would open the joints, but to where the joints let them. As a body that turns
//! about a hinge moves along an arc, this is done in pieces of the step. Impulse joints and joints of multibodies are
//! treated the same. Where a joint would pass a limit in a piece, it stops there ([`crate::rapier::joints::limits`]).
//! Motors act in rapier's next step, and joints that the user made soft are left to it.

use crate::math::Real;
use crate::math::fast_hash::{FastMap, FastSet};
use crate::rapier::joints::limits::Limit;
use crate::rapier::joints::rows::{Joint, Twist};
use crate::rapier::joints::tied_system::System;
use crate::rapier::view::inertia::Inertia;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::{MOST_JOINTS, StepView};
use rapier3d::dynamics::{
    GenericJoint, ImpulseJointSet, JointEnabled, MultibodyJointSet, RigidBodyHandle,
    SpringCoefficients,
};

/// Turn of the fastest body, in radians, in one piece of its motion.
const PIECE_TURN: Real = 0.125;

/// The most pieces of a step if nothing else is met.
const MOST_PIECES: Real = 64.0;

/// Opening that joints may gain, in units of rapier's length unit or in radians, from which they count as not closed:
/// what is this far off says nothing of where bodies go, which then go straight, and rapier's next step closes the
/// joints.
const UNCLOSED: f64 = 1.0e-2;

/// Result of closing joints: the bodies moved, and until when.
#[derive(Default)]
pub struct MotionPiece {
    /// Bodies whose motion it changed.
    pub moved: Vec<usize>,
    /// Seconds into the step at which their motion ends, if before the step.
    pub until: Option<Real>,
}

/// The joints of a world.
#[derive(Default)]
pub struct Joints {
    all: Vec<Joint>,
    of_body: FastMap<usize, Vec<usize>>,
}

impl Joints {
    /// The joints between bodies of a view.
    pub fn new(
        view: &StepView,
        impulse_joints: &ImpulseJointSet,
        multibody_joints: &MultibodyJointSet,
    ) -> Self {
        let mut joints = Self::default();
        for (_, joint) in impulse_joints.iter() {
            let rigid = joint.data.softness == SpringCoefficients::joint_defaults();
            if rigid && joint.data.enabled == JointEnabled::Enabled {
                let limits = Limit::of_joint(&joint.data);
                joints.add(view, [joint.body1(), joint.body2()], &joint.data, limits);
            }
        }
        for multibody in multibody_joints.multibodies() {
            for link in multibody.links() {
                if let Some(parent) = link.parent_id().and_then(|id| multibody.link(id)) {
                    let bodies = [parent.rigid_body_handle(), link.rigid_body_handle()];
                    let Some(b) = view.index.get(&bodies[1]) else {
                        continue;
                    };
                    let turned = view.bodies[*b].turned(link);
                    let limits = Limit::of_link(link, &turned);
                    joints.add(view, bodies, &link.joint.data, limits);
                }
            }
        }
        joints
    }

    fn add(
        &mut self,
        view: &StepView,
        bodies: [RigidBodyHandle; 2],
        joint: &GenericJoint,
        limits: Vec<Limit>,
    ) {
        let [Some(&a), Some(&b)] = bodies.map(|h| view.index.get(&h)) else {
            return;
        };
        for body in [a, b] {
            self.of_body.entry(body).or_default().push(self.all.len());
        }
        self.all.push(Joint {
            bodies: [a, b],
            frames: [joint.local_frame1, joint.local_frame2],
            locked: joint.locked_axes.bits(),
            limits,
        });
    }

    /// The free bodies that joints tie to some bodies, these first, and the joints between them.
    fn tied(&self, view: &StepView, from: &[usize]) -> (Vec<usize>, Vec<&Joint>) {
        let (mut bodies, mut joints) = (from.to_vec(), Vec::new());
        let mut found: FastSet<usize> = from.iter().copied().collect();
        let mut used = FastSet::default();
        let mut next = 0;
        while next < bodies.len() {
            let body = bodies[next];
            next += 1;
            if view.bodies[body].mobility != Mobility::Free {
                continue;
            }
            for &j in self.of_body.get(&body).into_iter().flatten() {
                if joints.len() < MOST_JOINTS && used.insert(j) {
                    joints.push(&self.all[j]);
                    let far = self.all[j].bodies.into_iter().find(|b| *b != body);
                    bodies.extend(far.filter(|b| found.insert(*b)));
                }
            }
        }
        (bodies, joints)
    }

    /// The system that moves when some bodies are struck at `time`, with the inertia of each.
    pub fn system(
        &self,
        view: &StepView,
        from: &[usize],
        time: Real,
        inertia: impl Fn(usize) -> Inertia,
    ) -> System<'_> {
        let (bodies, joints) = self.tied(view, from);
        let inertias = bodies.iter().map(|b| inertia(*b)).collect();
        System::new(view, time, (bodies, inertias), joints)
    }

    /// All bodies that joints tie to some bodies, these first.
    pub fn tied_to(&self, view: &StepView, from: &[usize]) -> Vec<usize> {
        self.tied(view, from).0
    }

    /// Whether a body hangs by joints on one that is driven.
    pub fn hangs_on_driven(&self, view: &StepView, body: usize) -> bool {
        let mut tied = self.tied(view, &[body]).0.into_iter().skip(1);
        tied.any(|b| view.bodies[b].mobility == Mobility::Driven)
    }

    /// Moves a body and all bodies that joints tie to it along paths on which the joints stay as closed as they are,
    /// from `time` (seconds into the step) on, and changes their velocities to match, without a gain of energy of all
    /// together. At the end of the step, `dt`, joints are to be as open as rapier's step left them. `frozen`: whether a
    /// body keeps its path; the joints then change its velocity for the next step only. `is_next_piece`: a piece of the
    /// motion has ended, and nothing was struck. Moves nothing where the joints cannot be closed to [`UNCLOSED`].
    pub fn close(
        &self,
        view: &mut StepView,
        from: usize,
        [time, dt]: [Real; 2],
        is_next_piece: bool,
        frozen: impl Fn(usize) -> bool,
    ) -> MotionPiece {
        if !self.of_body.contains_key(&from) || time >= dt {
            return MotionPiece::default();
        }
        let inertia = |view: &StepView, b: usize| {
            let body = &view.bodies[b];
            if body.mobility == Mobility::Free && !frozen(b) {
                Inertia::of(body)
            } else {
                Inertia::INFINITE
            }
        };
        let mut system = self.system(view, &[from], time, |b| inertia(view, b));
        for &b in &system.bodies {
            if view.bodies[b].mobility == Mobility::Free {
                view.bodies[b].advance(time);
            }
        }
        let twist = |b: &usize| view.bodies[*b].twist(time);
        let mut before: Vec<Twist> = system.bodies.iter().map(twist).collect();
        if is_next_piece {
            // The velocities so far are along a chord; those along the tangent start the next one.
            system.hold(&mut before);
        }
        let rest = dt - time;
        let fastest = before.iter().map(|t| t[1].length()).fold(0.0, Real::max);
        let piece = (PIECE_TURN / fastest).max(dt / MOST_PIECES);
        let until = (piece < 0.75 * rest).then_some(time + piece);
        let seconds = if until.is_some() { piece } else { rest };
        let share = f64::from(seconds / rest);
        let openings = system
            .openings()
            .into_iter()
            .zip(system.openings_in_the_end(view));
        let locked: Vec<f64> = openings
            .map(|(now, end)| now + (end - now) * share)
            .collect();
        let mut targets = locked.clone();
        targets.extend(system.stop_at_limits(&before, seconds));
        let stops = targets.len() > locked.len();
        let mut after = system.integrate(&before, seconds, &targets);
        if stops && system.left_open(&targets).1 > UNCLOSED {
            // Joints pass limits rather than open.
            system = self.system(view, &[from], time, |b| inertia(view, b));
            after = system.integrate(&before, seconds, &locked);
            targets = locked;
        }
        if system.left_open(&targets).1 > UNCLOSED {
            return MotionPiece::default();
        }
        let own: Vec<Twist> = system
            .bodies
            .iter()
            .map(|b| view.bodies[*b].velocity)
            .collect();
        let end = match system.bodies.iter().any(|b| frozen(*b)) {
            true => self.without_path(view, from, time, &system, &own),
            false => followed(&system, &own, [&before, &after], until.is_none()),
        };
        let mut moved = Vec::new();
        for (k, &b) in system.bodies.iter().enumerate() {
            let gained = [0, 1].map(|i| end[k][i] - own[k][i]);
            if !system.is_infinite(k) {
                view.bodies[b].aim(system.moved(k), [before[k], gained], seconds);
                moved.push(b);
            } else if view.bodies[b].mobility == Mobility::Free {
                view.bodies[b].gain(gained, seconds);
            }
        }
        MotionPiece { moved, until }
    }

    /// Velocities at the end of a piece of the bodies tied to `from`, where one of them is frozen and so blocks the
    /// path of `moved`: their own, less what joints forbid at the end poses of `moved`. A frozen body has its own
    /// inertia here, as in the next step, so that both bodies of a joint go by the same velocities.
    fn without_path(
        &self,
        view: &StepView,
        from: usize,
        time: Real,
        moved: &System,
        own: &[Twist],
    ) -> Vec<Twist> {
        let inertia = |b: usize| match view.bodies[b].mobility {
            Mobility::Free => Inertia::of(&view.bodies[b]),
            Mobility::Fixed | Mobility::Driven => Inertia::INFINITE,
        };
        let whole = self.system(view, &[from], time, inertia).moved_as(moved);
        let mut end = own.to_vec();
        whole.hold(&mut end);
        whole.take_no_energy(own, &mut end);
        end
    }
}

/// Replaces the velocities and motions of the bodies of a system at `time` by the nearest that their joints allow.
/// Until then a motion is the chord of a bent path, and an impact needs the tangent. `moving`: the system for the
/// motions, where some bodies keep theirs; `last`: the velocities that joints allow at the end of rapier's step.
pub fn settle(
    view: &mut StepView,
    time: Real,
    system: &System,
    moving: Option<&System>,
    last: impl Fn(&StepView) -> Vec<Twist>,
) {
    if !system.holds() {
        return;
    }
    let bodies = || system.bodies.iter().map(|b| &view.bodies[*b]);
    let mut tangents: Vec<Twist> = bodies().map(|b| b.twist(time)).collect();
    let mut velocities: Vec<Twist> = bodies().map(|b| b.velocity).collect();
    let as_rapier_left_it =
        |k: usize| view.bodies[system.bodies[k]].is_rapiers && !system.is_infinite(k);
    if (0..system.bodies.len()).any(as_rapier_left_it) {
        let mut held = tangents.clone();
        system.hold(&mut held);
        for (k, end) in last(view).into_iter().enumerate() {
            let body = &view.bodies[system.bodies[k]];
            if as_rapier_left_it(k) {
                let back = body.motion.start.rotation * body.end.rotation.inverse();
                velocities[k][0] += held[k][0] - end[0];
                velocities[k][1] += held[k][1] - back * end[1];
            }
        }
    }
    moving.unwrap_or(system).hold(&mut tangents);
    system.hold(&mut velocities);
    for (k, &b) in system.bodies.iter().enumerate() {
        let body = &mut view.bodies[b];
        if !system.is_infinite(k) {
            body.velocity = velocities[k];
        }
        match moving.unwrap_or(system).is_infinite(k) {
            true => body.gain_no_more(),
            false => body.go(tangents[k]),
        }
    }
}

/// Velocities that follow motions which joints changed from `before` to `after`, and gain no energy by that. `is_last`:
/// these motions go to the end of the step.
fn followed(
    system: &System,
    own: &[Twist],
    [before, after]: [&[Twist]; 2],
    is_last: bool,
) -> Vec<Twist> {
    let end = |k: usize| [0, 1].map(|i| own[k][i] + after[k][i] - before[k][i]);
    let mut end: Vec<Twist> = (0..own.len()).map(end).collect();
    if is_last {
        // A multibody has no velocities but those of its coordinates.
        system.hold(&mut end);
    }
    system.take_no_energy(own, &mut end);
    end
}
