//! Many pairs at once (layer 4): contacts at fixed poses, or first contacts in motion, on the CPU or a GPU. A call
//! takes a list of jobs and returns their answers in the same order.
//!
//! # Files
//! - `job.rs` has jobs and answers, `backend.rs` decides where they run, `cpu.rs` answers them, `counts.rs` counts
//!   them.
//! - A GPU (`on_device.rs`, `gpu/`) only says what certainly does not meet; it never computes an answer.
//!   `calibration.rs` measures from which batch sizes on it pays, `early.rs` finds answers to jobs that were sent to it
//!   in advance.

mod backend;
#[cfg(feature = "gpu")]
mod calibration;
mod counts;
pub mod cpu;
#[cfg(feature = "gpu")]
mod early;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod job;
#[cfg(feature = "gpu")]
mod on_device;

pub use backend::{Backend, Batch, BatchReport};
#[cfg(feature = "gpu")]
pub use calibration::Calibration;
pub use counts::BatchCounts;
pub use job::{Job, PairJob, PairResult, Sweep, ToiJob, ToiResult};
