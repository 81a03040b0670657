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

/// Two shapes, at one relative pose to the bit or wherever they are. Holds as long as both shapes live.
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
    /// Of two shapes at a relative pose, of which one at least is medial.
    pub fn new(shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> Self {
        let (t, r) = (pos12.translation, pos12.rotation);
        Self {
            pose: Some([t.x, t.y, t.z, r.x, r.y, r.z, r.w].map(Real::to_bits)),
            ..Self::anywhere(shape1, shape2)
        }
    }

    /// Of two shapes wherever they are: for those that no other collider has.
    pub fn anywhere(shape1: &dyn Shape, shape2: &dyn Shape) -> Self {
        Self {
            shapes: [shape1, shape2].map(Id::new),
            pose: None,
        }
    }
}

/// Work counted by a dispatcher since the last [`Answers::take_counts`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Manifold requests that the batch had answered.
    pub hits: u64,
    /// Manifold requests computed on the spot.
    pub misses: u64,
    /// First-contact queries (shape casts).
    pub casts: u64,
    /// Node pairs of both trees looked at, outside the batch.
    pub nodes: u64,
    /// Elementary tests executed outside the batch.
    pub tests: u64,
    /// Manifolds written.
    pub manifolds: u64,
    /// Whether two shapes intersect, as sensors ask.
    pub intersections: u64,
}

/// Which pairs get their deepest contact only.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OnePoint {
    /// Those of which neither shape is named below.
    pub others: bool,
    /// By instance id; of two that differ, the one with all its contacts decides.
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

/// Contacts of a pair that the batch did not have, as the batch would have computed them: so it makes no
/// difference to the world what was expected. `None`: it would not have.
pub type Compute = Box<dyn Fn(PairJob) -> Option<PairResult> + Send + Sync>;

/// Answers of one batch, shared by a pipeline and its dispatcher.
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
    /// Forgets the old answers and takes those of a new batch, each with the prediction distance it
    /// holds for; `compute` is for the others.
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

    /// Calls `with` on the answer to a request, from the batch if it holds it, else computed.
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

    /// From now on these pairs have no contacts, and no others: someone else takes care of them.
    pub fn mute(&self, pairs: HashSet<Key>) {
        *self.muted.write().unwrap_or_else(PoisonError::into_inner) = pairs;
    }

    /// Whether a pair is muted.
    pub fn is_muted(&self, shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> bool {
        let muted = self.muted.read().unwrap_or_else(PoisonError::into_inner);
        !muted.is_empty() && muted.contains(&Key::new(shape1, shape2, pos12))
    }

    /// From now on rapier's own sweeps of medial bodies find nothing, or again what there is: someone else
    /// takes care of what they meet on their way.
    pub fn sweep_elsewhere(&self, elsewhere: bool) {
        self.swept_elsewhere.store(elsewhere, Ordering::Relaxed);
    }

    /// Whether someone else takes care of it.
    pub fn is_swept_elsewhere(&self) -> bool {
        self.swept_elsewhere.load(Ordering::Relaxed)
    }

    /// Notes whether the user turned contacts of a pair off, under its keys. It passes in sweeps of this step if all
    /// that is noted of it is off.
    pub fn let_pass(&self, keys: &[Key], off: bool) {
        let mut passing = self.passing.write().unwrap_or_else(PoisonError::into_inner);
        for key in keys {
            *passing.entry(*key).or_insert(true) &= off;
        }
    }

    /// No pair passes any more.
    pub fn let_none_pass(&self) {
        let passing = self.passing.write();
        passing.unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Whether a pair passes in sweeps.
    pub fn passes(&self, shape1: &dyn Shape, shape2: &dyn Shape, pos12: &Pose) -> bool {
        let passing = self.passing.read().unwrap_or_else(PoisonError::into_inner);
        let noted = |key| passing.get(&key) == Some(&true);
        !passing.is_empty()
            && (noted(Key::new(shape1, shape2, pos12)) || noted(Key::anywhere(shape1, shape2)))
    }

    /// From now on these pairs get their deepest contact only.
    pub fn give_one_point(&self, pairs: OnePoint) {
        *self
            .one_point
            .write()
            .unwrap_or_else(PoisonError::into_inner) = pairs;
    }

    /// Whether a pair gets its deepest contact only. A shape that is not medial has no say.
    pub fn has_one_point(&self, shape1: &dyn Shape, shape2: &dyn Shape) -> bool {
        let id = |s: &dyn Shape| s.as_shape::<MedialMesh>().map_or(0, |m| m.instance_id());
        let pairs = self
            .one_point
            .read()
            .unwrap_or_else(PoisonError::into_inner);
        pairs.holds([id(shape1), id(shape2)])
    }

    /// Notes how deep the contacts of a pair are that were written just now, a length.
    pub fn note_depth(&self, depth: Real) {
        let depth = depth.max(0.0).abs();
        self.depth.fetch_max(depth.to_bits(), Ordering::Relaxed);
    }

    /// The deepest noted since the last call.
    pub fn take_depth(&self) -> Real {
        Real::from_bits(self.depth.swap(0, Ordering::Relaxed))
    }

    /// Counts manifolds written.
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

    /// Counts work of other queries.
    pub fn count(&self, nodes: u32, tests: u32) {
        self.nodes.fetch_add(nodes.into(), Ordering::Relaxed);
        self.tests.fetch_add(tests.into(), Ordering::Relaxed);
    }

    /// Instance ids of the pairs that missed since the last call.
    pub fn take_missed(&self) -> Vec<[u64; 2]> {
        std::mem::take(&mut *self.missed.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Work since the last call, and starts counting anew.
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
