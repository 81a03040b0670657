//! The contacts that were computed in a batch before rapier's step, kept until rapier's narrow phase asks for them; and
//! which pairs it is to get no contacts of.
//!
//! They are found by an exact key: both shapes and every bit of the relative pose. So an answer is either exactly
//! the one asked for, or it is not there and is computed on the spot.

use crate::batch::{Job, PairJob, PairResult};
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use parry3d::bounding_volume::BoundingVolume;
use parry3d::shape::Shape;
use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError, RwLock};

/// A key for two shapes, at exactly one relative pose or at any. It is valid as long as both shapes exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    shapes: [Id; 2],
    /// `None`: wherever they are.
    pose: Option<[u32; 7]>,
}

/// Which shape it is, among those alive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Id {
    /// Instance id of a medial mesh: one collider's.
    Medial(u64),
    /// Address of another shape: clones of a `SharedShape`, which are the same shape, have the same.
    Other(usize),
}

impl Id {
    fn new(shape: &dyn Shape) -> Self {
        match shape.as_shape::<MedialMesh>() {
            Some(mesh) => Self::Medial(mesh.instance_id()),
            None => Self::Other(std::ptr::from_ref(shape).addr()),
        }
    }
}

impl Key {
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
            shapes: [shape1, shape2].map(Id::new),
            pose: None,
        }
    }
}

/// What a dispatcher did since the last [`Answers::take_counts`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Requests for manifolds that were answered from the batch.
    pub hits: u64,
    /// Requests for manifolds that were computed on the spot.
    pub misses: u64,
    /// Shape casts (searches for a first contact).
    pub casts: u64,
    /// Pairs of tree nodes that were looked at, not counting the batch.
    pub nodes: u64,
    /// Elementary tests that were computed, not counting the batch.
    pub tests: u64,
    /// Manifolds that were written.
    pub manifolds: u64,
    /// Tests whether two shapes intersect, as sensors need.
    pub intersections: u64,
}

/// Which pairs get only their deepest contact.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OnePoint {
    /// Whether pairs do of which neither shape is in `own`.
    pub others: bool,
    /// Whether pairs of a mesh do, by its instance id. If the two meshes of a pair differ, it gets all contacts.
    pub own: HashMap<u64, bool>,
}

impl OnePoint {
    fn holds(&self, ids: [u64; 2]) -> bool {
        let own = ids.map(|id| self.own.get(&id));
        let mut named = own.into_iter().flatten();
        let some = own != [None; 2];
        if some {
            named.all(|one| *one)
        } else {
            self.others
        }
    }
}

/// Computes the contacts of a pair that was not in the batch, exactly as the batch would have, so that it makes no
/// difference to the world which pairs were in it. `None` if the batch would not have computed this pair.
pub type Compute = Box<dyn Fn(PairJob) -> Option<PairResult> + Send + Sync>;

/// The answers of one batch, and orders for single pairs, which a pipeline shares with its dispatcher.
#[derive(Default)]
pub struct Answers {
    known: RwLock<HashMap<Key, (Real, PairResult)>>,
    compute: RwLock<Option<Compute>>,
    hits: AtomicU64,
    misses: AtomicU64,
    casts: AtomicU64,
    nodes: AtomicU64,
    tests: AtomicU64,
    missed: Mutex<Vec<[u64; 2]>>,
    muted: RwLock<HashSet<Key>>,
    swept_elsewhere: AtomicBool,
    /// Whether all contacts of a pair were turned off by the user.
    passing: RwLock<HashMap<Key, bool>>,
    one_point: RwLock<OnePoint>,
    manifolds: AtomicU64,
    intersections: AtomicU64,
    /// Bits of a length that is not negative: those are in the order of their numbers.
    depth: AtomicU32,
}

impl Answers {
    /// Replaces all answers by those of a new batch, each with the prediction distance for which it holds. `compute` is
    /// called for pairs that are not among them.
    pub fn replace(
        &self,
        answers: impl Iterator<Item = ((Key, Real), PairResult)>,
        compute: Compute,
    ) {
        *self.compute.write().unwrap_or_else(PoisonError::into_inner) = Some(compute);
        let mut known = self.known.write().unwrap_or_else(PoisonError::into_inner);
        known.clear();
        known.extend(answers.map(|((key, prediction), result)| (key, (prediction, result))));
    }

    /// Calls `with` on the answer to a request: that of the batch if there is one, else one computed now.
    pub fn contacts<T>(
        &self,
        mesh1: &MedialMesh,
        mesh2: &MedialMesh,
        pos12: &Pose,
        prediction: Real,
        with: impl FnOnce(&PairResult) -> T,
    ) -> T {
        let known = self.known.read().unwrap_or_else(PoisonError::into_inner);
        if let Some((reach, result)) = known.get(&Key::new(mesh1, mesh2, pos12))
            && prediction <= *reach
        {
            self.hits.fetch_add(1, Ordering::Relaxed);
            return with(result);
        }
        drop(known);
        // rapier's boxes are wider than the batch's: most of what was not expected is apart.
        let reach = mesh1.aabb().loosened(prediction);
        let result = if reach.intersects(&mesh2.aabb().transform_by(pos12)) {
            let job = PairJob {
                mesh1: mesh1.clone(),
                mesh2: mesh2.clone(),
                pos12: *pos12,
                prediction,
            };
            let compute = self.compute.read().unwrap_or_else(PoisonError::into_inner);
            let ahead = compute.as_ref().and_then(|compute| compute(job.clone()));
            ahead.unwrap_or_else(|| job.answer())
        } else {
            PairResult::default()
        };
        self.misses.fetch_add(1, Ordering::Relaxed);
        self.missed
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push([mesh1.instance_id(), mesh2.instance_id()]);
        self.count(result.counts.nodes, result.counts.tests);
        with(&result)
    }

