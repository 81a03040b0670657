//! Decides whether a batch runs on the CPU or a GPU. A GPU only finds what certainly does not meet: pairs, and
//! primitives of other pairs, of which it lists those that may. The CPU computes these, and pairs without a list as
//! if there were no GPU. So answers are the same on both, except for counts of work, and a GPU that fails costs
//! nothing but time.

#[cfg(feature = "gpu")]
use super::calibration::Least;
use super::counts::BatchCounts;
use super::cpu;
#[cfg(feature = "gpu")]
use super::early::Early;
#[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
use super::gpu::GpuOptions;
#[cfg(feature = "gpu")]
use super::gpu::{Gpu, Proposal, Proposals};
use super::job::Job;
#[cfg(feature = "gpu")]
use super::job::Sweep;
use crate::elementary::bracket::{Bracket, Limits};
use crate::elementary::many::{Lanes, brackets};
use crate::elementary::path::LinearPath;
use crate::elementary::test_list::Domain;
use crate::error::GpuError;

/// The place where contacts and first contacts of many pairs are computed: the CPU or a GPU. Both give the same
/// answers, bit by bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// A GPU for batches that are large enough, and the CPU for others. If there is no GPU, the CPU
    /// computes all of them, and [`BatchReport::error`] says why. `Batch::calibrate` sets how large
    /// is large enough; until then it is 512 jobs, and with the feature `parallel` no batch is
    /// large enough. Needs the feature `gpu`, without which it is the same as [`Self::Cpu`].
    Auto,
    /// The CPU.
    #[default]
    Cpu,
    /// A GPU for every batch, however small, even if it is a GPU simulated on the CPU. For tests. Needs the feature
    /// `gpu`.
    Gpu,
}

/// The work that a [`Batch`] has done since it was made. A *job* is one pair of meshes or one elementary test.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BatchReport {
    /// Counts of jobs, submissions and failures.
    pub counts: BatchCounts,
    /// Why the GPU did not take the last of [`BatchCounts::fallbacks`], or why there is no GPU.
    pub error: Option<GpuError>,
}

/// Computes contacts or first contacts of many pairs on the CPU (the default) or on a GPU, and keeps the meshes that
/// it has sent there.
#[derive(Default)]
pub struct Batch {
    #[cfg(feature = "gpu")]
    pub(super) backend: Backend,
    #[cfg(feature = "gpu")]
    pub(super) gpu: Option<Gpu>,
    #[cfg(feature = "gpu")]
    pub(super) proposals: Proposals,
    /// Answers of the device, one for each job of a batch.
    #[cfg(feature = "gpu")]
    pub(super) said: Vec<Proposal>,
    #[cfg(feature = "gpu")]
    pub(super) early: Early,
    #[cfg(feature = "gpu")]
    pub(super) free: Vec<bool>,
    /// Empty between batches; its room is kept.
    #[cfg(feature = "gpu")]
    pub(super) sweeps: Vec<Sweep<'static>>,
    /// Elementary tests that the device leaves to the CPU.
    #[cfg(feature = "gpu")]
    pub(super) open: Vec<LinearPath<f32>>,
    #[cfg(feature = "gpu")]
    pub(super) calibrated: Option<Least>,
    pub(super) report: BatchReport,
}

impl Batch {
    /// Opens a backend; a GPU takes a moment. This never fails: if there is no GPU, the CPU is used, and
    /// [`BatchReport::error`] says why. In a browser it always is the CPU; use `open_async` there.
    pub fn new(backend: Backend) -> Self {
        #[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
        return pollster::block_on(Self::open_async(backend, options(backend)));
        #[cfg(not(all(feature = "gpu", not(target_arch = "wasm32"))))]
        {
            let mut batch = Self::default();
            if backend != Backend::Cpu {
                batch.report.error = Some(GpuError::NotBuilt);
            }
            batch
        }
    }

    /// The work done so far.
    pub fn report(&self) -> &BatchReport {
        &self.report
    }

    /// Answers all jobs, in their order. In a browser the CPU answers all but those that were sent to the GPU
    /// before and have come back (`submit_async`, `ready`).
    pub fn run<J: Job>(&mut self, jobs: &[J]) -> Vec<J::Answer> {
        #[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
        return pollster::block_on(self.run_async(jobs));
        #[cfg(all(feature = "gpu", target_arch = "wasm32"))]
        return match self.sent_early(jobs) && !self.early.pending {
            true => self.settle_early(jobs),
            false => {
                self.early.forget();
                self.run_on_cpu(jobs)
            }
        };
        #[cfg(not(feature = "gpu"))]
        self.run_on_cpu(jobs)
    }

    /// Whether a GPU is open and working.
    pub fn has_device(&self) -> bool {
        #[cfg(feature = "gpu")]
        return self.gpu.is_some();
        #[cfg(not(feature = "gpu"))]
        false
    }

    /// Sends jobs to the GPU before their answers are needed, if there is one and there are enough jobs, and does not
    /// wait for it. The next [`Self::run`] takes the answers of jobs that are the same, bit by bit, from this
    /// submission, and computes the others on the CPU. In a browser nothing is sent; use `submit_async` there.
    pub fn submit<J: Job>(&mut self, jobs: &[J]) {
        #[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
        pollster::block_on(self.submit_async(jobs));
        #[cfg(not(all(feature = "gpu", not(target_arch = "wasm32"))))]
        let _ = jobs;
    }

    pub(super) fn run_on_cpu<J: Job>(&mut self, jobs: &[J]) -> Vec<J::Answer> {
        self.report.counts.settled_by_cpu += jobs.len() as u64;
        cpu::run(jobs)
    }

    /// Brackets the first contacts of many elementary tests, in their order. A bracket that the GPU has proved free has
    /// no nearest spheres.
    pub fn brackets(
        &mut self,
        paths: &[LinearPath<f32>],
        domain: Domain,
        limits: &Limits<f32>,
    ) -> Vec<Bracket<f32>> {
        #[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
        return pollster::block_on(self.brackets_async(paths, domain, limits));
        #[cfg(not(all(feature = "gpu", not(target_arch = "wasm32"))))]
        self.brackets_on_cpu(paths, domain, limits)
    }

    pub(super) fn brackets_on_cpu(
        &mut self,
        paths: &[LinearPath<f32>],
        domain: Domain,
        limits: &Limits<f32>,
    ) -> Vec<Bracket<f32>> {
        self.report.counts.settled_by_cpu += paths.len() as u64;
        brackets(paths, domain, limits, Lanes::Fastest)
    }
}

#[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
fn options(backend: Backend) -> GpuOptions {
    GpuOptions {
        software: backend == Backend::Gpu,
        ..GpuOptions::default()
    }
}
