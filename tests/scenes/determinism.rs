//! The same bits, run after run and for any number of threads; with `enhanced-determinism` on every
//! machine: a golden. `tests/wasm/run.sh` checks it in WebAssembly.

use crate::golden::{mixed_scene, run};
use rapier3d_medial::prelude::*;

fn run_on(threads: usize) -> u64 {
    #[cfg(feature = "parallel")]
    {
        let mut world = mixed_scene();
        world
            .configure_thread_pool(threads)
            .expect("a pool of threads");
        run(world)
    }
    #[cfg(not(feature = "parallel"))]
    {
        let _ = threads;
        run(mixed_scene())
    }
}

#[test]
fn every_run_gives_the_same_bits() {
    let first = run_on(1);
    assert_eq!(first, run_on(1));
    assert_eq!(first, run_on(2), "two threads");
    #[cfg(feature = "enhanced-determinism")]
    assert_eq!(first, crate::golden::GOLDEN, "{first:#x}");
}

#[test]
fn a_pipeline_attaches_itself_in_its_first_step() {
    let poses = |attach: bool| {
        let mut world = mixed_scene();
        let mut pipeline = MedialPipeline::new(MedialOptions::default());
        if attach {
            pipeline.attach(&mut world);
        }
        for _ in 0..200 {
            pipeline.step(&mut world);
        }
        let poses = world.bodies.iter().map(|(_, body)| *body.position());
        poses.collect::<Vec<_>>()
    };
    assert_eq!(poses(false), poses(true));
}
