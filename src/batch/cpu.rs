//! Answers the jobs of a batch on the CPU, on several threads with feature `parallel`. Jobs are independent, so the
//! answers do not depend on the number of threads.

#[cfg(feature = "gpu")]
use super::gpu::{Proposal, Proposals};
use super::job::Job;
#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Answers all jobs, in their order; with feature `parallel` on rayon's current thread pool. The
/// bits of the answers are the same for any number of threads.
pub fn run<J: Job>(jobs: &[J]) -> Vec<J::Answer> {
    #[cfg(feature = "parallel")]
    return jobs
        .par_iter()
        .with_min_len(J::PER_THREAD)
        .map(Job::answer)
        .collect();
    #[cfg(not(feature = "parallel"))]
    jobs.iter().map(Job::answer).collect()
}

/// Does the same as [`run`], with what a GPU said of each job.
#[cfg(feature = "gpu")]
pub(super) fn run_told<J: Job>(
    jobs: &[J],
    said: &[Proposal],
    proposals: &Proposals,
) -> Vec<J::Answer> {
    let answer = |(job, &said): (&J, &Proposal)| match said {
        Proposal::Free => job.free(),
        Proposal::Near { .. } => job.answer_near(proposals.near(said)),
        Proposal::Open | Proposal::Unfit => job.answer(),
    };
    #[cfg(feature = "parallel")]
    return jobs
        .par_iter()
        .zip(said)
        .with_min_len(J::PER_THREAD)
        .map(answer)
        .collect();
    #[cfg(not(feature = "parallel"))]
    jobs.iter().zip(said).map(answer).collect()
}
