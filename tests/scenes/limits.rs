//! Joints with limits whose bodies are struck within a step: beside rapier's capsules of the same sizes, in its own steps
//! and in sixteenths of them.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Joined {
    Hinge,
    BallJoint,
    Slider,
    Rope,
}

#[derive(Clone, Copy, Debug)]
struct Chain {
    links: usize,
    joined: Joined,
    multibody: bool,
    /// Of the ball that strikes the last link but one, kg and metres per second.
    mass: Real,
    speed: Real,
}

const LIMIT: Real = 0.5;
const LENGTH: Real = 0.2;
const RADIUS: Real = 0.03;

/// What became of a chain.
#[derive(Debug)]
struct End {
    /// The most energy after any step over that of the start.
    energy: f64,
    /// How the ball flies.
    ball: Vector,
}

impl Chain {
    fn joint(self, k: usize) -> GenericJoint {
        let first = if k == 0 { 0.0 } else { 0.5 * LENGTH };
        let (a, b) = (Vector::X * first, Vector::NEG_X * (0.5 * LENGTH));
        let mut joint: GenericJoint = match self.joined {
            Joined::Hinge => RevoluteJointBuilder::new(Vector::Z)
                .local_anchor1(a)
                .local_anchor2(b)
                .limits([-LIMIT, LIMIT])
                .into(),
            Joined::BallJoint => SphericalJointBuilder::new()
                .local_anchor1(a)
                .local_anchor2(b)
                .limits(JointAxis::AngZ, [-LIMIT, LIMIT])
                .limits(JointAxis::AngX, [-LIMIT, LIMIT])
                .into(),
            Joined::Slider => PrismaticJointBuilder::new(Vector::Y)
                .local_anchor1(a)
                .local_anchor2(b)
                .limits([-0.1, 0.1])
                .into(),
            Joined::Rope => RopeJointBuilder::new(0.03)
                .local_anchor1(a)
                .local_anchor2(b)
                .into(),
        };
        joint.contacts_enabled = false;
        joint
    }

    fn run(self, medial: bool, parts: usize, steps: usize) -> End {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = 1.0 / 60.0 / parts as Real;
        let mut pipeline = attached(&mut world);
        let mut bodies = vec![world.insert_body(RigidBodyBuilder::fixed())];
        let end = Vector::X * (0.5 * LENGTH - RADIUS - 0.01);
        for k in 0..self.links {
            let collider = if medial {
                let mesh = MedialMesh::capsule(-end, end, RADIUS).expect("a link");
                ColliderBuilder::medial_mesh(mesh)
            } else {
                ColliderBuilder::capsule_from_endpoints(-end, end, RADIUS)
            };
            let at = Vector::X * (LENGTH * (k as Real + 0.5));
            let body = RigidBodyBuilder::dynamic().translation(at);
            let (link, _) = world.insert(body, collider.density(1000.0).friction(0.0));
            world.bodies[link].set_allow_fast_rotation(true);
            let last = bodies[k];
            if self.multibody {
                world.insert_multibody_joint(last, link, self.joint(k));
            } else {
                world.insert_impulse_joint(last, link, self.joint(k));
            }
            bodies.push(link);
        }
        let at = Vector::X * (LENGTH * (self.links as Real - 0.6));
        let back = 0.1 + RADIUS + 0.01 + self.speed / 60.0 * 0.37;
        let body = RigidBodyBuilder::dynamic()
            .translation(at + Vector::new(0.0, back, 0.02))
            .linvel(Vector::NEG_Y * self.speed)
            .ccd_enabled(!medial);
        let collider = ColliderBuilder::ball(0.1).mass(self.mass).friction(0.0);
        let (ball, _) = world.insert(body, collider);
        let energy = |world: &PhysicsWorld| -> f64 {
            let of = world.bodies.iter().map(|(_, b)| b.kinetic_energy());
            of.map(f64::from).sum()
        };
        let start = energy(&world);
        let mut most: f64 = 0.0;
        for _ in 0..steps * parts {
            if medial {
                pipeline.step(&mut world);
            } else {
                world.step();
            }
            let ratio = energy(&world) / start;
            most = most.max(if ratio.is_finite() {
                ratio
            } else {
                f64::INFINITY
            });
        }
        End {
            energy: most,
            ball: world.bodies[ball].linvel(),
        }
    }
}

/// All chains, of 1, 2 and 6 links.
fn chains(speeds: &[Real]) -> Vec<Chain> {
    let mut chains = Vec::new();
    for (joined, multibody) in KINDS {
        for links in [1, 2, 6] {
            for mass in [0.2, 2.0] {
                for &speed in speeds {
                    chains.push(Chain {
                        links,
                        joined,
                        multibody,
                        mass,
                        speed,
                    });
                }
            }
        }
    }
    chains
}

const KINDS: [(Joined, bool); 7] = [
    (Joined::Hinge, false),
    (Joined::Hinge, true),
    (Joined::BallJoint, false),
    (Joined::BallJoint, true),
    (Joined::Slider, false),
    (Joined::Slider, true),
    (Joined::Rope, false),
];

/// Symptom: two hanging links with a limit, struck by a ball of 2 kg at 20 m/s, left all numbers. Cause: links struck
/// within a step went on past their limits, and rapier's next step flung them back by as much as they were beyond. Of
/// rapier's own chains here three multibodies leave all numbers.
#[test]
fn struck_joints_with_limits_gain_no_energy() {
    for chain in chains(&[5.0, 20.0, 60.0]) {
        let End { energy, .. } = chain.run(true, 1, 12);
        assert!(energy < 1.001, "{chain:?}: {energy} times the energy");
    }
}

/// What strikes them flies on as from rapier's capsules in sixteenths of a step: no farther off than from rapier's capsules
/// in whole ones, give or take a fiftieth of its speed.
#[test]
fn what_strikes_joints_with_limits_bounces_as_in_fine_steps() {
    for kind in KINDS {
        let (mut ours, mut own, mut count) = (0.0, 0.0, 0.0);
        let chains = chains(&[5.0, 20.0]);
        for chain in chains
            .into_iter()
            .filter(|c| (c.joined, c.multibody) == kind)
        {
            let ends = [(true, 1), (false, 1), (false, 16)];
            let balls = ends.map(|(medial, parts)| chain.run(medial, parts, 12).ball);
            let off = |k: usize| balls[k].distance(balls[2]) / chain.speed;
            (ours, own, count) = (ours + off(0), own + off(1), count + 1.0);
        }
        let [ours, own] = [ours, own].map(|sum| sum / count);
        println!(
            "{kind:?}: velocities off by {ours:.3} of the ball's speed, rapier's own {own:.3}"
        );
        assert!(ours < own + 0.02, "{kind:?}: {ours}, rapier's own {own}");
    }
}
