//! The plan that a pipeline gives its dispatcher for the time of rapier's step, [`NarrowPhasePlan`], and the account
//! that the dispatcher gives back, [`Tally`].
//!
//! Pairs are found by an exact key: both shapes and every bit of the relative pose. So a contact that is known is
//! exactly the one asked for, or it is computed on the spot.

use crate::batch::{Job, PairJob, PairResult};
use crate::math::counters::counters;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use crate::pair::first_contact::Counts;
use crate::parry::contacts::contact_reduction::Turn;
use crate::parry::corrections::locked_axes::LockedBodies;
use crate::parry::shape_id::ShapeId;
use parry3d::bounding_volume::BoundingVolume;
use parry3d::shape::Shape;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// A key for two shapes, at exactly one relative pose or at any. It is valid as long as both shapes exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PairKey {
    shapes: [ShapeId; 2],
    /// Bits of the relative pose; `None` for all poses.
    pose: Option<[u32; 7]>,
}

impl PairKey {
    /// The key of two shapes at a relative pose. At least one of them must be medial.
    pub fn new(shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> Self {
        let (t, r) = (pos12.translation, pos12.rotation);
        Self {
            pose: Some([t.x, t.y, t.z, r.x, r.y, r.z, r.w].map(Real::to_bits)),
            ..Self::anywhere(shape1, shape2)
        }
    }

    /// The key of two shapes at any pose: for shapes that no other collider has.
    pub fn anywhere(shape1: &dyn Shape, shape2: &dyn Shape) -> Self {
        Self {
            shapes: [shape1, shape2].map(ShapeId::new),
            pose: None,
        }
    }
}

/// Which pairs get only their deepest contact.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SinglePointPairs {
    /// Whether pairs do of which neither shape is in `own`.
    pub others: bool,
    /// Whether pairs of a mesh do, by its instance id. If the two meshes of a pair differ, it gets all contacts.
    pub own: HashMap<u64, bool>,
}

impl SinglePointPairs {
    fn contains(&self, shapes: [&dyn Shape; 2]) -> bool {
        let id = |s: &dyn Shape| s.as_shape::<MedialMesh>().map_or(0, |m| m.instance_id());
        let own = shapes.map(|s| self.own.get(&id(s)));
        if own == [None; 2] {
            self.others
        } else {
            own.into_iter().flatten().all(|one| *one)
        }
    }
}

/// Computes the contacts of a pair that are not known, exactly as those that are, so that it makes no difference to the
/// world which pairs are known. `None` if contacts of this pair are not predicted.
pub type Compute = Box<dyn Fn(PairJob) -> Option<PairResult> + Send + Sync>;

/// Tells how the body of a mesh turns in the step; `None` if that is not known.
pub type Turns = Box<dyn Fn(&MedialMesh) -> Option<Turn> + Send + Sync>;

/// Plan that the dispatcher goes by while rapier steps. It does not change in that time. The default knows nothing and
/// mutes nothing: all contacts are those of the poses asked about.
#[derive(Default)]
pub struct NarrowPhasePlan {
    /// Contacts computed before the step, each with the prediction distance for which they hold, a length.
    pub known: HashMap<PairKey, (Real, PairResult)>,
    /// Computes contacts that are not known.
    pub compute: Option<Compute>,
    /// Tells how the body of a mesh turns.
    pub turns: Option<Turns>,
    /// Pairs that get no contacts, because the event loop resolves them.
    pub muted: HashSet<PairKey>,
    /// Pairs that get only their deepest contact.
    pub single_point_pairs: SinglePointPairs,
    /// The bodies, if some have locked axes.
    pub locked_bodies: Option<LockedBodies>,
    /// Answer to rapier's own sweeps of medial bodies.
    pub sweeps: Sweeps,
}

/// Answer to rapier's own sweeps of medial bodies, which are casts of solid pairs in turning motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sweeps {
    /// Sweeps are answered like all other casts, as outside of rapier's step.
    #[default]
    AsCasts,
    /// Nothing, because the event loop resolves what these bodies meet.
    FindNothing,
    /// First contacts, but for primitives that are deep in the other shape at the start already.
    PassOverlaps,
}

