//! Jobs sent to the device before they are asked: the answers are the CPU's, whatever changed since.

use crate::batch::{essence, pair_jobs, toi_jobs};
use crate::scene;
use pollster::block_on;
use rapier3d_medial::batch::{Backend, Batch, PairJob, cpu};
use rapier3d_medial::error::GpuError;

fn open() -> Option<Batch> {
    scene::gpu(scene::options())?;
    Some(block_on(Batch::open_async(Backend::Gpu, scene::options())))
}

#[track_caller]
fn assert_answers(batch: &mut Batch, jobs: &[PairJob]) {
    let expected = cpu::run(jobs);
    let answers = batch.run(jobs);
    assert_eq!(answers.len(), expected.len());
    for (answer, expected) in answers.iter().zip(&expected) {
        assert_eq!(answer.contacts, expected.contacts);
    }
}

/// In another order, some of them moved, one gone and one new: one submission, one map.
#[test]
fn jobs_sent_early_are_not_sent_again() {
    for waits in [false, true] {
        let Some(mut batch) = open() else { return };
        let mut jobs = pair_jobs(200);
        batch.submit(&jobs);
        if waits {
            // As in a browser.
            block_on(batch.ready());
        }
        jobs.reverse();
        for job in jobs.iter_mut().step_by(10) {
            job.pos12.translation.x += 0.01;
        }
        jobs.remove(5);
        jobs.push(pair_jobs(201).remove(200));
        assert_answers(&mut batch, &jobs);
        let report = batch.report().counts;
        assert_eq!(
            (report.submissions, report.maps, report.sent_early),
            (1, 1, 179)
        );
        assert!(report.settled_by_gpu > 20 && report.settled_by_gpu < 179);
        // It is used up.
        assert_answers(&mut batch, &jobs);
        assert_eq!(
            (
                batch.report().counts.submissions,
                batch.report().counts.sent_early
            ),
            (2, 179)
        );
    }
}

/// Other jobs come instead, or other batches in between: those are asked as if nothing had been sent.
#[test]
fn jobs_sent_early_in_vain_are_dropped() {
    let Some(mut batch) = open() else { return };
    batch.submit(&pair_jobs(50));
    batch.submit(&pair_jobs(60));
    let others = toi_jobs(90);
    let expected = cpu::run(&others);
    for (answer, expected) in batch.run(&others).iter().zip(&expected) {
        assert_eq!(essence(&answer.toi), essence(&expected.toi));
    }
    assert_answers(&mut batch, &pair_jobs(60));
    let report = batch.report().counts;
    assert_eq!(
        (report.submissions, report.maps, report.sent_early),
        (4, 4, 0)
    );
    assert_eq!(report.fallbacks, 0);
}

/// A device lost, or out of memory, while it has the jobs.
#[test]
fn a_device_that_fails_meanwhile_costs_no_answer() {
    for loses in [false, true] {
        let Some(mut batch) = open() else { return };
        let jobs = pair_jobs(40);
        batch.submit(&jobs);
        let gpu = batch.gpu().expect("a device");
        if loses {
            gpu.lose();
        } else {
            let message = "rehearsed".to_owned();
            gpu.fail(GpuError::OutOfMemory { message });
        }
        assert_answers(&mut batch, &jobs);
        assert_eq!(batch.report().counts.fallbacks, 1);
        assert!(batch.gpu().is_none() && batch.report().error.is_some());
        batch.submit(&jobs);
        assert_answers(&mut batch, &jobs);
        assert_eq!(batch.report().counts.fallbacks, 1);
    }
}

/// NaN poses are left to the CPU though they were sent.
#[test]
fn poses_that_are_not_finite_are_not_settled() {
    let Some(mut batch) = open() else { return };
    let mut jobs = pair_jobs(30);
    for job in jobs.iter_mut().step_by(3) {
        job.pos12.translation.y = f32::NAN;
    }
    batch.submit(&jobs);
    assert_answers(&mut batch, &jobs);
    assert_eq!(
        (
            batch.report().counts.unfit,
            batch.report().counts.sent_early
        ),
        (10, 30)
    );
    assert!(batch.report().counts.settled_by_gpu > 0);
}
