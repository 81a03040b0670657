//! The same bits, run after run and for any number of threads; with `enhanced-determinism` on every
//! machine: a golden. `tests/wasm/run.sh` checks it in WebAssembly.

use crate::golden::{mixed_scene, run};

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
