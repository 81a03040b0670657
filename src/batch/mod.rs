//! L4: many pairs at once. One call in, one answer per job out, in the order of the jobs.

pub mod cpu;
pub mod job;

pub use job::{PairJob, PairResult};
