//! Boxes that slide flat over a floor into the edge of a post, off their middle.

use super::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Half the sides of the box.
pub const HALF: Vector = Vector::new(0.3, 0.2, 0.25);

/// How deep a box of these sides gets into the floor, a length, of a way and a turn by number. Floor and post are one
/// compound, or two colliders.
pub fn sunk(shape: &SharedShape, as_one: bool, number: u8) -> Real {
    let parts = [
        (Vector::NEG_Y * 0.4, Vector::new(5.0, 0.4, 3.0)),
        (Vector::Y * 0.9, Vector::new(0.3, 1.0, 0.3)),
    ];
    let parts = parts.map(|(at, half)| {
        let cuboid = SharedShape::cuboid(half.x, half.y, half.z);
        (Pose::from_translation(at), cuboid)
    });
    let ground = match as_one {
        true => vec![ColliderBuilder::compound(parts.to_vec())],
        false => parts
            .map(|(pose, s)| ColliderBuilder::new(s).position(pose))
            .to_vec(),
    };
    let mut world = PhysicsWorld::new();
    for part in ground {
        world.insert_collider(part.friction(0.0), None);
    }
    let k = Real::from(number);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(1.2, HALF.y, 0.1 + 0.03 * k))
        .rotation(Vector::Y * 0.37 * k)
        .linvel(Vector::NEG_X * (2.0 + k));
    let collider = ColliderBuilder::new(shape.clone())
        .friction(0.0)
        .density(500.0);
    let (body, _) = world.insert(body, collider);
    let mut pipeline = attached(&mut world);
    let mut sunk: Real = 0.0;
    for _ in 0..40 {
        pipeline.step(&mut world);
        let pose = world.bodies[body].position();
        let down = (pose.rotation.inverse() * Vector::Y).abs().dot(HALF);
        sunk = sunk.max(down - pose.translation.y);
    }
    sunk
}

/// Symptom: a corner of the box sank into the floor by up to a tenth of the box's height, and the box came out tilted.
/// Cause: the impact acted at the post alone, and the floor, of the same shape, gave no answer within the step.
#[test]
fn boxes_stay_on_the_floor_where_they_slide_into_posts() {
    let medial = SharedShape::medial_mesh(MedialMesh::cuboid(HALF).expect("a box"));
    let own = SharedShape::cuboid(HALF.x, HALF.y, HALF.z);
    for k in 0..9 {
        let [medial, own] = [&medial, &own].map(|shape| sunk(shape, true, k));
        assert!(
            own < 0.001 && medial < 0.005,
            "{k}: {medial} m, rapier's {own}"
        );
    }
}
