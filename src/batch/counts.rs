//! Counters of batches: one type for a [`Batch`](super::Batch), for the GPU in it, and for what a step's report tells
//! of them.

use crate::math::counters::counters;

counters! {
    /// Counters of what a batch has done. A *job* is one pair of meshes or one elementary test. A GPU by itself counts
    /// submissions, maps, and what it gave up or did not list.
    #[derive(Eq)]
    pub struct BatchCounts {
        /// Jobs that the GPU proved not to meet, and which the CPU did not look at.
        pub settled_by_gpu: u64,
        /// Jobs that the CPU answered, whether the GPU was asked before or not.
        pub settled_by_cpu: u64,
        /// Jobs of the CPU for which the GPU listed the primitives that may meet, so that the CPU did not search.
        pub listed: u64,
        /// Jobs that the GPU could not take, since a pose or size was not finite or too large. The CPU computed them.
        pub unfit: u64,
        /// Submissions to the GPU: one for each batch.
        pub submissions: u64,
        /// Times that the CPU waited for answers of the GPU: one for each submission.
        pub maps: u64,
        /// Jobs that had been sent to the GPU before their answers were asked for
        /// ([`Batch::submit`](super::Batch::submit)): in a step, contacts sent at the end of the step before.
        pub sent_early: u64,
        /// Jobs, or pieces of their step, of which too many primitives meet to be looked at on the GPU, or which were
        /// never begun there. The CPU computed them.
        pub given_up: u64,
        /// Jobs, or pieces of their step, whose list of primitives found no room on the GPU, or is not whole.
        pub unlisted: u64,
        /// Batches for the GPU that it could not take; [`BatchReport::error`](super::BatchReport::error) says why. The
        /// CPU computed them.
        pub fallbacks: u64,
    }
}
