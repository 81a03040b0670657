//! Batches like those before allocate nothing of ours on the host. Packing is counted by itself, to the
//! last one; of whole batches what the graphics library allocates for the same calls is taken off, which
//! differs by a few between batches that we make the same calls for.

use crate::bare::Bare;
use crate::batch::toi_jobs;
use crate::scene;
use allocation_counter::measure;
use pollster::block_on;
use rapier3d_medial::batch::gpu::shaders::{CULL, ELEMENTARY};
use rapier3d_medial::batch::gpu::{GpuOptions, Proposals};
use rapier3d_medial::batch::{Backend, Batch, Job};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::Domain;
use rapier3d_medial::error::GpuError;
use rapier3d_medial::math::lane::Vec3;

/// Fewest and most allocations of a call that has been made a few times.
fn allocations(mut call: impl FnMut()) -> [u64; 2] {
    (0..5).for_each(|_| call());
    let counts = [0; 40].map(|_| measure(&mut call).count_total);
    let ends = [counts.iter().min(), counts.iter().max()];
    ends.map(|end| *end.expect("some"))
}

/// How much the library's allocations differ: 93 to 100 were seen of batches of elementary tests that
/// differ in nothing but their length. Fewer of ours would not be noticed in whole batches.
const SPREAD: u64 = 8;

/// As many and more groups than batches have here: the library counts otherwise while the device is busy.
const GROUPS: [u32; 3] = [1, 100, 10_000];

/// Most that the library allocates for a batch by itself, in two halves.
fn library(bare: &Bare, copies: &[usize], cleared: bool) -> u64 {
    let most = GROUPS.map(|groups| {
        let [_, most] = allocations(|| {
            block_on(async { bare.submit(copies, cleared, groups) });
            block_on(async { bare.collect() });
        });
        most
    });
    most.into_iter().max().expect("some")
}

/// The counter counts, and the library allocates: else the tests below would show nothing.
#[test]
fn allocations_are_counted() {
    let one = allocations(|| drop(std::hint::black_box(vec![1_u8; 9])));
    assert_eq!(one, [1, 1]);
    let Some(bare) = block_on(Bare::open(&ELEMENTARY, 1)) else {
        return;
    };
    assert!(library(&bare, &[0, 1], false) > 10);
}

/// What is packed does not fit the device, so that the library is not called.
#[test]
fn packing_allocates_nothing() {
    let options = GpuOptions {
        binding_bytes: 1 << 12,
        ..scene::options()
    };
    let Some(mut gpu) = scene::gpu(options) else {
        return;
    };
    let jobs = toi_jobs(500);
    let sweeps: Vec<_> = jobs.iter().filter_map(Job::sweep).collect();
    let waker = allocations(|| block_on(async {}));
    let packed = allocations(|| {
        let refused = block_on(gpu.submit(&sweeps));
        assert!(matches!(refused, Err(GpuError::TooLarge { .. })));
    });
    assert_eq!(packed, waker);
    // With the list of jobs, and those that are known again.
    let mut batch = block_on(Batch::open_async(Backend::Gpu, options));
    let packed = allocations(|| batch.submit(&jobs));
    assert_eq!(packed, waker);
    assert_eq!(batch.report().counts.fallbacks, 45);
}

#[test]
fn elementary_tests_allocate_nothing_of_ours() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let bare = block_on(Bare::open(&ELEMENTARY, 1)).expect("an adapter");
    let library = library(&bare, &[0, 1], false);
    let apart = LinearPath {
        start: [Vec3::new(3.0, 0.0, 0.0); 4],
        rate: [Vec3::zero(); 4],
        radius: [0.5; 4],
        size: 0.0,
    };
    for count in [1, 5_000] {
        let paths = vec![apart; count];
        let mut free = Vec::new();
        let all = allocations(|| {
            let asked = gpu.prove(&paths, Domain::Box, 1.0e-4, &mut free);
            block_on(asked).expect("proposals");
        });
        println!("{count} tests: {all:?} allocations, the library {library}");
        assert!(all[1] <= library + SPREAD, "{count}: {all:?} {library}");
        assert_eq!(free, vec![true; count]);
    }
}

/// As a step does it: sent off, then asked. All jobs are free, because the CPU's search has lists of its
/// own; the list of answers is handed out.
#[test]
fn mesh_pairs_allocate_nothing_of_ours_but_answers() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let bare = block_on(Bare::open(&CULL, 2)).expect("an adapter");
    let library = library(&bare, &[0, 1], true);
    let mut jobs = toi_jobs(500);
    let sweeps: Vec<_> = jobs.iter().filter_map(Job::sweep).collect();
    let mut said = Proposals::default();
    let all = allocations(|| {
        block_on(gpu.submit(&sweeps)).expect("a submission");
        block_on(gpu.collect(&mut said)).expect("proposals");
    });
    println!("500 mesh pairs: {all:?} allocations, the library {library}");
    assert!(all[1] <= library + SPREAD, "{all:?} {library}");

    let mut free = said.iter().map(|proposal| proposal.is_free());
    jobs.retain(|_| free.next() == Some(true));
    assert!(jobs.len() > 100);
    let mut batch = block_on(Batch::open_async(Backend::Gpu, scene::options()));
    let all = allocations(|| {
        batch.submit(&jobs);
        assert_eq!(batch.run(&jobs).len(), jobs.len());
    });
    println!("{} jobs: {all:?} allocations", jobs.len());
    assert!(all[1] <= library + SPREAD, "{all:?} {library}");
    assert_eq!(batch.report().counts.settled_by_cpu, 0);
}
