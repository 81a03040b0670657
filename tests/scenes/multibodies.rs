//! Chains and ragdolls of medial links, struck within a step: against rapier's capsules of the same sizes in
//! sub-steps of 1/2,000 s, where rapier's own contacts and joints are nearly exact.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of links and rod, metres.
pub const RADIUS: Real = 0.05;

/// A link's half length between the centres of its ends, metres.
pub const HALF: Real = 0.2;

/// What is struck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Struck {
    /// A bar on a hinge.
    Hinge,
    /// Four bars on ball joints, the first on a fixed body.
    Chain,
    /// A trunk with two arms and two legs of two bars each, free.
    Ragdoll,
}

/// How its joints are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum By {
    Multibody,
    ImpulseJoints,
}

/// A capsule along an axis, medial or rapier's own.
pub fn bar(medial: bool, axis: Vector, half: Real) -> ColliderBuilder {
    let end = axis * half;
    let collider = if medial {
        let ends = [-end, end].map(|c| MedialSphere::new(c, RADIUS));
        let mesh = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a bar");
        ColliderBuilder::medial_mesh(mesh)
    } else {
        ColliderBuilder::capsule_from_endpoints(-end, end, RADIUS)
    };
    collider.friction(0.0).density(1000.0)
}

pub struct Scene {
    world: PhysicsWorld,
    links: Vec<RigidBodyHandle>,
    /// Long axes of the links in their own frames.
    axes: Vec<Vector>,
    rod: RigidBodyHandle,
    /// Bodies and anchors of each joint.
    joints: Vec<([RigidBodyHandle; 2], [Vector; 2])>,
}

impl Scene {
    pub fn new(struck: Struck, by: By, medial: bool, speed: Real, phase: Real) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        // The rod comes along Z, across what it strikes.
        let (at, rod) = match struck {
            Struck::Hinge => (0.3, Vector::Y),
            Struck::Chain => (2.3 * 2.0 * HALF, Vector::Y),
            Struck::Ragdoll => (2.0 * HALF + 0.25, Vector::Y),
        };
        let start = -2.0 * RADIUS - speed / 60.0 * (1.0 + phase);
        let height = if struck == Struck::Ragdoll { HALF } else { 0.0 };
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(at, height, start))
            .linvel(Vector::Z * speed);
        let groups =
            InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And);
        let (rod, _) = world.insert(body, bar(medial, rod, HALF).collision_groups(groups));
        world.bodies[rod].set_allow_fast_rotation(true);
        let mut scene = Self {
            world,
            links: Vec::new(),
            axes: Vec::new(),
            rod,
            joints: Vec::new(),
        };
        let x = Vector::X * HALF;
        let y = Vector::Y * HALF;
        match struck {
            Struck::Hinge => {
                let root = scene.world.bodies.insert(RigidBodyBuilder::fixed());
                let link = scene.link(medial, x, Vector::X);
                scene.join(by, [root, link], [Vector::ZERO, -x], true);
            }
            Struck::Chain => {
                let mut last = scene.world.bodies.insert(RigidBodyBuilder::fixed());
                for i in 0..4 {
                    let link = scene.link(medial, x * (2.0 * i as Real + 1.0), Vector::X);
                    let end = if i == 0 { Vector::ZERO } else { x };
                    scene.join(by, [last, link], [end, -x], false);
                    last = link;
                }
            }
            Struck::Ragdoll => {
                let trunk = scene.link(medial, Vector::ZERO, Vector::Y);
                for (up, side) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                    let (shoulder, out) = (y * up, x * side);
                    let upper = scene.link(medial, shoulder + out, Vector::X);
                    scene.join(by, [trunk, upper], [shoulder, -out], false);
                    let lower = scene.link(medial, shoulder + out * 3.0, Vector::X);
                    scene.join(by, [upper, lower], [out, -out], up > 0.0);
                }
            }
        }
        scene
    }

    fn link(&mut self, medial: bool, at: Vector, axis: Vector) -> RigidBodyHandle {
        let body = RigidBodyBuilder::dynamic().translation(at);
        // Links meet the rod only.
        let groups =
            InteractionGroups::new(Group::GROUP_1, Group::GROUP_2, InteractionTestMode::And);
        let collider = bar(medial, axis, HALF).collision_groups(groups);
        let link = self.world.insert(body, collider).0;
        self.world.bodies[link].set_allow_fast_rotation(true);
        self.links.push(link);
        self.axes.push(axis);
        link
    }

    fn join(&mut self, by: By, bodies: [RigidBodyHandle; 2], anchors: [Vector; 2], hinge: bool) {
        let joint: GenericJoint = if hinge {
            let joint = RevoluteJointBuilder::new(Vector::Y).contacts_enabled(false);
            joint
                .local_anchor1(anchors[0])
                .local_anchor2(anchors[1])
                .into()
        } else {
            let joint = SphericalJointBuilder::new().contacts_enabled(false);
            joint
                .local_anchor1(anchors[0])
                .local_anchor2(anchors[1])
                .into()
        };
        match by {
            By::Multibody => {
                let inserted = self
                    .world
                    .insert_multibody_joint(bodies[0], bodies[1], joint);
                assert!(inserted.is_some());
            }
            By::ImpulseJoints => {
                self.world.insert_impulse_joint(bodies[0], bodies[1], joint);
            }
        }
        self.joints.push((bodies, anchors));
    }

    fn widest(&self) -> Real {
        let opening = |(bodies, anchors): &([RigidBodyHandle; 2], [Vector; 2])| {
            let [a, b] = [0, 1].map(|k| self.world.bodies[bodies[k]].position() * anchors[k]);
            (a - b).length()
        };
        self.joints.iter().map(opening).fold(0.0, Real::max)
    }

    fn momentum(&self) -> Vector {
        let bodies = self.links.iter().chain([&self.rod]);
        let of =
            |h: &RigidBodyHandle| self.world.bodies[*h].linvel() * self.world.bodies[*h].mass();
        bodies.map(of).sum()
    }

    /// The scene, solved by rapier in so many more sub-steps.
    fn finer(mut self, more: usize) -> Self {
        for link in &self.links {
            self.world.bodies[*link].set_additional_solver_iterations(more);
        }
        self
    }

    /// Steps of the given lengths.
    pub fn run(mut self, hooked: bool, steps: &[Real]) -> End {
        let mut pipeline = attached(&mut self.world);
        let mut end = End::default();
        let mut time = 0.0;
        for &dt in steps {
            self.world.integration_parameters.dt = dt;
            let impact = if hooked {
                pipeline.step(&mut self.world).events > 0
            } else {
                self.world.step();
                false
            };
            let widest = &mut end.widest[usize::from(impact)];
            *widest = widest.max(self.widest());
            let turning = |h: &RigidBodyHandle| self.world.bodies[*h].angvel().length();
            let fastest = self.links.iter().map(turning).fold(0.0, Real::max);
            end.turned += fastest * dt;
            if impact {
                end.struck = self.momentum().z;
            }
            time += dt;
            if time < 3.01 / 60.0 {
                end.rod_before = self.world.bodies[self.rod].linvel().z;
            }
        }
        let turn = |h: &RigidBodyHandle| *self.world.bodies[*h].rotation();
        end.turns = self.links.iter().map(turn).collect();
        let axes = end.turns.iter().zip(&self.axes);
        end.axes = axes.map(|(turn, axis)| turn * *axis).collect();
        end.rod = self.world.bodies[self.rod].linvel().z;
        end.momentum = self.momentum().z;
        end
    }
}

