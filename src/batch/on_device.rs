//! The GPU's part of a batch, seen from the CPU: whether asking it pays, what it said, and what is left for the CPU.

use super::backend::{Backend, Batch};
use super::calibration::{Calibration, Least};
use super::counts::BatchCounts;
use super::cpu;
use super::early::Key;
use super::gpu::{Gpu, GpuOptions, GpuStock, Proposal, Proposals};
use super::job::{Job, Sweep};
use crate::elementary::bracket::{Bracket, Limits};
use crate::elementary::path::LinearPath;
use crate::elementary::test_list::Domain;
use crate::error::GpuError;

/// Fewest jobs, and elementary tests, for which [`Backend::Auto`] asks a GPU before it is told by a [`Calibration`]:
/// what was measured on an NVIDIA H200 beside one core. Beside sixteen no batch was large enough
/// (`docs/measurements/benches.md`). Where it does not fit, it costs time only.
const UNCALIBRATED: Least = Least {
    jobs: if cfg!(feature = "parallel") {
        None
    } else {
        Some(512)
    },
    tests: None,
};

impl Batch {
    /// Opens a backend without blocking, with options for the choice of the GPU.
    pub async fn open_async(backend: Backend, options: GpuOptions) -> Self {
        let mut batch = Self {
            backend,
            ..Self::default()
        };
        if backend != Backend::Cpu {
            match Gpu::open(options).await {
                Ok(gpu) => batch.gpu = Some(gpu),
                Err(error) => batch.report.error = Some(error),
            }
        }
        batch
    }

