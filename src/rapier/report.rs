//! [`StepReport`]: what a step did, counted and timed.

use crate::batch::{BatchCounts, PairResult};
use crate::math::counters::counters;
use crate::pair::first_contact::Counts;
use crate::parry::narrow_phase_plan::DispatcherCounts;
use crate::rapier::impacts::outcome::Outcome;
use crate::rapier::impacts::toi_query::Work;

counters! {
    /// Counters and times of one step of a [`crate::MedialPipeline`]. They are about medial colliders only. Three
    /// counters tell most:
    /// - [`Self::events`]: impacts that were resolved within the step. 0 in a quiet scene, dozens when bodies fly.
    /// - [`Self::continuous_queries`]: how often a first contact was searched for. Thousands mean that many bodies move
    ///   fast, or that one has parts of (nearly) no thickness, and the step is slow.
    /// - [`Self::frozen`]: bodies that stopped before the end of the step, after too many impacts. A few are normal
    ///   in a crash. If there is no crash, bodies are pressed into a place without room, or very thin ones were
    ///   spawned inside each other.
    #[non_exhaustive]
    pub struct StepReport {
        /// Number of enabled medial colliders in the world.
        pub medial_colliders: usize,
        /// Colliders that the step looked at for impacts: all but sensors, or, in a world of many still ones, those
        /// that move and those near them, as long as nothing gets to others ([`Self::completed`]). Summed over the
        /// steps between stops; 0 where nothing moves.
        pub participants: usize,
        /// Times that a step had left out still colliders and looked at all of them after all, because something may
        /// have got to one, or rapier woke one.
        pub completed: usize,
        /// Pairs of medial colliders, at least one of the two awake, whose bounding boxes were near each other at the
        /// start of the step.
        pub pairs: usize,
        /// How many of these pairs had their contacts computed in one batch before rapier's step. The others had
        /// moved so little that rapier keeps their contacts, or are muted ([`Self::muted`]).
        pub jobs: usize,
        /// Counters of the backend: jobs that a GPU settled, lists, submissions.
        pub batch: BatchCounts,
        /// Contacts found in the batch: pairs of spheres near enough to touch within the step. Pairs that cannot
        /// touch while a nearer contact holds are left out.
        pub contacts: usize,
        /// Contact manifolds that rapier asked for and that the batch had computed. (A manifold is a set of contacts
        /// with one normal.)
        pub cache_hits: u64,
        /// Contact manifolds that were computed only when rapier asked for them: those of new pairs, and of bodies
        /// that you changed.
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
        /// Pairs of two medial colliders whose first contact was asked for at the end of rapier's step, before any
        /// impact. Not all of these need a query: bounding spheres or a separating direction may
        /// show that the two stay apart, or an earlier impact may change their motion. All other
        /// continuous queries are with rapier's shapes, by rapier's own sweeps, or after an impact.
        pub continuous_jobs: usize,
        /// Fast pairs whose contacts were kept from rapier's solver, because their first contact is resolved after
        /// rapier's step.
        pub muted: usize,
        /// Impacts resolved within the step.
        pub events: usize,
        /// Bodies that had too many impacts in the step (more than 16): they stopped before its
        /// end, or were carried along by what pushed them.
        pub frozen: usize,
        /// How much of [`crate::MedialOptions::budget`] was spent: node pairs and elementary tests for first contacts,
        /// and looks at two convex pieces as a whole, each of which counts as 16. Where a step looked at all colliders
        /// after all ([`Self::completed`]), its first search is not counted.
        pub spent: u64,
        /// Bodies that stopped before the step's end because the budget was spent: it is not known whether their path
        /// is free beyond that point. They go on in the next step, at the speed they had, unless its budget does not
        /// pay for its first impact.
        pub waiting: usize,
        /// Times that the whole world stopped at a first contact ([`crate::Effects::stop`]). Each stop makes another
        /// step, whose work is included in all counters.
        pub stops: usize,
        /// Bodies that got speculative contacts ([`crate::Effects::speculative`]), summed over the steps between stops.
        pub speculative: usize,
        /// Pairs of nodes of the bounding sphere trees that were looked at.
        pub culled_nodes: u64,
        /// Elementary tests (cone against cone, sphere against slab) that were computed.
        pub elementary_tests: u64,
        /// Seconds spent on finding near pairs and computing their contacts before rapier's step.
        pub batch_seconds: f64,
        /// Seconds spent on gathering colliders and choosing the pairs to be muted ([`Self::muted`]).
        pub mute_seconds: f64,
        /// Seconds spent on impacts after rapier's step.
        pub event_seconds: f64,
        /// Seconds of rapier's own step, including the contacts and casts that it asked this crate for.
        pub step_seconds: f64,
    }
}

impl StepReport {
    fn add_work(&mut self, work: Counts) {
        self.culled_nodes += work.nodes;
        self.elementary_tests += work.tests;
    }

    /// Adds the contacts of a job of the batch.
    pub(crate) fn add_contacts(&mut self, result: &PairResult) {
        self.contacts += result.contacts.len();
        self.add_work(result.counts);
    }

    /// Adds what the narrow phase asked for besides the batch.
    pub(crate) fn add_answered(&mut self, counts: DispatcherCounts) {
        self.cache_hits += counts.hits;
        self.cache_misses += counts.misses;
        self.manifolds += counts.manifolds;
        self.intersections += counts.intersections;
        self.continuous_queries += counts.casts;
        self.add_work(counts.work);
    }

    /// Adds what the impacts within the step did.
    pub(crate) fn add_impacts(&mut self, outcome: &Outcome) {
        self.continuous_jobs += outcome.jobs;
        self.events += outcome.events;
        self.frozen += outcome.frozen;
        self.waiting += outcome.waiting;
    }

    /// Adds what the searches for first contacts took.
    pub(crate) fn add_searched(&mut self, work: Work) {
        self.continuous_queries += work.queries;
        self.rotating_queries += work.rotating;
        self.add_work(work.counts);
        self.spent += work.spent();
    }
}
