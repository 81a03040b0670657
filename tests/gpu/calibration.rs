//! The sizes that `Auto` goes by: as text, as thresholds, and measured.

use crate::batch::toi_jobs;
use crate::ccd::rng::Rng;
use crate::scene;
use pollster::block_on;
use rapier3d_medial::batch::{Backend, Batch, Calibration};
use rapier3d_medial::error::CalibrationError;

fn some() -> Calibration {
    Calibration {
        adapter: "llvmpipe (LLVM 15.0.6, 256 bits) (Vulkan)".to_owned(),
        jobs: Some(48),
        tests: None,
    }
}

#[test]
fn calibration_is_kept_as_text() {
    let text = some().to_string();
    assert!(text.contains("jobs = 48\ntests = never\n"), "{text}");
    assert_eq!(text.parse(), Ok(some()));
}

#[test]
fn text_that_is_no_calibration_is_refused_by_line() {
    let text = some().to_string();
    for (from, to, number) in [
        ("48", "-1", 2),
        ("48", "many", 2),
        ("never", "", 3),
        ("jobs", "job", 2),
        ("adapter =", "adapter", 1),
    ] {
        let bad = text.replace(from, to);
        let line = bad.lines().nth(number - 1).expect("a line").to_owned();
        let refused = CalibrationError::Line { number, text: line };
        assert_eq!(bad.parse::<Calibration>(), Err(refused));
    }
    for what in ["adapter", "jobs", "tests"] {
        let without = |line: &&str| !line.starts_with(what);
        let lines: Vec<_> = text.lines().filter(without).collect();
        let missing = CalibrationError::Missing { what };
        assert_eq!(lines.join("\n").parse::<Calibration>(), Err(missing));
    }
}

#[test]
fn auto_asks_the_gpu_from_the_calibrated_batch_size_on() {
    if scene::gpu(scene::options()).is_none() {
        return;
    }
    // With the option, `Auto` takes this adapter though it computes on the CPU.
    let mut batch = block_on(Batch::open_async(Backend::Auto, scene::options()));
    let adapter = batch.gpu().expect("a device").name().to_owned();
    assert!(!batch.calibrate(&some()) || adapter == some().adapter);
    for (jobs, small, large) in [(Some(50), 0, 1), (Some(1), 1, 1), (None, 0, 0)] {
        let adapter = adapter.clone();
        let tests = None;
        assert!(batch.calibrate(&Calibration {
            adapter,
            jobs,
            tests
        }));
        for (count, asked) in [(49, small), (50, large)] {
            let before = batch.report().counts.submissions;
            batch.run(&toi_jobs(count));
            assert_eq!(
                batch.report().counts.submissions - before,
                asked,
                "{count} {jobs:?}"
            );
        }
    }
    assert_eq!(
        batch.report().counts.maps,
        batch.report().counts.submissions
    );
}

/// Slow: it is a measurement.
#[test]
#[ignore = "times a device, alone: `medial calibrate` is the command for it"]
fn calibration_is_measured() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let mesh = scene::mesh(&mut Rng::new(3), 30);
    let measured = Calibration::measure(&mut gpu, &mesh).expect("a calibration");
    assert_eq!(measured.adapter, gpu.name());
    assert_eq!(measured.to_string().parse(), Ok(measured));
}
