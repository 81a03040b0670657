//! L4: many pairs at once, contacts at fixed poses or first contacts in motion. One call in, one
//! answer per job out, in the order of the jobs.

mod backend;
#[cfg(feature = "gpu")]
mod calibration;
pub mod cpu;
#[cfg(feature = "gpu")]
mod early;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod job;

pub use backend::{Backend, Batch, BatchReport};
#[cfg(feature = "gpu")]
pub use calibration::Calibration;
pub use job::{Job, PairJob, PairResult, Sweep, ToiJob, ToiResult};
