//! Worlds of another length unit: with all lengths and `length_unit` a power of two times as large, they are the same
//! to the last bit, because each length that this crate compares with another scales along. What rapier and parry do in
//! these scenes scales exactly too; in contacts with triangles, at limits of joints, and in the damping of multibodies'
//! joints, it does not.

use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Length units, in metres: powers of two, which change no digits.
const UNITS: [Real; 3] = [64.0, 0.015625, 1024.0];
/// Links of a chain.
const LINKS: usize = 6;
/// Distance of two links' centres, in units.
const LENGTH: Real = 0.25;

/// A world in which one unit is `unit` metres.
struct Scene {
    world: PhysicsWorld,
    unit: Real,
    bodies: Vec<RigidBodyHandle>,
}

impl Scene {
    fn new(unit: Real) -> Self {
        let mut world = PhysicsWorld::new();
        world.integration_parameters.length_unit = unit;
        world.gravity *= unit;
        Self {
            world,
            unit,
            bodies: Vec::new(),
        }
    }

    fn ground(mut self) -> Self {
        let ground = ColliderBuilder::cuboid(9.0 * self.unit, 0.125 * self.unit, 9.0 * self.unit);
        self.world.insert_collider(ground, None);
        self
    }

    fn add(&mut self, body: RigidBodyBuilder, collider: ColliderBuilder) -> RigidBodyHandle {
        let (body, _) = self.world.insert(body, collider.mass(1.0));
        self.bodies.push(body);
        body
    }

    /// Twelve bodies above each other, each turned otherwise, `apart` from each other.
    fn pile(mut self, apart: Real, collider: impl Fn(Real) -> ColliderBuilder) -> Self {
        for k in 0..12 {
            let aside = [0.05 * (k % 3) as Real, 0.03 * (k % 4) as Real];
            let at = Vector::new(aside[0], 0.5 + apart * k as Real, aside[1]);
            let body = RigidBodyBuilder::dynamic()
                .translation(at * self.unit)
                .rotation(Vector::new(0.3 * k as Real, 0.1, 0.2));
            self.add(body, collider(self.unit));
        }
        self
    }

    /// A chain that hangs on a fixed body, or lies beside it without weight, and a ball that strikes it.
    fn chain(
        mut self,
        links: usize,
        speed: Real,
        multibody: bool,
        joint: impl Fn(Real) -> GenericJoint,
    ) -> Self {
        let unit = self.unit;
        let mut last = self.world.insert_body(RigidBodyBuilder::fixed());
        for k in 0..links {
            let at = Vector::X * (LENGTH * (k as Real + 0.5) * unit);
            let body = RigidBodyBuilder::dynamic().translation(at);
            let link = self.add(body, link(unit));
            let mut joint = joint(unit);
            let first = if k == 0 { 0.0 } else { 0.5 * LENGTH * unit };
            joint.set_local_anchor1(Vector::X * first);
            joint.set_local_anchor2(Vector::NEG_X * (0.5 * LENGTH * unit));
            joint.contacts_enabled = false;
            if multibody {
                self.world.insert_multibody_joint(last, link, joint);
            } else {
                self.world.insert_impulse_joint(last, link, joint);
            }
            last = link;
        }
        let joints = &mut self.world.multibody_joints;
        let index = joints.rigid_body_link(last).map(|link| link.multibody);
        if let Some(multibody) = index.and_then(|index| joints.get_multibody_mut(index)) {
            multibody.damping_mut().fill(0.0);
        }
        let at = Vector::new(LENGTH * (links as Real - 0.75), -0.3, 0.01);
        let ball = RigidBodyBuilder::dynamic()
            .translation(at * unit)
            .linvel(Vector::Y * (speed * unit));
        self.add(ball, ColliderBuilder::ball(0.125 * unit));
        self
    }

    fn without_weight(mut self) -> Self {
        self.world.gravity = Vector::ZERO;
        self
    }

