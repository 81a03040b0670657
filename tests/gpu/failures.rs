//! What can go wrong: the CPU does the work, the report says why, nothing is lost.

use crate::batch::{essence, pair_jobs, toi_jobs};
use crate::scene;
use pollster::block_on;
use rapier3d_medial::batch::gpu::GpuOptions;
use rapier3d_medial::batch::{Backend, Batch, cpu};
use rapier3d_medial::elementary::ToiStatus;
use rapier3d_medial::error::GpuError;

fn open(options: GpuOptions) -> Option<Batch> {
    scene::gpu(scene::options())?;
    Some(block_on(Batch::open_async(Backend::Gpu, options)))
}

#[track_caller]
fn assert_complete(batch: &mut Batch) {
    let jobs = toi_jobs(90);
    let expected = cpu::run(&jobs);
    let answers = batch.run(&jobs);
    assert_eq!(answers.len(), expected.len());
    for (answer, expected) in answers.iter().zip(&expected) {
        assert_eq!(essence(&answer.toi), essence(&expected.toi));
    }
}

#[test]
fn without_jobs_there_is_nothing_to_do() {
    let mut batch = Batch::new(Backend::Auto);
    assert!(batch.run(&toi_jobs(0)).is_empty());
    let Some(mut batch) = open(scene::options()) else {
        return;
    };
    assert!(batch.run(&pair_jobs(0)).is_empty());
    assert_eq!(batch.gpu_counts().submissions, 0);
}

/// Runs without any adapter: CPU backend, and adapters that are not GPUs refused by `Auto`.
#[test]
fn the_cpu_serves_without_a_gpu() {
    let mut batch = Batch::new(Backend::Cpu);
    assert_complete(&mut batch);
    assert_eq!(batch.report().error, None);
    assert_eq!(batch.report().counts.settled_by_gpu, 0);
    let mut batch = Batch::new(Backend::Auto);
    assert_complete(&mut batch);
    match batch.gpu() {
        Some(gpu) => assert!(gpu.is_hardware()),
        None => assert!(matches!(
            batch.report().error,
            Some(GpuError::Software { .. } | GpuError::NoAdapter { .. })
        )),
    }
}

#[test]
fn a_lost_device_costs_no_answer() {
    let Some(mut batch) = open(scene::options()) else {
        return;
    };
    assert_complete(&mut batch);
    assert!(batch.report().counts.settled_by_gpu > 0);
    batch.gpu().expect("a device").lose();
    let settled = batch.report().counts.settled_by_gpu;
    assert_complete(&mut batch);
    assert!(matches!(batch.report().error, Some(GpuError::Lost { .. })));
    assert_eq!(batch.report().counts.fallbacks, 1);
    // From now on the CPU has it, without another attempt.
    assert_complete(&mut batch);
    assert_eq!(batch.report().counts.fallbacks, 1);
    assert_eq!(batch.report().counts.settled_by_gpu, settled);
}

/// A binding too small for the meshes: an error with both sizes; the device is kept for batches
/// that fit.
#[test]
fn batches_too_large_for_the_device_go_to_the_cpu() {
    let options = GpuOptions {
        binding_bytes: 1 << 16,
        ..scene::options()
    };
    let Some(mut batch) = open(options) else {
        return;
    };
    let large = pair_jobs(1000);
    let expected = cpu::run(&large);
    for (answer, expected) in batch.run(&large).iter().zip(&expected) {
        assert_eq!(answer.contacts, expected.contacts);
    }
    let Some(GpuError::TooLarge { bytes, limit, .. }) = batch.report().error else {
        panic!("{:?}", batch.report());
    };
    assert!(limit == 1 << 16 && bytes > limit, "{bytes} {limit}");
    assert_eq!(batch.report().counts.settled_by_gpu, 0);
    let small = pair_jobs(9);
    let expected = cpu::run(&small);
    for (answer, expected) in batch.run(&small).iter().zip(&expected) {
        assert_eq!(answer.contacts, expected.contacts);
    }
    assert_eq!(batch.report().counts.fallbacks, 1);
    assert!(batch.report().counts.settled_by_gpu > 0);
}