/// How a scene ends.
#[derive(Default)]
pub struct End {
    /// Widest opening of a joint: after steps without impacts, and with them.
    widest: [Real; 2],
    turns: Vec<Rotation>,
    /// Its long axis.
    axes: Vec<Vector>,
    /// How far the fastest link turned.
    turned: Real,
    /// Velocity of the rod, and that before the last 60th of a second.
    pub rod: Real,
    rod_before: Real,
    /// Of all bodies: in the end, and after the last step with an impact.
    momentum: Real,
    struck: Real,
}

impl End {
    /// The largest angle between a link's axis and another's, in units of how far the fastest turned there.
    pub fn bent(&self, other: &Self) -> Real {
        let off = |(a, b): (&Vector, &Vector)| a.angle_between(*b);
        let off = self.axes.iter().zip(&other.axes).map(off);
        off.fold(0.0, Real::max) / other.turned
    }

    /// The same of their rotations, which know how bars turn about their own axes.
    pub fn off(&self, other: &Self) -> Real {
        let off = |(a, b): (&Rotation, &Rotation)| a.angle_between(*b);
        self.turns
            .iter()
            .zip(&other.turns)
            .map(off)
            .fold(0.0, Real::max)
            / other.turned
    }
}

/// Steps of a 60th of a second, of a 2,000th, and of a 2,000th until the impact's step ends and a 60th from there: what
/// rapier makes of the same motion in its own steps.
fn steps() -> [Vec<Real>; 3] {
    let fine = |n: usize| vec![1.0 / 1980.0; n];
    let coarse = |n: usize| vec![1.0 / 60.0; n];
    [coarse(4), fine(132), [fine(66), coarse(2)].concat()]
}

/// Sub-steps that the steps after an impact have more, about as many as medial links have there. rapier works with the
/// inertia that a body has at the start of a step: bars of joints of bodies turn wrong about their own axes then.
const MORE_SUBSTEPS: usize = 16;

