//! The same bits, run after run and for any number of threads; with `enhanced-determinism` on every
//! machine: a golden.

use crate::bodies::*;
use rapier3d::prelude::*;

const STEPS: usize = 1000;

/// State of the mixed scene after [`STEPS`] steps on x86-64 Linux with `enhanced-determinism`. It
/// changes with any change of the maths, and with rapier.
#[cfg(feature = "enhanced-determinism")]
const GOLDEN: u64 = 0x462c_1d5f_9125_4e2b;

fn mixed_scene() -> PhysicsWorld {
    let mut world = world_with_ground();
    for i in 0..12 {
        let (x, z) = ((i % 3) as Real * 0.4, (i % 2) as Real * 0.3);
        let at = Vector::new(x, 0.6 + 0.6 * i as Real, z);
        let turn = Vector::new(0.7 * i as Real, 0.3 * i as Real, 1.1);
        match i % 4 {
            3 => {
                let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
                world.insert(body, ColliderBuilder::cuboid(0.2, 0.1, 0.3).density(800.0));
            }
            _ => {
                let ring = add_ring(&mut world, As::Medial, Pose::new(at, turn));
                world.bodies[ring].set_angvel(Vector::new(2.0, -1.0, 0.5 * i as Real), true);
            }
        }
    }
    world
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
        [t.x, t.y, t.z, r.x, r.y, r.z, r.w]
            .into_iter()
            .for_each(&mut eat);
        [v.x, v.y, v.z, w.x, w.y, w.z]
            .into_iter()
            .for_each(&mut eat);
    }
    hash
}

fn run(threads: usize) -> u64 {
    let mut world = mixed_scene();
    #[cfg(feature = "parallel")]
    world
        .configure_thread_pool(threads)
        .expect("a pool of threads");
    #[cfg(not(feature = "parallel"))]
    let _ = threads;
    let mut pipeline = attached(&mut world);
    for _ in 0..STEPS {
        pipeline.step(&mut world);
    }
    hash(&world)
}

#[test]
fn every_run_gives_the_same_bits() {
    let first = run(1);
    assert_eq!(first, run(1));
    assert_eq!(first, run(2), "two threads");
    #[cfg(feature = "enhanced-determinism")]
    assert_eq!(first, GOLDEN, "{first:#x}");
}
