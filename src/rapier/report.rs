//! What a step did, counted and timed.

/// Counters and timings of one [`crate::MedialPipeline`] step. Counters cover medial colliders only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// Medial colliders in the world that are enabled.
    pub medial_colliders: usize,
    /// Pairs of medial colliders, one of them awake, whose boxes were near at the start.
    pub pairs: usize,
    /// Of these, the pairs whose contacts were computed in the batch; the others had moved too
    /// little, and rapier recycles theirs.
    pub jobs: usize,
    /// Jobs that the GPU proved free, which the CPU has not looked at.
    pub settled_by_gpu: u64,
    /// Jobs asked of the GPU that it cannot take; the CPU has them.
    pub unfit: u64,
    /// Submissions to the GPU.
    pub submissions: u64,
    /// Times that the step waited for answers of the GPU.
    pub maps: u64,
    /// Primitive pairs that the GPU could not prove free.
    pub survivors: u64,
    /// Batches that a GPU was to have and could not take; [`crate::MedialPipeline::batch`] says why.
    pub fallbacks: u64,
    /// Sphere pairs that the batch found within the prediction distance.
    pub contacts: usize,
    /// Manifold requests of the narrow phase that the batch had answered.
    pub cache_hits: u64,
    /// Manifold requests computed on the spot: new pairs, bodies changed by the user.
    pub cache_misses: u64,
    /// Continuous queries (first contact) executed.
    pub continuous_queries: u64,
    /// Those of them, on the motions of the step, in which a body turned.
    pub rotating_queries: u64,
    /// First contacts of medial pairs that were one batch after rapier's step; other continuous queries
    /// are with other shapes, in rapier's own sweeps, or repeated after an impact.
    pub continuous_jobs: usize,
    /// Pairs that the solver had no contacts for because the event loop took them over.
    pub muted: usize,
    /// Impacts resolved within the step.
    pub events: usize,
    /// Bodies that stopped before the step's end, or were carried along, after too many impacts.
    pub frozen: usize,
    /// Node pairs of sphere trees looked at.
    pub culled_nodes: u64,
    /// Elementary tests (cone–cone, sphere–slab) executed.
    pub elementary_tests: u64,
    /// Seconds spent gathering pairs and in the batch.
    pub batch_seconds: f64,
    /// Seconds spent on choosing the muted pairs.
    pub mute_seconds: f64,
    /// Seconds of the event loop.
    pub event_seconds: f64,
    /// Seconds of rapier's own step, which includes manifolds and continuous queries.
    pub step_seconds: f64,
}
