//! The mixed scene whose state after [`STEPS`] steps is a golden, the same on every machine with
//! feature `enhanced-determinism`.

use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

pub const STEPS: usize = 1000;

/// State of the mixed scene after [`STEPS`] steps. It changes with any change of the maths, of the measured mass, of
/// which pairs count as fast (by their speed where they may meet), of which contacts an impact passes through (up to
/// eight of a pair, computed at its time, those with fixed bodies too), of which of several contacts at one place is
/// told (the deepest), of which four of a pair bear the load and under which normal, of which faces of a solid are no
/// obstacle to what slides over another of its faces, of where contacts act whose normal is turned
/// to a face, and with rapier.
pub const GOLDEN: u64 = 0xd104_3e2b_de91_1349;

/// Rings and boxes that fall on a ground and on each other.
pub fn mixed_scene() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(20.0, 0.5, 20.0);
    world.insert_collider(ground.translation(Vector::new(0.0, -0.5, 0.0)), None);
    let ring = MedialMesh::torus(0.5, 0.1, 27).expect("a ring");
    for i in 0..12 {
        let (x, z) = ((i % 3) as Real * 0.4, (i % 2) as Real * 0.3);
        let at = Vector::new(x, 0.6 + 0.6 * i as Real, z);
        let turn = Vector::new(0.7 * i as Real, 0.3 * i as Real, 1.1);
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
        if i % 4 == 3 {
            world.insert(body, ColliderBuilder::cuboid(0.2, 0.1, 0.3).density(800.0));
        } else {
            let body = body.angvel(Vector::new(2.0, -1.0, 0.5 * i as Real));
            let collider = ColliderBuilder::medial_mesh(ring.clone());
            world.insert(body, collider.density(1000.0));
        }
    }
    world
}

/// Steps the scene; the hash of where it ends.
pub fn run(mut world: PhysicsWorld) -> u64 {
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    pipeline.attach(&mut world);
    for _ in 0..STEPS {
        pipeline.step(&mut world);
    }
    hash(&world)
}

/// FNV-1a over every bit of every body.
fn hash(world: &PhysicsWorld) -> u64 {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    let mut eat = |x: f32| {
        for byte in x.to_bits().to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    };
    for (_, b) in world.bodies.iter() {
        let (t, r, v, w) = (b.translation(), b.rotation(), b.linvel(), b.angvel());
        let pose = [t.x, t.y, t.z, r.x, r.y, r.z, r.w];
        pose.into_iter().for_each(&mut eat);
        let velocities = [v.x, v.y, v.z, w.x, w.y, w.z];
        velocities.into_iter().for_each(&mut eat);
    }
    hash
}