#[test]
fn jointed_bodies_take_an_impact_together() {
    let [coarse, fine, both] = steps();
    for struck in [Struck::Hinge, Struck::Chain, Struck::Ragdoll] {
        for by in [By::Multibody, By::ImpulseJoints] {
            for speed in [1.0, 5.0, 20.0, 60.0] {
                let scene = |medial: bool| Scene::new(struck, by, medial, speed, 0.37);
                let mass = scene(true);
                let mass = mass.world.bodies[mass.rod].mass();
                let ours = scene(true).run(true, &coarse);
                let [fine, own] = [&fine, &both].map(|steps| scene(false).run(false, steps));
                let finer = scene(false).finer(MORE_SUBSTEPS).run(false, &both);
                let rod = (ours.rod - fine.rod).abs() / speed;
                let before = (ours.rod_before - fine.rod_before).abs() / speed;
                println!(
                    "{struck:?} by {by:?}, {speed} m/s: axes off by {:.3}, rapier's own {:.3}; \
                     turns off by {:.3} of {:.2} rad, rapier's own {:.3}, {:.3} in more sub-steps; \
                     rod off by {before:.3} and {rod:.3}, rapier's own {:.3}; opens {:.4} and {:.4} m, rapier's own {:.4}; \
                     momentum {:.4} of {:.4}",
                    ours.bent(&fine),
                    own.bent(&fine),
                    ours.off(&fine),
                    fine.turned,
                    own.off(&fine),
                    finer.off(&fine),
                    (own.rod - fine.rod).abs() / speed,
                    ours.widest[1],
                    ours.widest[0],
                    own.widest[0],
                    ours.struck,
                    mass * speed,
                );
                let name = format!("{struck:?} by {by:?}, {speed} m/s");
                let [bent, off] = [ours.bent(&fine), ours.off(&fine)];
                let limit = own.bent(&fine).max(0.05);
                assert!(bent < limit, "{name}: axes off by {bent}");
                let limit = own.off(&fine).max(finer.off(&fine)) + 0.05;
                assert!(off < limit, "{name}: turns off by {off}");
                let limit = (own.rod - fine.rod).abs() / speed + 0.05;
                assert!(rod < limit, "{name}: rod off by {rod}");
                // At 60 m/s it meets the chain a third time as the last step ends.
                assert!(before < 0.05, "{name}: rod off by {before} a step before");
                let widest = ours.widest[0].max(ours.widest[1]);
                assert!(widest < own.widest[0] + 2.0e-3, "{name}: opens {widest} m");
                if struck == Struck::Ragdoll && ours.struck != 0.0 {
                    let lost = 1.0 - ours.struck / (mass * speed);
                    assert!(lost.abs() < 0.01, "{name}: momentum lost {lost}");
                }
            }
        }
    }
}

/// The energy of a rope on ball joints and of what strikes its middle at a speed, step by step, in units of that at
/// the start. Neighbours touch end to end.
fn struck_rope(links: usize, by: By, speed: Real, steps: usize) -> Vec<Real> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let mut last = world.insert_body(RigidBodyBuilder::fixed());
    for i in 0..links {
        let at = Vector::new((2 * i + 1) as Real * HALF, 0.0, 0.0);
        let link = RigidBodyBuilder::dynamic().translation(at);
        let link = world.insert(link, bar(true, Vector::X, HALF - RADIUS)).0;
        let anchor = if i == 0 {
            Vector::ZERO
        } else {
            Vector::X * HALF
        };
        let joint = SphericalJointBuilder::new()
            .local_anchor1(anchor)
            .local_anchor2(-Vector::X * HALF);
        match by {
            By::Multibody => _ = world.insert_multibody_joint(last, link, joint),
            By::ImpulseJoints => _ = world.insert_impulse_joint(last, link, joint),
        }
        last = link;
    }
    let middle = Vector::new(links as Real * HALF, 0.0, -0.1 - speed / 60.0 * 1.37);
    let rod = RigidBodyBuilder::dynamic()
        .translation(middle)
        .linvel(Vector::Z * speed);
    let rod = world.insert(rod, bar(true, Vector::Y, HALF)).0;
    let start = world.bodies[rod].kinetic_energy();
    let step = |_| {
        pipeline.step(&mut world);
        let all = world.bodies.iter().map(|(_, b)| b.kinetic_energy());
        all.sum::<Real>() / start
    };
    (0..steps).map(step).collect()
}

/// Symptom: a rope of 30 links, struck in its middle at 120 m/s, ended with four times the energy that came in, as a
/// multibody with no numbers at all. Cause: joints that impacts had left open were closed in what was left of the
/// step, and the speed that this takes stayed with the bodies.
///
/// Multibodies of 22 links and more left all numbers, struck at 2 m/s. Cause: along the normal of two neighbours that
/// touch end to end nothing moves but by rounding, and rapier's solver divides by it.
#[test]
fn ropes_are_struck_and_gain_no_energy() {
    for by in [By::Multibody, By::ImpulseJoints] {
        for links in [8, 22, 40] {
            for speed in [2.0, 20.0, 60.0] {
                let energies = struck_rope(links, by, speed, 6);
                let most = energies.iter().copied().fold(0.0, Real::max);
                println!("{links} links by {by:?}, {speed} m/s: {energies:.2?}");
                let name = format!("{links} links by {by:?}, {speed} m/s");
                assert!(most <= 1.001, "{name}: {most} of the energy");
                assert!(
                    energies.iter().all(|e| e.is_finite()),
                    "{name}: {energies:?}"
                );
                // A rope that gave no way would take nearly all.
                let struck = energies[1];
                assert!(struck > 0.4 && struck < 0.75, "{name}: keeps {struck}");
            }
        }
    }
}
