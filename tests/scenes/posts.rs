//! Boxes that slide flat over a floor into the edge of a post, off their middle.

use super::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Half the sides of the box.
const HALF: Vector = Vector::new(0.3, 0.2, 0.25);

/// How deep a box of these sides gets into the floor, a length, and how fast it moves up, in units of its speed: of a
/// way and a turn by number. Floor and post are one compound, or two colliders.
fn slide(shape: &SharedShape, as_one: bool, number: u8) -> [Real; 2] {
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
    let speed = 2.0 + k;
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(1.2, HALF.y, 0.1 + 0.03 * k))
        .rotation(Vector::Y * 0.37 * k)
        .linvel(Vector::NEG_X * speed);
    let collider = ColliderBuilder::new(shape.clone())
        .friction(0.0)
        .density(500.0);
    let (body, _) = world.insert(body, collider);
    let mut pipeline = attached(&mut world);
    let [mut sunk, mut up]: [Real; 2] = [0.0; 2];
    for _ in 0..40 {
        pipeline.step(&mut world);
        let body = &world.bodies[body];
        let pose = body.position();
        let down = (pose.rotation.inverse() * Vector::Y).abs().dot(HALF);
        sunk = sunk.max(down - pose.translation.y);
        up = up.max(body.linvel().y / speed);
    }
    let left = -world.bodies[body].linvel().x / speed;
    assert!(left < 0.95, "{left} of its speed is left: it met no post");
    [sunk, up]
}

/// Symptom: a corner of the box sank into the floor by up to a tenth of the box's height, or the box was thrown up.
/// Cause: the impact acted off the edge that met the post: at one end of it, or on the floor.
#[test]
fn boxes_stay_on_the_floor_where_they_slide_into_posts() {
    let medial = SharedShape::medial_mesh(MedialMesh::cuboid(HALF).expect("a box"));
    let own = SharedShape::cuboid(HALF.x, HALF.y, HALF.z);
    for (k, as_one) in (0..9).flat_map(|k| [(k, true), (k, false)]) {
        let [medial, own] = [&medial, &own].map(|shape| slide(shape, as_one, k));
        println!("{k}, as one {as_one}: {medial:?}, rapier's {own:?}");
        assert!(
            own[0] < 0.001 && medial[0] < 0.005,
            "{k}, as one {as_one}: {medial:?} m, rapier's {own:?}"
        );
        assert!(
            own[1] < 0.1 && medial[1] < own[1] + 0.05,
            "{k}, as one {as_one}: {medial:?}, rapier's {own:?}"
        );
    }
}
