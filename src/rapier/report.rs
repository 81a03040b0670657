//! What a step did, counted and timed.

use super::first_contact::Work;
use crate::batch::{BatchReport, PairResult};
use crate::parry::answers::Counted;

/// Counters and timings of one [`crate::MedialPipeline`] step. Counters cover medial colliders only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// Medial colliders in the world that are enabled.
    pub medial_colliders: usize,
    /// Pairs of medial colliders, one of them awake, whose boxes were near at the start.
    pub pairs: usize,
    /// Of these, the pairs whose contacts were computed in the batch; the others had moved too
    /// little, so that rapier recycles theirs, or are muted.
    pub jobs: usize,
    /// Jobs that the GPU proved free, which the CPU has not looked at.
    pub settled_by_gpu: u64,
    /// Jobs asked of the GPU that it cannot take; the CPU has them.
    pub unfit: u64,
    /// Submissions to the GPU: of this step's first contacts, and of the next one's contacts.
    pub submissions: u64,
    /// Times that the step waited for answers of the GPU: one for each batch.
    pub maps: u64,
    /// Jobs of the batch that had gone to the GPU at the end of the step before.
    pub sent_early: u64,
    /// Jobs, or pieces of their step, of which too much meets to be looked at on the GPU; the CPU has
    /// them.
    pub given_up: u64,
    /// Batches that a GPU was to have and could not take; [`crate::MedialPipeline::batch`] says why.
    pub fallbacks: u64,
    /// Sphere pairs that the batch found near enough to close in the step, and held back by no nearer one.
    pub contacts: usize,
    /// Manifold requests of the narrow phase that the batch had answered.
    pub cache_hits: u64,
    /// Manifold requests computed on the spot: new pairs, bodies changed by the user.
    pub cache_misses: u64,
    /// Manifolds written for pairs of medial colliders, and for all that get one contact only
    /// ([`crate::Effects::full_manifolds`]). Others with rapier's shapes are not
    /// counted.
    pub manifolds: u64,
    /// Tests of intersection, of sensors above all.
    pub intersections: u64,
    /// Continuous queries (first contact) executed.
    pub continuous_queries: u64,
    /// Those of them, on the motions of the step, in which a body turned.
    pub rotating_queries: u64,
    /// Medial pairs asked for their first contacts after rapier's step; a GPU has them in one batch. On the
    /// CPU those that spheres and directions keep apart, or that never come first, take no query. Other
    /// continuous queries are with other shapes, in rapier's own sweeps, or after an impact.
    pub continuous_jobs: usize,
    /// Pairs that the solver had no contacts for because the event loop took them over.
    pub muted: usize,
    /// Impacts resolved within the step.
    pub events: usize,
    /// Bodies that stopped before the step's end, or were carried along, after too many impacts.
    pub frozen: usize,
    /// Times that the world stopped at a first contact ([`crate::Effects::stop`]); each made a step more,
    /// whose work is in all counters.
    pub stops: usize,
    /// Bodies that got speculative contacts ([`crate::Effects::speculative`]), summed over these steps.
    pub speculative: usize,
    /// Node pairs of sphere trees looked at.
    pub culled_nodes: u64,
    /// Elementary tests (cone–cone, sphere–slab) executed.
    pub elementary_tests: u64,
    /// Seconds spent gathering near pairs and in the batch.
    pub batch_seconds: f64,
    /// Seconds spent gathering colliders and choosing the muted pairs.
    pub mute_seconds: f64,
    /// Seconds of the event loop.
    pub event_seconds: f64,
    /// Seconds of rapier's own step, which includes manifolds and continuous queries.
    pub step_seconds: f64,
}

impl StepReport {
    /// Adds the contacts of a job of the batch.
    pub(super) fn add_contacts(&mut self, result: &PairResult) {
        self.contacts += result.contacts.len();
        self.culled_nodes += u64::from(result.counts.nodes);
        self.elementary_tests += u64::from(result.counts.tests);
    }

    /// Adds what the narrow phase asked for besides the batch.
    pub(super) fn add_answered(&mut self, counted: &Counted) {
        self.cache_hits += counted.hits;
        self.cache_misses += counted.misses;
        self.manifolds += counted.manifolds;
        self.intersections += counted.intersections;
        self.continuous_queries += counted.casts;
        self.culled_nodes += counted.nodes;
        self.elementary_tests += counted.tests;
    }

    /// Adds what the searches for first contacts took.
    pub(super) fn add_searched(&mut self, work: &Work) {
        self.continuous_queries += work.queries;
        self.rotating_queries += work.rotating;
        self.culled_nodes += work.nodes;
        self.elementary_tests += work.tests;
    }

    /// Adds what the backend did between two of its reports.
    pub(super) fn add_sent(&mut self, before: &BatchReport, after: &BatchReport) {
        self.settled_by_gpu += after.settled_by_gpu - before.settled_by_gpu;
        self.unfit += after.unfit - before.unfit;
        self.submissions += after.submissions - before.submissions;
        self.maps += after.maps - before.maps;
        self.sent_early += after.sent_early - before.sent_early;
        self.given_up += after.given_up - before.given_up;
        self.fallbacks += after.fallbacks - before.fallbacks;
    }

    /// Adds what another part of the same step did.
    pub(super) fn add(&mut self, part: &Self) {
        self.medial_colliders = part.medial_colliders;
        self.pairs += part.pairs;
        self.jobs += part.jobs;
        self.settled_by_gpu += part.settled_by_gpu;
        self.unfit += part.unfit;
        self.submissions += part.submissions;
        self.maps += part.maps;
        self.sent_early += part.sent_early;
        self.given_up += part.given_up;
        self.fallbacks += part.fallbacks;
        self.contacts += part.contacts;
        self.cache_hits += part.cache_hits;
        self.cache_misses += part.cache_misses;
        self.manifolds += part.manifolds;
        self.intersections += part.intersections;
        self.continuous_queries += part.continuous_queries;
        self.rotating_queries += part.rotating_queries;
        self.continuous_jobs += part.continuous_jobs;
        self.muted += part.muted;
        self.events += part.events;
        self.frozen += part.frozen;
        self.speculative += part.speculative;
        self.culled_nodes += part.culled_nodes;
        self.elementary_tests += part.elementary_tests;
        self.batch_seconds += part.batch_seconds;
        self.mute_seconds += part.mute_seconds;
        self.event_seconds += part.event_seconds;
        self.step_seconds += part.step_seconds;
        self.stops += part.stops;
    }
}
