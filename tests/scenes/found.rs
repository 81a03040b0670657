//! Rapier's queries between steps find bodies where impacts within the step put them.

use crate::bodies::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

#[test]
fn queries_after_a_step_find_bodies_where_impacts_put_them() {
    let mut impacts = 0;
    for seed in 0..4 {
        let mut random = Random(seed);
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        for (axis, side) in [Vector::X, Vector::Y, Vector::Z]
            .into_iter()
            .flat_map(|n| [(n, 1.0), (n, -1.0)])
        {
            let half = Vector::splat(2.0) - axis * 1.5;
            let wall = ColliderBuilder::cuboid(half.x, half.y, half.z).restitution(1.0);
            world.insert_collider(wall.translation(axis * side * 2.0), None);
        }
        let mesh = ring(16, 0.15, 0.04);
        let fly = |k: usize| {
            let mut vector = |most: Real| Vector::from([0; 3].map(|_| random.within(-most, most)));
            let body = RigidBodyBuilder::dynamic()
                .translation(vector(0.2) + Vector::X * (k as Real - 2.5) * 0.35)
                .linvel(vector(30.0))
                .angvel(vector(5.0));
            world
                .insert(
                    body,
                    ColliderBuilder::medial_mesh(mesh.clone()).restitution(1.0),
                )
                .1
        };
        let flying: Vec<ColliderHandle> = (0..6).map(fly).collect();
        let mut pipeline = MedialPipeline::default();
        pipeline.attach(&mut world);
        for _ in 0..150 {
            let report = pipeline.step(&mut world);
            impacts += report.events;
            let queries = world.query_pipeline();
            for handle in &flying {
                let collider = &world.colliders[*handle];
                // In the middle of the first capsule of the ring.
                let inside = collider.position() * Vector::new(0.15, 0.0, 0.0);
                assert!(collider.shape().contains_point(collider.position(), inside));
                let mut at = queries.intersect_point(inside);
                assert!(at.any(|(found, _)| found == *handle), "no ring at {inside}");
                let mut near = queries.intersect_aabb_conservative(collider.compute_aabb());
                assert!(
                    near.any(|(found, _)| found == *handle),
                    "no box at {inside}"
                );
            }
        }
    }
    assert!(impacts > 200, "only {impacts} impacts");
}