    /// Bits of poses and velocities after each step, in units.
    fn run(mut self, steps: usize) -> Vec<u32> {
        let mut pipeline = MedialPipeline::new(MedialOptions::default());
        let mut states = Vec::new();
        for _ in 0..steps {
            pipeline.step(&mut self.world);
            for body in &self.bodies {
                let body = &self.world.bodies[*body];
                let lengths = [body.translation(), body.linvel()].map(|v| v / self.unit);
                let turned = body.rotation().to_array();
                let numbers = lengths.iter().flat_map(|v| v.to_array()).chain(turned);
                states.extend(numbers.chain(body.angvel().to_array()).map(Real::to_bits));
            }
        }
        states
    }
}

fn ring(unit: Real) -> ColliderBuilder {
    let mesh = MedialMesh::torus(0.5 * unit, 0.125 * unit, 24).expect("a ring");
    ColliderBuilder::medial_mesh(mesh)
}

fn block(unit: Real) -> ColliderBuilder {
    let mesh = MedialMesh::cuboid(Vector::new(0.25, 0.125, 0.1875) * unit).expect("a block");
    ColliderBuilder::medial_mesh(mesh)
}

fn link(unit: Real) -> ColliderBuilder {
    let end = Vector::X * (0.0625 * unit);
    let mesh = MedialMesh::capsule(-end, end, 0.03125 * unit).expect("a link");
    ColliderBuilder::medial_mesh(mesh).friction(0.25)
}

fn hinge(_: Real) -> GenericJoint {
    RevoluteJointBuilder::new(Vector::Z).into()
}

fn ball_joint(_: Real) -> GenericJoint {
    SphericalJointBuilder::new().into()
}

fn rope(unit: Real) -> GenericJoint {
    RopeJointBuilder::new(0.03125 * unit).into()
}

/// A slider that gets to its limit within the step in which it is struck.
fn slider(unit: Real) -> GenericJoint {
    PrismaticJointBuilder::new(Vector::Y)
        .limits([-0.5 * unit, 0.0625 * unit])
        .into()
}

#[test]
fn worlds_of_other_length_units_are_the_same_to_the_bit() {
    type Make = fn(Real) -> Scene;
    let scenes: [(&str, usize, Make); 9] = [
        ("a heap of rings", 150, |u| {
            Scene::new(u).ground().pile(0.4, ring)
        }),
        ("rings put into each other", 60, |u| {
            Scene::new(u).ground().pile(0.05, ring)
        }),
        ("a heap of blocks", 150, |u| {
            Scene::new(u).ground().pile(0.4, block)
        }),
        ("struck hinges", 100, |u| {
            Scene::new(u)
                .without_weight()
                .chain(LINKS, 30.0, false, hinge)
        }),
        ("struck hinges that fall", 100, |u| {
            Scene::new(u).chain(LINKS, 6.0, false, hinge)
        }),
        ("struck ball joints", 100, |u| {
            Scene::new(u)
                .without_weight()
                .chain(LINKS, 30.0, false, ball_joint)
        }),
        ("struck ropes", 100, |u| {
            Scene::new(u)
                .without_weight()
                .chain(LINKS, 30.0, false, rope)
        }),
        ("a slider struck against its limit", 1, |u| {
            Scene::new(u).without_weight().chain(1, 30.0, false, slider)
        }),
        ("a struck multibody", 100, |u| {
            Scene::new(u)
                .without_weight()
                .chain(LINKS, 30.0, true, hinge)
        }),
    ];
    for (name, steps, scene) in scenes {
        let metres = scene(1.0).run(steps);
        for unit in UNITS {
            let first = scene(unit).run(steps);
            let differs = first.iter().zip(&metres).position(|(a, b)| a != b);
            let numbers = metres.len() / steps;
            let step = differs.map(|place| place / numbers);
            assert_eq!(
                step, None,
                "{name}, a unit of {unit} m: the first step that differs"
            );
        }
    }
}
