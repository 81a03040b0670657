//! L4: many pairs at once, contacts at fixed poses or first contacts in motion. One call in, one
//! answer per job out, in the order of the jobs.

pub mod cpu;
pub mod job;

pub use job::{Job, PairJob, PairResult, ToiJob, ToiResult};