impl NarrowPhasePlan {
    /// Whether a pair is muted.
    pub fn is_muted(&self, shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> bool {
        !self.muted.is_empty() && self.muted.contains(&PairKey::new(shape1, shape2, pos12))
    }

    /// Whether a pair gets only its deepest contact. Only medial shapes of the pair decide.
    pub fn has_single_point(&self, shape1: &dyn Shape, shape2: &dyn Shape) -> bool {
        self.single_point_pairs.contains([shape1, shape2])
    }

    /// How the body of a mesh turns in the step; `None` if that is not known.
    pub fn turn(&self, mesh: &MedialMesh) -> Option<Turn> {
        self.turns.as_ref()?(mesh)
    }

    fn known(&self, job: &PairJob) -> Option<&PairResult> {
        let key = PairKey::new(&job.mesh1, &job.mesh2, &job.pos12);
        let (prediction, result) = self.known.get(&key)?;
        (job.prediction <= *prediction).then_some(result)
    }

    fn compute(&self, job: PairJob) -> PairResult {
        // rapier's boxes are wider than those of known pairs: most of what is not known is apart.
        let near = job.mesh1.aabb().loosened(job.prediction);
        if !near.intersects(&job.mesh2.aabb().transform_by(&job.pos12)) {
            return PairResult::default();
        }
        let compute = self.compute.as_ref();
        let predicted = compute.and_then(|compute| compute(job.clone()));
        predicted.unwrap_or_else(|| job.answer())
    }
}

counters! {
    /// Counters of what a dispatcher did.
    #[derive(Eq)]
    pub struct DispatcherCounts {
        /// Requests for manifolds whose contacts were known.
        pub hits: u64,
        /// Requests for manifolds whose contacts were computed on the spot.
        pub misses: u64,
        /// Shape casts (searches for a first contact).
        pub casts: u64,
        /// Manifolds that were written.
        pub manifolds: u64,
        /// Tests whether two shapes intersect, as sensors need.
        pub intersections: u64,
        /// Tree nodes and elementary tests that this took.
        pub work: Counts,
    }
}

/// Account that a dispatcher gives after rapier's step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Requests, manifolds, casts and the work they took.
    pub counts: DispatcherCounts,
    /// Instance ids of pairs whose contacts were not known.
    pub missed: Vec<[u64; 2]>,
    /// Depth of the deepest contact that was written, a length; the largest number if others wrote some.
    pub depth: Real,
}

/// The place where a pipeline leaves the plan of a step for its dispatcher, and the dispatcher its tally.
#[derive(Default)]
pub struct PlanExchange {
    plan: RwLock<Arc<NarrowPhasePlan>>,
    tally: Mutex<Tally>,
    /// Whether the user turned off all contacts of a pair, as far as was noted in this step.
    contacts_off: RwLock<HashMap<PairKey, bool>>,
}

impl PlanExchange {
    /// Leaves the plan that the dispatcher goes by until [`Self::end_step`], and begins a tally.
    pub fn begin_step(&self, plan: Arc<NarrowPhasePlan>) {
        *self.plan.write().unwrap_or_else(PoisonError::into_inner) = plan;
        self.note(|tally| *tally = Tally::default());
    }

    /// Takes plan and tally back, and forgets which pairs rapier's sweeps were to let pass.
    pub fn end_step(&self) -> Tally {
        *self.plan.write().unwrap_or_else(PoisonError::into_inner) = Arc::default();
        let contacts_off = self.contacts_off.write();
        contacts_off.unwrap_or_else(PoisonError::into_inner).clear();
        self.note(std::mem::take)
    }

    /// The plan of the step; the default one outside of rapier's step.
    pub fn plan(&self) -> Arc<NarrowPhasePlan> {
        Arc::clone(&self.plan.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Changes the tally.
    pub fn note<T>(&self, change: impl FnOnce(&mut Tally) -> T) -> T {
        change(&mut self.tally.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Calls `with` on the contacts of a pair: those known if there are some, else those computed now.
    pub fn contacts<T>(&self, job: PairJob, with: impl FnOnce(&PairResult) -> T) -> T {
        let plan = self.plan();
        if let Some(result) = plan.known(&job) {
            self.note(|tally| tally.counts.hits += 1);
            return with(result);
        }
        let ids = [&job.mesh1, &job.mesh2].map(|m| m.instance_id());
        let result = plan.compute(job);
        self.note(|tally| {
            tally.counts.misses += 1;
            tally.counts.work += result.counts;
            tally.missed.push(ids);
        });
        with(&result)
    }

    /// Notes, under the keys of a pair, whether the user turned off some of its contacts. If all contacts that are
    /// noted of it are off, rapier's sweeps let the pair pass in this step.
    pub fn note_contacts_off(&self, keys: &[PairKey], off: bool) {
        let mut contacts_off = self
            .contacts_off
            .write()
            .unwrap_or_else(PoisonError::into_inner);
        for key in keys {
            *contacts_off.entry(*key).or_insert(true) &= off;
        }
    }

    /// Whether the user turned off all contacts of a pair: rapier's sweeps then let it pass.
    pub fn are_contacts_off(&self, shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> bool {
        let contacts_off = self
            .contacts_off
            .read()
            .unwrap_or_else(PoisonError::into_inner);
        let noted = |key| contacts_off.get(&key) == Some(&true);
        !contacts_off.is_empty()
            && (noted(PairKey::new(shape1, shape2, pos12))
                || noted(PairKey::anywhere(shape1, shape2)))
    }
}
