//! Answers the jobs of a batch on the CPU, on several threads with feature `parallel`. Jobs are independent, so the
//! answers do not depend on the number of threads.

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

/// As [`run`], but for the jobs that are known to be free.
#[cfg(feature = "gpu")]
pub(super) fn run_but_free<J: Job>(jobs: &[J], free: &[bool]) -> Vec<J::Answer> {
    let answer = |(job, free): (&J, &bool)| match free {
        true => job.free(),
        false => job.answer(),
    };
    #[cfg(feature = "parallel")]
    return jobs
        .par_iter()
        .zip(free)
        .with_min_len(J::PER_THREAD)
        .map(answer)
        .collect();
    #[cfg(not(feature = "parallel"))]
    jobs.iter().zip(free).map(answer).collect()
}
