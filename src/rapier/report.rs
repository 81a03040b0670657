//! [`StepReport`]: what a step did, counted and timed.

use crate::batch::{BatchReport, PairResult};
use crate::parry::answers::Counted;
use crate::rapier::impacts::outcome::Outcome;
use crate::rapier::impacts::toi_query::Work;

/// Counters and times of one step of a [`crate::MedialPipeline`], about medial colliders only. Three counters tell
/// most:
/// - [`Self::events`]: impacts that were resolved within the step. 0 in a quiet scene, dozens when bodies fly.
/// - [`Self::continuous_queries`]: how often a first contact was searched for. Thousands mean that many bodies move
///   fast, or that one has parts of (nearly) no thickness, and the step is slow.
/// - [`Self::frozen`]: bodies that stopped before the end of the step, after too many impacts. A few are normal in
///   a crash. Otherwise bodies are pressed where there is no room, or very thin ones were spawned inside each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// Number of enabled medial colliders in the world.
    pub medial_colliders: usize,
    /// Pairs of medial colliders, at least one of them awake, whose bounding boxes were near each other at the start.
    pub pairs: usize,
    /// Pairs of these whose contacts were computed in one batch before rapier's step. The others had moved so
    /// little that rapier keeps their contacts, or are muted ([`Self::muted`]).
    pub jobs: usize,
    /// Pairs that the GPU proved not to meet, and which the CPU did not look at.
    pub settled_by_gpu: u64,
    /// Pairs for which the GPU listed the primitives that may meet, so that the CPU did not search for them.
    pub listed: u64,
    /// Pairs that the GPU could not take, since a number was not finite or too large. The CPU computed them.
    pub unfit: u64,
    /// Submissions to the GPU: for the first contacts of this step, and for the contacts of the next one.
    pub submissions: u64,
    /// Times that the step waited for answers of the GPU.
    pub maps: u64,
    /// Pairs whose contacts were sent to the GPU at the end of the step before.
    pub sent_early: u64,
    /// Pairs, or pieces of their step, of which too many primitives meet to be looked at on the GPU. The CPU computed
    /// them.
    pub given_up: u64,
    /// Batches for the GPU that it could not take; [`crate::MedialPipeline::batch`] says why. The CPU computed them.
    pub fallbacks: u64,
    /// Contacts found in the batch: pairs of spheres near enough to touch within the step, without those that cannot
    /// touch while a nearer contact holds.
    pub contacts: usize,
    /// Contact manifolds that rapier asked for and that the batch had computed. (A manifold is a set of contacts
    /// with one normal.)
    pub cache_hits: u64,
    /// Contact manifolds that rapier asked for and that were computed only then: those of new pairs, and of bodies that
    /// you changed.
    pub cache_misses: u64,
    /// Contact manifolds given to rapier for pairs of two medial colliders, and for pairs that get one contact only
    /// ([`crate::Effects::full_manifolds`]). Other manifolds with rapier's shapes are not counted.
    pub manifolds: u64,
    /// Tests whether two shapes intersect, mostly for sensors.
    pub intersections: u64,
    /// Searches for a first contact (continuous queries).
    pub continuous_queries: u64,
    /// Continuous queries after rapier's step in which a body turned and was followed on its exact path.
    pub rotating_queries: u64,
    /// Pairs of two medial colliders whose first contact was asked for at the end of rapier's step, before any impact.
    /// Not all take a query: bounding spheres or a direction may keep the two apart, or an earlier impact comes
    /// between. Other continuous queries are with rapier's shapes, by rapier's own sweeps, or after an impact.
    pub continuous_jobs: usize,
    /// Fast pairs whose contacts were kept from rapier's solver, because their first contact is resolved after
    /// rapier's step.
    pub muted: usize,
    /// Impacts resolved within the step.
    pub events: usize,
    /// Bodies that stopped before the step's end, or were carried along by what pushed them, after too many impacts
    /// (more than 16).
    pub frozen: usize,
    /// Node pairs and elementary tests that first contacts took, of [`crate::MedialOptions::budget`].
    pub spent: u64,
    /// Bodies that stopped before the step's end because the budget was spent: nothing is known to be free further.
    /// They go on in the next step, at the speed they had.
    pub waiting: usize,
    /// Times that the whole world stopped at a first contact ([`crate::Effects::stop`]). Each stop makes another step,
    /// whose work is included in all counters.
    pub stops: usize,
    /// Bodies that got speculative contacts ([`crate::Effects::speculative`]), summed over the steps between stops.
    pub speculative: usize,
    /// Pairs of nodes of the bounding sphere trees that were looked at.
    pub culled_nodes: u64,
    /// Elementary tests (cone against cone, sphere against slab) that were computed.
    pub elementary_tests: u64,
    /// Seconds spent on finding near pairs and computing their contacts before rapier's step.
    pub batch_seconds: f64,
    /// Seconds spent on gathering colliders and choosing the muted pairs.
    pub mute_seconds: f64,
    /// Seconds spent on impacts after rapier's step.
    pub event_seconds: f64,
    /// Seconds of rapier's own step, including the contacts and casts that it asked this crate for.
    pub step_seconds: f64,
}

impl StepReport {
    /// Adds the contacts of a job of the batch.
    pub(crate) fn add_contacts(&mut self, result: &PairResult) {
        self.contacts += result.contacts.len();
        self.culled_nodes += u64::from(result.counts.nodes);
        self.elementary_tests += u64::from(result.counts.tests);
    }

    /// Adds what the narrow phase asked for besides the batch.
    pub(crate) fn add_answered(&mut self, counted: &Counted) {
        self.cache_hits += counted.hits;
        self.cache_misses += counted.misses;
        self.manifolds += counted.manifolds;
        self.intersections += counted.intersections;
        self.continuous_queries += counted.casts;
        self.culled_nodes += counted.nodes;
        self.elementary_tests += counted.tests;
    }

    /// Adds what the impacts within the step did.
    pub(crate) fn add_impacts(&mut self, outcome: &Outcome) {
        self.continuous_jobs = outcome.jobs;
        self.events = outcome.events;
        self.frozen = outcome.frozen;
        self.waiting = outcome.waiting;
    }

    /// Adds what the searches for first contacts took.
    pub(crate) fn add_searched(&mut self, work: &Work) {
        self.continuous_queries += work.queries;
        self.rotating_queries += work.rotating;
        self.culled_nodes += work.nodes;
        self.elementary_tests += work.tests;
        self.spent += work.spent();
    }

    /// Adds what the backend did between two of its reports.
    pub(crate) fn add_sent(&mut self, before: &BatchReport, after: &BatchReport) {
        self.settled_by_gpu += after.settled_by_gpu - before.settled_by_gpu;
        self.listed += after.listed - before.listed;
        self.unfit += after.unfit - before.unfit;
        self.submissions += after.submissions - before.submissions;
        self.maps += after.maps - before.maps;
        self.sent_early += after.sent_early - before.sent_early;
        self.given_up += after.given_up - before.given_up;
        self.fallbacks += after.fallbacks - before.fallbacks;
    }

    /// Adds what another part of the same step did.
    pub(crate) fn add(&mut self, part: &Self) {
        self.medial_colliders = part.medial_colliders;
        self.pairs += part.pairs;
        self.jobs += part.jobs;
        self.settled_by_gpu += part.settled_by_gpu;
        self.listed += part.listed;
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
        self.spent += part.spent;
        self.waiting += part.waiting;
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
