//! Heaps in which bodies get other shapes while they touch.

use super::bodies::attached;
use super::let_go::shapes;
use super::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// What a heap did.
pub struct Heap {
    /// How deep the deepest two were in each other in the end, a length, by rapier's own shapes.
    pub depth: Real,
    /// How often a body was held within a step.
    pub frozen: usize,
}

/// Ten bodies in a narrow pen. For five and a half seconds one of them becomes a ring, or a capsule, twelve times a
/// second; then they have three seconds to come apart.
pub fn heap(seed: u64) -> Heap {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let mut wall = |half: Vector, at: Vector| {
        let wall = ColliderBuilder::cuboid(half.x, half.y, half.z).translation(at);
        world.insert_collider(wall, None);
    };
    wall(Vector::new(3.0, 0.5, 3.0), Vector::NEG_Y * 0.5);
    for side in [-1.4, 1.4] {
        wall(Vector::new(0.2, 4.0, 3.0), Vector::X * side);
        wall(Vector::new(3.0, 4.0, 0.2), Vector::Z * side);
    }
    let (meshes, own) = shapes();
    let shapes = meshes.map(SharedShape::medial_mesh);
    let mut random = Random(seed);
    let mut kinds = [1; 10];
    let put = |k: usize| {
        let at = Vector::new(0.0, 0.6 + 0.5 * k as Real, 0.0) + random.direction() * 0.3;
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, random.direction() * 3.0));
        let collider = ColliderBuilder::new(shapes[1].clone()).density(300.0);
        world.insert(body, collider)
    };
    let bodies: Vec<_> = (0..10).map(put).collect();
    let mut frozen = 0;
    for step in 0..540 {
        if (30..360).contains(&step) && step % 5 == 0 {
            let k = (random.unit() * 10.0) as usize;
            kinds[k] = usize::from(random.unit() < 0.5);
            world.colliders[bodies[k].1].set_shape(shapes[kinds[k]].clone());
        }
        frozen += pipeline.step(&mut world).frozen;
    }
    let depth = |i: usize, j: usize| {
        let [p, q] = [i, j].map(|k| *world.bodies[bodies[k].0].position());
        let [a, b] = [i, j].map(|k| &*own[kinds[k]]);
        let contact = rapier3d::parry::query::contact(&p, a, &q, b, 0.0);
        contact.expect("rapier knows both").map_or(0.0, |c| -c.dist)
    };
    let pairs = (0..10).flat_map(|i| (0..i).map(move |j| (i, j)));
    Heap {
        depth: pairs.map(|(i, j)| depth(i, j)).fold(0.0, Real::max),
        frozen,
    }
}
