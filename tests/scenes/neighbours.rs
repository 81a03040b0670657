//! Two colliders of one body, side by side: what rapier's step does about one of them leaves the other as it is.
//! Judged by the same scene without the neighbour.

use crate::bodies::*;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Depth in a plate of a ball that slides on it beside a rail, both colliders at the pose of one body;
/// `None`: without the rail.
fn deepest_beside_a_rail(rail: Option<Pose>) -> (Real, usize) {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let corners = [-1.4, -0.4].into_iter().flat_map(|y| {
        [(-20.0, -2.0), (20.0, -2.0), (20.0, 2.0), (-20.0, 2.0)].map(|(x, z)| Vector::new(x, y, z))
    });
    let plate = ColliderBuilder::convex_hull(&corners.collect::<Vec<_>>()).expect("a plate");
    let (fixed, _) = world.insert(
        RigidBodyBuilder::kinematic_position_based(),
        plate.friction(0.0),
    );
    if let Some(pose) = rail {
        let rail = ColliderBuilder::capsule_x(20.0, 0.2).position(pose);
        world.insert_collider(rail.friction(0.0), Some(fixed));
    }
    let ball = MedialMesh::ball(0.2).expect("a ball");
    // Beside and below the rail: their boxes overlap, they are off each other by more than what counts as
    // touching.
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-10.0, -0.2, 0.3477))
        .linvel(Vector::X * 30.0);
    let (ball, _) = world.insert(body, ColliderBuilder::medial_mesh(ball).friction(0.0));
    let (mut deepest, mut muted): (Real, _) = (0.0, 0);
    for _ in 0..30 {
        muted += pipeline.step(&mut world).muted;
        deepest = deepest.max(-0.2 - world.bodies[ball].translation().y);
    }
    (deepest, muted)
}

/// Of two colliders at one pose of one body, the one that is muted does not mute the other.
#[test]
fn a_muted_collider_does_not_mute_its_neighbour() {
    let (alone, none) = deepest_beside_a_rail(None);
    let (beside, muted) = deepest_beside_a_rail(Some(Pose::IDENTITY));
    assert!(
        beside < alone + 1.0e-4,
        "{beside} deep, without the rail {alone}"
    );
    assert!(muted > none + 20, "{muted} and {none} of 30 steps muted");
}