/// Poses that are not finite go to the CPU, which has its own answer to them.
#[test]
fn poses_that_are_not_finite_go_to_the_cpu() {
    let Some(mut batch) = open(scene::options()) else {
        return;
    };
    let mut jobs = toi_jobs(40);
    for (k, bad) in [f32::NAN, f32::INFINITY].into_iter().enumerate() {
        jobs[5 * k].motion1.start.translation.y = bad;
        jobs[5 * k + 1].motion2.linvel.x = bad;
        jobs[5 * k + 2].motion2.angvel.z = bad;
        jobs[5 * k + 3].options.tolerance = bad;
        jobs[5 * k + 4].options.time_tolerance = bad;
    }
    let expected = cpu::run(&jobs);
    let answers = batch.run(&jobs);
    for (k, (answer, expected)) in answers.iter().zip(&expected).enumerate() {
        let (a, b) = (&answer.toi, &expected.toi);
        assert_eq!((a.status, a.lower, a.upper), (b.status, b.lower, b.upper));
        assert!(k >= 10 || a.status == ToiStatus::Unresolved, "{k}: {a:?}");
    }
    assert!(batch.report().counts.settled_by_gpu > 0);
    assert_eq!(batch.report().counts.fallbacks, 0);
    assert_eq!(batch.report().counts.unfit, 10);
}

/// Set for the copy of this program that [`without_a_driver_the_cpu_serves`] starts: what the machine
/// lacks there.
const LACKING: &str = "MEDIAL_TEST_LACKING";

/// Runs in that copy.
#[test]
fn lacking() {
    let Ok(lacking) = std::env::var(LACKING) else {
        return;
    };
    let mut batch = Batch::new(Backend::Gpu);
    let error = batch.report().error.clone();
    assert!(
        matches!(error, Some(GpuError::NoAdapter { .. })),
        "without {lacking}: {error:?}"
    );
    assert_complete(&mut batch);
    assert_eq!(batch.report().counts.settled_by_gpu, 0);
    println!("served without {lacking}");
}

/// The same machine without a driver, and with a loader that cannot be loaded.
#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_the_cpu_serves() {
    let folder = std::env::temp_dir().join(format!("medial-no-loader-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for name in ["libvulkan.so.1", "libvulkan.so"] {
        std::fs::write(folder.join(name), "").expect("an empty file");
    }
    let program = std::env::current_exe().expect("this program");
    for (lacking, variable, value) in [
        ("a driver", "VK_DRIVER_FILES", folder.join("none.json")),
        ("a loader", "LD_LIBRARY_PATH", folder.clone()),
    ] {
        let output = std::process::Command::new(&program)
            .args(["--exact", "failures::lacking", "--nocapture"])
            .env(LACKING, lacking)
            .env(variable, value)
            .output()
            .expect("this program again");
        let said = String::from_utf8_lossy(&output.stdout);
        let expected = format!("served without {lacking}");
        assert!(
            output.status.success() && said.contains(&expected),
            "{said}"
        );
    }
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

/// No driver here runs out of memory when asked to, so what it would say is put in its mouth.
#[test]
fn a_device_without_memory_is_given_up() {
    let Some(mut batch) = open(scene::options()) else {
        return;
    };
    assert_complete(&mut batch);
    let error = GpuError::OutOfMemory {
        message: "rehearsed".to_owned(),
    };
    batch.gpu().expect("a device").fail(error.clone());
    assert_complete(&mut batch);
    assert_eq!(batch.report().error, Some(error));
    assert_eq!(batch.report().counts.fallbacks, 1);
    assert!(batch.gpu().is_none());
}

/// Meshes that nobody else holds make room.
#[test]
fn meshes_of_bodies_that_are_gone_go_too() {
    let Some(mut batch) = open(scene::options()) else {
        return;
    };
    for round in 0..4 {
        let jobs = pair_jobs(30);
        let expected = cpu::run(&jobs);
        for (answer, expected) in batch.run(&jobs).iter().zip(&expected) {
            assert_eq!(answer.contacts, expected.contacts);
        }
        // New meshes each time, those of the round before gone.
        assert_eq!(batch.gpu_stock().meshes, 3, "round {round}");
    }
    assert_eq!(batch.report().counts.fallbacks, 0);
}