    /// From now on exactly these pairs get no contacts, because the event loop resolves them.
    pub fn mute(&self, pairs: HashSet<Key>) {
        *self.muted.write().unwrap_or_else(PoisonError::into_inner) = pairs;
    }

    /// Whether a pair is muted.
    pub fn is_muted(&self, shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> bool {
        let muted = self.muted.read().unwrap_or_else(PoisonError::into_inner);
        !muted.is_empty() && muted.contains(&Key::new(shape1, shape2, pos12))
    }

    /// Sets whether rapier's own sweeps of medial bodies find nothing from now on, because the event loop resolves what
    /// these bodies meet.
    pub fn sweep_elsewhere(&self, elsewhere: bool) {
        self.swept_elsewhere.store(elsewhere, Ordering::Relaxed);
    }

    /// Whether rapier's own sweeps of medial bodies find nothing.
    pub fn is_swept_elsewhere(&self) -> bool {
        self.swept_elsewhere.load(Ordering::Relaxed)
    }

    /// Notes, under the keys of a pair, whether the user turned off some of its contacts. If all contacts that are
    /// noted of it are off, rapier's sweeps let the pair pass in this step.
    pub fn let_pass(&self, keys: &[Key], off: bool) {
        let mut passing = self.passing.write().unwrap_or_else(PoisonError::into_inner);
        for key in keys {
            *passing.entry(*key).or_insert(true) &= off;
        }
    }

    /// Forgets all pairs that rapier's sweeps were to let pass.
    pub fn let_none_pass(&self) {
        let passing = self.passing.write();
        passing.unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Whether rapier's sweeps let a pair pass.
    pub fn passes(&self, shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> bool {
        let passing = self.passing.read().unwrap_or_else(PoisonError::into_inner);
        let noted = |key| passing.get(&key) == Some(&true);
        !passing.is_empty()
            && (noted(Key::new(shape1, shape2, pos12)) || noted(Key::anywhere(shape1, shape2)))
    }

    /// From now on these pairs get only their deepest contact.
    pub fn give_one_point(&self, pairs: OnePoint) {
        *self
            .one_point
            .write()
            .unwrap_or_else(PoisonError::into_inner) = pairs;
    }

    /// Whether a pair gets only its deepest contact. Only medial shapes of the pair decide.
    pub fn has_one_point(&self, shape1: &dyn Shape, shape2: &dyn Shape) -> bool {
        let id = |s: &dyn Shape| s.as_shape::<MedialMesh>().map_or(0, |m| m.instance_id());
        let pairs = self
            .one_point
            .read()
            .unwrap_or_else(PoisonError::into_inner);
        pairs.holds([id(shape1), id(shape2)])
    }

    /// Notes the depth of a contact that was written just now, a length.
    pub fn note_depth(&self, depth: Real) {
        let depth = depth.max(0.0).abs();
        self.depth.fetch_max(depth.to_bits(), Ordering::Relaxed);
    }

    /// Returns the largest depth noted since the last call, a length.
    pub fn take_depth(&self) -> Real {
        Real::from_bits(self.depth.swap(0, Ordering::Relaxed))
    }

    /// Counts manifolds that were written.
    pub fn count_manifolds(&self, manifolds: usize) {
        self.manifolds
            .fetch_add(manifolds as u64, Ordering::Relaxed);
    }

    /// Counts a test of intersection.
    pub fn count_intersection(&self) {
        self.intersections.fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a shape cast and its work.
    pub fn count_cast(&self, nodes: u32, tests: u32) {
        self.casts.fetch_add(1, Ordering::Relaxed);
        self.count(nodes, tests);
    }

    /// Counts the work of other queries.
    pub fn count(&self, nodes: u32, tests: u32) {
        self.nodes.fetch_add(nodes.into(), Ordering::Relaxed);
        self.tests.fetch_add(tests.into(), Ordering::Relaxed);
    }

    /// Returns the instance ids of pairs whose answer was not in the batch since the last call.
    pub fn take_missed(&self) -> Vec<[u64; 2]> {
        std::mem::take(&mut *self.missed.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns what was counted since the last call.
    pub fn take_counts(&self) -> Counted {
        let take = |counter: &AtomicU64| counter.swap(0, Ordering::Relaxed);
        Counted {
            hits: take(&self.hits),
            misses: take(&self.misses),
            casts: take(&self.casts),
            nodes: take(&self.nodes),
            tests: take(&self.tests),
            manifolds: take(&self.manifolds),
            intersections: take(&self.intersections),
        }
    }
}