    /// The GPU, as long as it works.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.gpu.as_ref()
    }

    /// The GPU, to drop meshes that are no longer used.
    pub fn gpu_mut(&mut self) -> Option<&mut Gpu> {
        self.gpu.as_mut()
    }

    /// The work that the GPU has done.
    pub fn gpu_counts(&self) -> BatchCounts {
        self.gpu.as_ref().map(Gpu::counts).unwrap_or_default()
    }

    /// Resources that the GPU keeps.
    pub fn gpu_stock(&self) -> GpuStock {
        self.gpu.as_ref().map(Gpu::stock).unwrap_or_default()
    }

    /// Sets the sizes of batches from which on [`Backend::Auto`] uses the GPU, by this calibration. Returns false, and
    /// changes nothing, if it was measured on another GPU than this, or if there is none.
    pub fn calibrate(&mut self, calibration: &Calibration) -> bool {
        let Calibration {
            adapter,
            jobs,
            tests,
        } = calibration;
        let same = self.gpu.as_ref().is_some_and(|gpu| gpu.name() == adapter);
        if same {
            let (jobs, tests) = (*jobs, *tests);
            self.calibrated = Some(Least { jobs, tests });
        }
        same
    }

    fn asks_gpu(&self, size: usize, least: fn(Least) -> Option<usize>) -> bool {
        let least = least(self.calibrated.unwrap_or(UNCALIBRATED));
        let large = self.backend == Backend::Gpu || least.is_some_and(|n| size >= n);
        self.gpu.is_some() && large && size > 0
    }

    /// Adds what the device did since it had counted so much.
    fn count(&mut self, before: BatchCounts) {
        self.report.counts += self.gpu_counts() - before;
    }

    /// The batch goes to the CPU; a device that may still serve is kept.
    fn fall_back(&mut self, error: GpuError) {
        self.report.counts.fallbacks += 1;
        if !matches!(error, GpuError::TooLarge { .. }) {
            self.gpu = None;
        }
        self.report.error = Some(error);
    }

    /// Does the same as [`Self::submit`] without blocking.
    pub async fn submit_async<J: Job>(&mut self, jobs: &[J]) {
        self.early.forget();
        if !self.asks_gpu(jobs.len(), |least| least.jobs) {
            return;
        }
        let mut sweeps = emptied(std::mem::take(&mut self.sweeps));
        sweeps.extend(jobs.iter().filter_map(Job::sweep));
        let before = self.gpu_counts();
        let outcome = match &mut self.gpu {
            Some(gpu) => gpu.submit(&sweeps).await,
            None => return,
        };
        self.count(before);
        match outcome {
            Ok(()) => {
                let keys = sweeps.iter().map(Key::of);
                self.early.sent.extend(keys.zip(0..));
                self.early.pending = true;
            }
            Err(error) => self.fall_back(error),
        }
        self.sweeps = emptied(sweeps);
    }

    /// Waits without blocking until the answers to [`Self::submit_async`] have come back. [`Self::run`] waits for them
    /// itself, except in a browser, where it uses only what has come back.
    pub async fn ready(&mut self) {
        if !std::mem::take(&mut self.early.pending) {
            return;
        }
        let mut proposals = std::mem::take(&mut self.early.proposals);
        let before = self.gpu_counts();
        let outcome = match &mut self.gpu {
            Some(gpu) => gpu.collect(&mut proposals).await,
            None => Ok(()),
        };
        self.count(before);
        match outcome {
            Ok(()) => self.early.proposals = proposals,
            Err(error) => self.fall_back(error),
        }
    }

    /// Sends the jobs of several batches to this one's GPU in one submission, and waits without blocking for its
    /// answers. The next [`Self::run`] of each of them, which need no GPU of their own, takes the answers of jobs that
    /// are the same, bit by bit, from it, and computes the others as if nothing had been sent.
    pub async fn share<J: Job>(&mut self, parts: &mut [(&mut Self, Vec<J>)]) {
        let jobs: Vec<&J> = parts.iter().flat_map(|(_, jobs)| jobs).collect();
        self.submit_async(&jobs).await;
        self.ready().await;
        let mut start = 0;
        for (batch, jobs) in parts {
            let sweeps = jobs.iter().filter_map(Job::sweep);
            let early = &mut batch.early;
            early.forget();
            let keys = sweeps.map(|sweep| Key::of(&sweep));
            early.sent.extend(keys.zip(0..));
            let end = start + jobs.iter().filter_map(Job::sweep).count();
            early.proposals.take_part(&self.early.proposals, start..end);
            start = end;
            if early.proposals.is_empty() {
                early.forget();
            }
        }
        self.early.forget();
    }

    /// Whether what was sent before is of any use for these jobs; where not, it is forgotten.
    pub(super) fn sent_early<J: Job>(&mut self, jobs: &[J]) -> bool {
        let sent = &self.early.sent;
        let known = |s: Sweep<'_>| sent.contains_key(&Key::of(&s));
        let known = jobs.iter().filter(|job| job.sweep().is_some_and(known));
        let known = known.count();
        self.report.counts.sent_early += known as u64;
        if known == 0 {
            self.early.forget();
        }
        known > 0
    }

    /// Answers jobs of which some were sent before and are back.
    pub(super) fn settle_early<J: Job>(&mut self, jobs: &[J]) -> Vec<J::Answer> {
        let mut early = std::mem::take(&mut self.early);
        let answers = self.settle(jobs, &early.proposals, |sweep| early.proposal(sweep));
        early.forget();
        self.early = early;
        answers
    }

    /// Does the same as [`Self::run`] without blocking while the GPU works.
    pub async fn run_async<J: Job>(&mut self, jobs: &[J]) -> Vec<J::Answer> {
        if self.sent_early(jobs) {
            self.ready().await;
            return self.settle_early(jobs);
        }
        if !self.asks_gpu(jobs.len(), |least| least.jobs) {
            return self.run_on_cpu(jobs);
        }
        let mut sweeps = emptied(std::mem::take(&mut self.sweeps));
        sweeps.extend(jobs.iter().filter_map(Job::sweep));
        let mut proposals = std::mem::take(&mut self.proposals);
        let before = self.gpu_counts();
        let outcome = match &mut self.gpu {
            Some(gpu) => gpu.propose(&sweeps, &mut proposals).await,
            None => Ok(()),
        };
        self.count(before);
        self.sweeps = emptied(sweeps);
        if let Err(error) = outcome {
            proposals.clear();
            self.fall_back(error);
        }
        let mut each = proposals.iter().copied();
        let answers = self.settle(jobs, &proposals, |_| each.next());
        self.proposals = proposals;
        answers
    }

    /// Answers what the device proves free, and has the rest from the CPU, by the device's lists where there are any.
    /// `proposal` is asked in the order of the jobs that a device may have.
    fn settle<J: Job>(
        &mut self,
        jobs: &[J],
        proposals: &Proposals,
        mut proposal: impl FnMut(&Sweep<'_>) -> Option<Proposal>,
    ) -> Vec<J::Answer> {
        self.said.clear();
        let (mut free, mut listed) = (0, 0);
        for job in jobs {
            let said = job.sweep().map(|sweep| proposal(&sweep));
            let unfit = matches!(said, None | Some(Some(Proposal::Unfit)));
            self.report.counts.unfit += u64::from(unfit);
            // Also of jobs that were not sent nothing is known.
            let said = said.flatten().unwrap_or(Proposal::Open);
            free += u64::from(said == Proposal::Free);
            listed += u64::from(matches!(said, Proposal::Near { .. }));
            self.said.push(said);
        }
        self.report.counts.settled_by_gpu += free;
        self.report.counts.settled_by_cpu += jobs.len() as u64 - free;
        self.report.counts.listed += listed;
        cpu::run_told(jobs, &self.said, proposals)
    }

    /// Does the same as [`Self::brackets`] without blocking while the GPU works.
    pub async fn brackets_async(
        &mut self,
        paths: &[LinearPath<f32>],
        domain: Domain,
        limits: &Limits<f32>,
    ) -> Vec<Bracket<f32>> {
        let whole = limits.start == 0.0 && limits.horizon == 1.0 && limits.tolerance.is_finite();
        if !whole || !self.asks_gpu(paths.len(), |least| least.tests) {
            return self.brackets_on_cpu(paths, domain, limits);
        }
        let mut free = std::mem::take(&mut self.free);
        let before = self.gpu_counts();
        let outcome = match &mut self.gpu {
            Some(gpu) => gpu.prove(paths, domain, limits.tolerance, &mut free).await,
            None => Ok(()),
        };
        self.count(before);
        if let Err(error) = outcome {
            self.fall_back(error);
            return self.brackets_on_cpu(paths, domain, limits);
        }
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        let left = paths.iter().zip(&free).filter(|(_, free)| !**free);
        open.extend(left.map(|(path, _)| *path));
        self.report.counts.settled_by_gpu += (paths.len() - open.len()) as u64;
        let mut rest = self.brackets_on_cpu(&open, domain, limits).into_iter();
        self.open = open;
        let answers = free
            .iter()
            .filter_map(|free| match free {
                true => Some(Bracket::free(limits)),
                false => rest.next(),
            })
            .collect();
        self.free = free;
        answers
    }
}

/// Empties a list and lets it hold sweeps that borrow from elsewhere. Its memory stays, so nothing is allocated.
fn emptied<'a>(sweeps: Vec<Sweep<'_>>) -> Vec<Sweep<'a>> {
    sweeps.into_iter().map_while(|_| None).collect()
}
