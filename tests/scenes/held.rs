//! Contacts that nearer ones hold back are not solved; what is fast or pulled by a joint meets the next one all
//! the same. Planted: a ball slides on a floor into a ramp, whose surface is known.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

const RADIUS: Real = 0.5;
const SLOPE: Real = 12.0;

/// A floor at height 0 that ends at `x = 0`, and a ramp from there, both of slabs as thick as the ball.
fn ground() -> MedialMesh {
    let (sin, cos) = SLOPE.to_radians().sin_cos();
    let row = |x: Real, y: Real| {
        [-3.0, 3.0].map(|z| MedialSphere::new(Vector::new(x, y - RADIUS, z), RADIUS))
    };
    let rows = [row(-6.0, 0.0), row(0.0, 0.0), row(6.0 * cos, 6.0 * sin)];
    let edges = [
        [0, 1],
        [0, 2],
        [1, 2],
        [1, 3],
        [2, 3],
        [2, 4],
        [3, 4],
        [3, 5],
        [4, 5],
    ];
    let slabs = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]];
    MedialMesh::new(rows.concat(), edges.to_vec(), slabs.to_vec()).expect("a floor and a ramp")
}

/// The two, and a ball that starts at `x` with this speed.
fn slide(x: Real, speed: Real) -> (PhysicsWorld, MedialPipeline, RigidBodyHandle) {
    let mut world = PhysicsWorld::new();
    let pipeline = attached(&mut world);
    let smooth = |mesh: MedialMesh| ColliderBuilder::medial_mesh(mesh).friction(0.0);
    world.insert_collider(smooth(ground()), None);
    let center = MedialSphere::new(Vector::ZERO, RADIUS);
    let ball = MedialMesh::new(vec![center], vec![], vec![]).expect("a ball");
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(x, RADIUS, 0.0))
        .linvel(Vector::X * speed);
    let (ball, _) = world.insert(body, smooth(ball).density(1.0));
    (world, pipeline, ball)
}

/// How deep the ball is in the ramp.
fn depth(world: &PhysicsWorld, ball: RigidBodyHandle) -> Real {
    let (sin, cos) = SLOPE.to_radians().sin_cos();
    let p = world.bodies[ball].translation();
    2.0 * RADIUS - (cos * (p.y + RADIUS) - sin * p.x)
}

#[test]
fn fast_sliding_body_hits_the_ramp() {
    let mut deepest = Real::MIN;
    for k in 0..24 {
        let (mut world, mut pipeline, ball) = slide(-1.5 - 0.1 * k as Real / 24.0, 6.0);
        for _ in 0..30 {
            pipeline.step(&mut world);
            deepest = deepest.max(depth(&world, ball));
        }
        assert!(world.bodies[ball].linvel().y > 0.5, "it goes up");
    }
    assert!(deepest < 0.001, "{deepest}");
}

#[test]
fn body_pulled_by_a_rope_hits_the_ramp() {
    for k in 0..12 {
        let gap = 0.008 + 0.001 * k as Real;
        let (sin, cos) = SLOPE.to_radians().sin_cos();
        let x = -(gap + 2.0 * RADIUS * (1.0 - cos)) / sin;
        let (mut world, mut pipeline, ball) = slide(x, 0.0);
        let heavy = RigidBodyBuilder::dynamic()
            .gravity_scale(0.0)
            .additional_mass(1.0e4)
            .translation(Vector::new(x + 2.0, RADIUS, 0.0))
            .linvel(Vector::X * 6.0);
        let heavy = world.bodies.insert(heavy);
        let rope = RopeJointBuilder::new(2.0);
        world.impulse_joints.insert(ball, heavy, rope, true);
        for _ in 0..4 {
            pipeline.step(&mut world);
            let depth = depth(&world, ball);
            assert!(depth < 0.001, "{depth} from a gap of {gap}");
        }
        assert!(world.bodies[ball].linvel().x > 3.0, "it was pulled");
    }
}
