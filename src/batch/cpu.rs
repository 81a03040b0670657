//! The batch on the CPU: jobs are independent, so the result does not depend on the number of
//! threads.

use super::job::{PairJob, PairResult};
use crate::pair::contacts;
#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Fewest jobs worth handing to other threads: one is a few microseconds, as waking a thread is.
#[cfg(feature = "parallel")]
const JOBS_PER_THREAD: usize = 8;

/// Answers all jobs, in their order.
pub fn run(jobs: &[PairJob]) -> Vec<PairResult> {
    #[cfg(feature = "parallel")]
    return jobs
        .par_iter()
        .with_min_len(JOBS_PER_THREAD)
        .map(answer)
        .collect();
    #[cfg(not(feature = "parallel"))]
    jobs.iter().map(answer).collect()
}

fn answer(job: &PairJob) -> PairResult {
    let (contacts, counts) = contacts(&job.mesh1, &job.mesh2, &job.pos12, job.prediction);
    PairResult { contacts, counts }
}
