//! Rows of the table of docs/rapier.md that no other file has: each scene once with medial rods and once with rapier's
//! capsules of the same sizes, and the same end.

use crate::bodies::attached;
use crate::filters::rod;
use crate::told::Record;
use rapier3d::prelude::*;

/// Poses of all bodies after some steps.
fn end(mut world: PhysicsWorld, steps: usize) -> Vec<Pose> {
    let mut pipeline = attached(&mut world);
    for _ in 0..steps {
        pipeline.step(&mut world);
    }
    world.bodies.iter().map(|(_, b)| *b.position()).collect()
}

/// The largest distance of a body, or angle in radians, between a scene with medial rods and one with capsules.
fn apart(scene: impl Fn(bool) -> PhysicsWorld, steps: usize) -> Real {
    let [ours, rapiers] = [true, false].map(|medial| end(scene(medial), steps));
    assert_eq!(ours.len(), rapiers.len());
    let off = |(a, b): (&Pose, &Pose)| {
        let turn = a.rotation.angle_between(b.rotation);
        (a.translation - b.translation).length().max(turn)
    };
    ours.iter().zip(&rapiers).map(off).fold(0.0, Real::max)
}

fn dynamic(world: &mut PhysicsWorld, medial: bool, at: Vector) -> RigidBodyHandle {
    let body = RigidBodyBuilder::dynamic().translation(at).can_sleep(false);
    world.insert(body, rod(medial).density(500.0)).0
}

#[test]
fn every_kind_of_joint_holds_and_every_motor_turns() {
    let joints: [(&str, GenericJoint); 6] = [
        (
            "fixed",
            FixedJointBuilder::new().local_anchor1(Vector::X).into(),
        ),
        (
            "revolute",
            RevoluteJointBuilder::new(Vector::Z)
                .local_anchor2(Vector::NEG_X)
                .into(),
        ),
        (
            "motor",
            RevoluteJointBuilder::new(Vector::Y)
                .local_anchor2(Vector::NEG_X)
                .motor_velocity(3.0, 100.0)
                .into(),
        ),
        (
            "prismatic, limited",
            PrismaticJointBuilder::new(Vector::Y)
                .limits([-0.5, 0.5])
                .into(),
        ),
        ("rope", RopeJointBuilder::new(0.7).into()),
        ("spring", SpringJointBuilder::new(0.7, 2000.0, 100.0).into()),
    ];
    for multibody in [false, true] {
        for (name, joint) in joints {
            // rapier takes no ropes and springs as joints of multibodies.
            if multibody && matches!(name, "rope" | "spring") {
                continue;
            }
            let scene = |medial: bool| {
                let mut world = PhysicsWorld::new();
                let base = world.bodies.insert(RigidBodyBuilder::fixed());
                let body = dynamic(&mut world, medial, Vector::new(0.3, 0.1, 0.0));
                if multibody {
                    assert!(world.insert_multibody_joint(base, body, joint).is_some());
                } else {
                    world.insert_impulse_joint(base, body, joint);
                }
                world
            };
            let off = apart(scene, 90);
            println!("{name}, multibody {multibody}: {off}");
            assert!(off < 3.0e-3, "{name}, multibody {multibody}: {off} off");
        }
    }
}

/// A rod flies through a sensor and lands on the ground: the sensor is told in rapier's steps, the landing in the step
/// of the touch.
#[test]
fn sensors_and_contacts_are_told_when_rapiers_are() {
    let told = |medial: bool, medial_sensor: bool| {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::NEG_Y);
        world.insert_collider(ground, None);
        let sensor = rod(medial_sensor).sensor(true).translation(Vector::Y);
        world.insert_collider(sensor.active_events(ActiveEvents::COLLISION_EVENTS), None);
        let body = RigidBodyBuilder::dynamic().translation(Vector::Y * 2.0);
        let collider = rod(medial).active_events(ActiveEvents::COLLISION_EVENTS);
        world.insert(body, collider);
        let record = Record::default();
        let told = |step: usize| {
            pipeline.step_with_events(&mut world, &(), &record);
            let starts = record.take().starts();
            starts.into_iter().map(move |started| (step, started))
        };
        (0..90).flat_map(told).collect::<Vec<_>>()
    };
    let rapiers = told(false, false);
    assert_eq!(rapiers.len(), 3, "{rapiers:?}");
    for (medial, sensor) in [(true, false), (false, true), (true, true)] {
        let told = told(medial, sensor);
        assert_eq!(told[..2], rapiers[..2], "rod {medial}, sensor {sensor}");
        // A touch within the step is told in that step; rapier finds it at the start of the next.
        let [(ours, _), (theirs, _)] = [&told, &rapiers].map(|t| t[2]);
        assert!(
            told.len() == 3 && (ours == theirs || ours + 1 == theirs),
            "rod {medial}, sensor {sensor}: {told:?}"
        );
    }
}

/// A conveyor, a lift and a turntable: kinematic bodies carry what lies on them.
#[test]
fn kinematic_bodies_carry_what_lies_on_them() {
    let movers = [
        (
            "conveyor",
            RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::X * 0.5),
        ),
        (
            "lift",
            RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::Y * 0.5),
        ),
        (
            "turntable",
            RigidBodyBuilder::kinematic_velocity_based().angvel(Vector::Y * 0.5),
        ),
    ];
    for (name, mover) in movers {
        let scene = |medial: bool| {
            let mut world = PhysicsWorld::new();
            let plate = ColliderBuilder::cuboid(3.0, 0.1, 3.0);
            world.insert(mover.clone(), plate);
            dynamic(&mut world, medial, Vector::Y * 0.2);
            world
        };
        let off = apart(scene, 90);
        println!("{name}: {off}");
        assert!(off < 0.02, "{name}: {off} off");
    }
}
