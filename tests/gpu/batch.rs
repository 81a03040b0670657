//! Whole batches: answers on the GPU backend are those of the CPU, bit by bit.

use crate::ccd::rng::Rng;
use crate::scene;
use pollster::block_on;
use rapier3d_medial::MedialMesh;
use rapier3d_medial::batch::{Backend, Batch, PairJob, ToiJob, cpu};
use rapier3d_medial::elementary::{Toi, ToiOptions, ToiStatus};
use rapier3d_medial::math::Pose;

pub fn meshes(rng: &mut Rng) -> Vec<MedialMesh> {
    [6, 20, 70].map(|links| scene::mesh(rng, links)).to_vec()
}

pub fn toi_jobs(count: usize) -> Vec<ToiJob> {
    let mut rng = Rng::new(91);
    let meshes = meshes(&mut rng);
    (0..count)
        .map(|k| ToiJob {
            mesh1: meshes[k % 3].clone(),
            motion1: scene::motion(&mut rng, 0.0, 0.0, 1.0),
            mesh2: meshes[k / 3 % 3].clone(),
            motion2: scene::motion(&mut rng, 1.0 + (k % 5) as f32 * 0.5, 60.0, 40.0),
            seconds: 1.0 / 60.0,
            options: ToiOptions::default(),
        })
        .collect()
}

pub fn pair_jobs(count: usize) -> Vec<PairJob> {
    let mut rng = Rng::new(92);
    let meshes = meshes(&mut rng);
    (0..count)
        .map(|k| {
            let start = scene::motion(&mut rng, 0.2 + (k % 7) as f32 * 0.15, 0.0, 0.0).start;
            PairJob {
                mesh1: meshes[k % 3].clone(),
                mesh2: meshes[k / 3 % 3].clone(),
                pos12: Pose::new(start.translation, start.rotation.to_scaled_axis()),
                prediction: 0.02,
            }
        })
        .collect()
}

/// All that reaches the physics: the work it took may differ.
pub fn essence(toi: &Toi) -> Toi {
    Toi {
        iterations: 0,
        ..*toi
    }
}

#[test]
fn answers_are_those_of_the_cpu() {
    if scene::gpu(scene::options()).is_none() {
        return;
    }
    let mut batch = block_on(Batch::open_async(Backend::Gpu, scene::options()));
    let jobs = toi_jobs(300);
    let expected = cpu::run(&jobs);
    let separated = |s: ToiStatus| expected.iter().filter(|e| e.toi.status == s).count();
    assert!(separated(ToiStatus::Separated) > 60 && separated(ToiStatus::Contact) > 60);
    for (answer, expected) in batch.run(&jobs).iter().zip(&expected) {
        assert_eq!(essence(&answer.toi), essence(&expected.toi));
    }
    let free = separated(ToiStatus::Separated) as u64;
    let settled = batch.report().counts.settled_by_gpu;
    println!("{settled} of {free} separated pairs settled by the GPU");
    assert!(settled * 10 > free * 9 && settled <= free);
    let before = batch.report().clone();

    let jobs = pair_jobs(300);
    let expected = cpu::run(&jobs);
    let free = expected.iter().filter(|e| e.contacts.is_empty()).count() as u64;
    assert!((60..240).contains(&free), "{free}");
    for (answer, expected) in batch.run(&jobs).iter().zip(&expected) {
        assert_eq!(answer.contacts, expected.contacts);
    }
    let settled = batch.report().counts.settled_by_gpu - before.counts.settled_by_gpu;
    println!("{settled} of {free} pairs without contacts settled by the GPU");
    assert!(settled * 10 > free * 9 && settled <= free);
    let listed = batch.report().counts.listed - before.counts.listed;
    println!("{listed} of {} others listed", 300 - settled);
    assert!(listed * 10 > (300 - settled) * 9);
    assert_eq!(batch.report().counts.fallbacks, 0);
    assert_eq!(batch.gpu_counts().submissions, 2);
}

/// A scene of pairs that move a little each step: one submission a step, no buffer made.
#[test]
fn steps_make_nothing_on_the_device() {
    if scene::gpu(scene::options()).is_none() {
        return;
    }
    let mut batch = block_on(Batch::open_async(Backend::Gpu, scene::options()));
    let mut jobs = toi_jobs(200);
    batch.run(&jobs);
    let submissions = batch.gpu_counts().submissions;
    let first = batch.gpu_stock();
    for _ in 0..20 {
        for job in &mut jobs {
            job.motion2.start.translation.x += 1.0e-3;
        }
        batch.run(&jobs);
    }
    assert_eq!(batch.gpu_counts().submissions, submissions + 20);
    let last = batch.gpu_stock();
    assert_eq!(
        (last.buffers_made, last.bindings_made),
        (first.buffers_made, first.bindings_made)
    );
    // They are counted.
    assert!(
        first.buffers_made > 10 && first.bindings_made > 2,
        "{first:?}"
    );
}

/// Bodies far apart that turn for ever: the CPU ends on its cap, and a device that takes fewer pieces of the
/// step would call them free.
#[test]
fn endless_turns_are_answered_as_by_the_cpu() {
    if scene::gpu(scene::options()).is_none() {
        return;
    }
    let mut batch = block_on(Batch::open_async(Backend::Gpu, scene::options()));
    let mut jobs = toi_jobs(4);
    for (job, turn) in jobs.iter_mut().zip([3.0, 15.0, 17.0, 1.0e6]) {
        job.motion2.start.translation.x += 50.0;
        job.motion2.angvel = job.motion2.angvel.normalize_or_zero() * (turn * 60.0);
    }
    let expected = cpu::run(&jobs);
    let status = |k: usize| expected[k].toi.status;
    assert_eq!(
        [status(0), status(3)],
        [ToiStatus::Separated, ToiStatus::Unresolved]
    );
    for (answer, expected) in batch.run(&jobs).iter().zip(&expected) {
        assert_eq!(essence(&answer.toi), essence(&expected.toi));
    }
    let report = batch.report();
    assert_eq!((report.counts.settled_by_gpu, report.counts.unfit), (2, 2));
}

/// As many pairs as ten thousand bodies of twenty neighbours have: one submission, and the contacts of the CPU.
#[test]
fn a_hundred_thousand_pairs_are_answered_as_by_the_cpu() {
    if scene::gpu(scene::options()).is_none() {
        return;
    }
    let mut batch = block_on(Batch::open_async(Backend::Gpu, scene::options()));
    let jobs = pair_jobs(100_000);
    let expected = cpu::run(&jobs);
    let free = expected.iter().filter(|e| e.contacts.is_empty()).count();
    assert!((20_000..80_000).contains(&free), "{free}");
    for (answer, expected) in batch.run(&jobs).iter().zip(&expected) {
        assert_eq!(answer.contacts, expected.contacts);
    }
    let counts = batch.report().counts;
    let bytes = batch.gpu_stock().bytes_made;
    println!("{free} free, {counts:?}, {bytes} bytes on the device");
    // What the device neither frees nor lists is searched as without it.
    assert_eq!(counts.submissions, 1);
    assert_eq!(counts.fallbacks, 0);
    let settled = counts.settled_by_gpu as usize;
    assert!(settled <= free && settled * 10 > free * 9);
    assert!(counts.listed as usize * 10 > (jobs.len() - settled) * 9);
    assert!(bytes < 2_500 * jobs.len() as u64, "{bytes}");
}
