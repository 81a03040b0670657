//! Bodies that are in each other because they did not collide, or were smaller, the step before: what two bodies are is
//! changed between two steps, and from then on they come apart as rapier's own shapes do.

use crate::bodies::{attached, ring};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A ring of 24 capsules.
fn ring_shape(medial: bool, scale: Real) -> SharedShape {
    let mesh = ring(24, 0.5 * scale, 0.1 * scale);
    if medial {
        return SharedShape::medial_mesh(mesh);
    }
    let part = |e: &[u32; 2]| {
        let [a, b] = e.map(|k| mesh.spheres()[k as usize].center);
        (Pose::IDENTITY, SharedShape::capsule(a, b, 0.1 * scale))
    };
    SharedShape::compound(mesh.edges().iter().map(part).collect())
}

/// What keeps two rings in each other, until it is taken away.
#[derive(Clone, Copy, Debug)]
enum Apart {
    Shape,
    Groups,
    SolverGroups,
    Type,
}

/// Two rings at nearly one place, one 3 cm above the other, are let go after ten steps without
/// gravity. How far they are apart a second and a half later, along the axis across both.
fn let_go(medial: bool, apart: Apart) -> (Real, usize) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let none = InteractionGroups::none();
    let mut put = |y: Real, turn: Real| {
        let pose = Pose::new(Vector::Y * y, Vector::Y * turn);
        let kind = match apart {
            Apart::Type => RigidBodyType::Fixed,
            _ => RigidBodyType::Dynamic,
        };
        let body = RigidBodyBuilder::new(kind).pose(pose).can_sleep(false);
        let size = if matches!(apart, Apart::Shape) {
            0.3
        } else {
            1.0
        };
        let collider = ColliderBuilder::new(ring_shape(medial, size)).density(300.0);
        let collider = match apart {
            Apart::Groups => collider.collision_groups(none),
            Apart::SolverGroups => collider.solver_groups(none),
            _ => collider,
        };
        world.insert(body, collider)
    };
    let rings = [put(0.0, 0.0), put(0.03, 0.13)];
    let [(lower, _), (upper, _)] = rings;
    let mut frozen = 0;
    for step in 0..100 {
        if step == 10 {
            for (body, collider) in rings {
                let collider = &mut world.colliders[collider];
                match apart {
                    Apart::Shape => collider.set_shape(ring_shape(medial, 1.0)),
                    Apart::Groups => collider.set_collision_groups(InteractionGroups::all()),
                    Apart::SolverGroups => collider.set_solver_groups(InteractionGroups::all()),
                    Apart::Type => world.bodies[body].set_body_type(RigidBodyType::Dynamic, true),
                }
            }
        }
        frozen += pipeline.step(&mut world).frozen;
    }
    let [low, high] = [lower, upper].map(|h| world.bodies[h].translation().y);
    (high - low, frozen)
}

/// They part by their thickness, and nothing holds them.
#[test]
fn bodies_that_did_not_collide_before_come_apart() {
    for apart in [
        Apart::Shape,
        Apart::Groups,
        Apart::SolverGroups,
        Apart::Type,
    ] {
        let [(ours, frozen), (rapiers, _)] = [true, false].map(|medial| let_go(medial, apart));
        println!("{apart:?}: {ours} m apart, held {frozen} times; rapier's own {rapiers} m");
        assert!(
            rapiers > 0.18,
            "{apart:?}: rapier's own are {rapiers} m apart"
        );
        assert!(
            ours > 0.18,
            "{apart:?}: {ours} m apart, rapier's own {rapiers} m"
        );
        assert_eq!(frozen, 0, "{apart:?}");
    }
}
