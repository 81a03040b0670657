//! Fast pairs that do not touch are kept from rapier's solver, so that it does not stop what passes by.

use crate::bodies::attached;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

fn rod(half: Real, radius: Real) -> MedialMesh {
    MedialMesh::capsule(Vector::X * -half, Vector::X * half, radius).expect("a rod")
}

/// Symptom: pairs that should be muted had contacts in rapier's solver, which stopped bodies that passed each other at
/// the distance of their thickness. Cause: a pair is muted by the bits of its relative pose, and the pose at the start
/// of the step was rounded where the centre of mass is not at the body's origin.
#[test]
fn pairs_of_bodies_with_their_centre_of_mass_aside_are_muted() {
    let mut random = Random(1);
    let mut muted = 0;
    for case in 0..64 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let (at, turn) = (random.direction() * 3.0, random.direction() * 2.0);
        let mut put = |at: Vector, linvel: Vector| {
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(at, turn))
                .linvel(linvel);
            let mass = MassProperties::new(random.direction() * 0.3, 1.0, Vector::splat(0.1));
            let collider = ColliderBuilder::medial_mesh(rod(0.4, 0.02));
            let (body, _) = world.insert(body, collider.mass_properties(mass));
            // Else they are known from the first step on.
            world.bodies[body].recompute_mass_properties_from_colliders(&world.colliders);
        };
        let aside = Pose::new(at, turn).rotation * Vector::Y;
        put(at, Vector::ZERO);
        put(at + aside * 0.06, aside * -60.0);
        let report = pipeline.step(&mut world);
        // Pairs whose boxes do not meet are not asked for at all.
        muted += report.muted;
        assert_eq!(report.jobs, 0, "case {case}");
    }
    assert!(muted > 32, "only {muted} of 64 are near");
}

/// Symptom: in a world whose length unit is the millimetre, rods that turned past each other were stopped. Cause: a
/// pair counted as touching, and was left to the solver, up to 0.1 mm beyond the gap, whatever the unit.
#[test]
fn tips_pass_beside_each_other_in_any_length_unit() {
    for unit in [1.0, 1.0e-3, 1.0e3] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.length_unit = unit;
        let mut pipeline = attached(&mut world);
        let collider = || ColliderBuilder::medial_mesh(rod(0.5 * unit, 0.02 * unit));
        let spin = Vector::Z * 60.0;
        // Turned, so that the boxes of both meet.
        let start = 0.7;
        let body = RigidBodyBuilder::dynamic().rotation(Vector::Z * start);
        let (rod, _) = world.insert(body.angvel(spin), collider());
        world.bodies[rod].set_allow_fast_rotation(true);
        // The tips pass at 1.3 mm where the unit is the metre, and are 1.7 mm apart at the start.
        let [near, aside]: [Real; 2] = [0.0413, 0.006];
        let turn = start + (aside / (0.5 + near)).asin();
        let other = RigidBodyBuilder::fixed()
            .translation(Vector::new(turn.cos(), turn.sin(), 0.0) * (1.0 + near) * unit)
            .rotation(Vector::Z * turn);
        world.insert(other, collider());
        pipeline.step(&mut world);
        let after = world.bodies[rod].angvel();
        assert!((after - spin).length() < 0.1, "unit {unit}: {after}");
    }
}
