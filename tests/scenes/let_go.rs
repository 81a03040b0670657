//! Two rings that a joint held in each other, and then let go of.

use super::bodies::{attached, ring};
use super::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A ring of 12 cones, and a capsule; as rapier's own.
pub fn shapes() -> ([MedialMesh; 2], [SharedShape; 2]) {
    let mesh = ring(12, 0.4, 0.1);
    let (end, radius) = (Vector::X * 0.3, 0.15);
    let part = |e: &[u32; 2]| {
        let [a, b] = e.map(|k| mesh.spheres()[k as usize].center);
        (Pose::IDENTITY, SharedShape::capsule(a, b, 0.1))
    };
    let parts = mesh.edges().iter().map(part).collect();
    let own = [
        SharedShape::compound(parts),
        SharedShape::capsule(end, -end, radius),
    ];
    let capsule = MedialMesh::capsule(end, -end, radius).expect("a capsule");
    ([mesh, capsule], own)
}

/// How deep two rings are in each other, by rapier's own shapes: a joint with or without contacts held them so, and was
/// removed two seconds ago.
pub fn let_go(medial: bool, contacts: bool, seed: u64) -> Real {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let (meshes, own) = shapes();
    let shape = match medial {
        true => SharedShape::medial_mesh(meshes[0].clone()),
        false => own[0].clone(),
    };
    let mut random = Random(seed);
    let poses = [0, 1].map(|_| Pose::new(random.direction() * 0.1, random.direction() * 3.0));
    let bodies = poses.map(|pose| {
        let collider = ColliderBuilder::new(shape.clone()).density(300.0);
        world
            .insert(RigidBodyBuilder::dynamic().pose(pose), collider)
            .0
    });
    let joint = FixedJointBuilder::new()
        .local_frame1(poses[0].inv_mul(&poses[1]))
        .contacts_enabled(contacts);
    let joint = world.insert_impulse_joint(bodies[0], bodies[1], joint);
    for step in 0..180 {
        if step == 60 {
            world.remove_impulse_joint(joint);
        }
        match medial {
            true => _ = pipeline.step(&mut world),
            false => world.step(),
        }
    }
    let [p, q] = bodies.map(|b| *world.bodies[b].position());
    let contact = rapier3d::parry::query::contact(&p, &*own[0], &q, &*own[0], 0.0);
    contact.expect("rapier knows both").map_or(0.0, |c| -c.dist)
}
