//! Finds the pairs of medial colliders whose contacts rapier may ask for in this step, so that all can be computed
//! in one batch before: pairs whose bounding boxes overlap at the start of the step, and which are not muted.

use crate::batch::PairJob;
use crate::math::Real;
use crate::parry::narrow_phase_plan::PairKey;
use crate::rapier::contacts::hanging;
use crate::rapier::contacts::neighbor_speeds::{self, Neighbor};
use crate::rapier::contacts::predicted_contacts::PredictedMotion;
use crate::rapier::host::forced_updates::{is_hooked, kept_longer};
use crate::rapier::host::recycling::{PairPose, RecyclingRecord, lowered};
use crate::rapier::view::medial_colliders::{MedialCollider, MedialColliders, Sets};
use crate::rapier::view::overlapping_boxes::overlapping_pairs;
use parry3d::bounding_volume::Aabb;
use rapier3d::geometry::ColliderHandle;
use std::collections::HashSet;

/// Pairs of medial colliders that are near each other, and which of them rapier's narrow phase will ask for.
pub struct Candidates {
    /// Number of near pairs.
    pub pairs: usize,
    /// The pairs of these that rapier will ask for: they have moved too much for it to keep their contacts.
    pub jobs: Vec<PairJob>,
    /// Motion of each job from the start of the step to where its contacts are computed, which brings them back.
    pub predicted_motions: Vec<PredictedMotion>,
    /// All medial colliders, for pairs that rapier asks for and that are not among the jobs.
    pub colliders: MedialColliders,
    /// Colliders whose contacts rapier must be made to ask for.
    pub forced: HashSet<ColliderHandle>,
    /// Depth of the deepest contact of a medial collider that takes part, a length.
    pub depth: Real,
}

/// Finds all pairs of medial colliders that are near each other, of which at least one is dynamic and awake, which are
/// on different bodies, and whose groups are compatible. The order of the two is that of rapier's narrow phase (the
/// lower collider index first). `all_asked` says that rapier asks for the contacts of all of them.
pub fn find(
    sets: Sets,
    recycled: &mut RecyclingRecord,
    muted: &HashSet<PairKey>,
    all_asked: bool,
) -> Candidates {
    let scene = ContactScene::new(sets);
    recycled.begin(sets.parameters);
    let asked = |pair: &&[usize; 2]| {
        let place = scene.place(pair);
        recycled.needs_update(&place, all_asked || scene.asked(pair))
            && !scene.is_muted(pair, &place, muted)
    };
    let asked = scene.pairs.iter().filter(asked);
    let (predicted_motions, jobs) = asked.map(|pair| scene.at_the_end(pair)).unzip();
    let forced = scene.medial.all.iter().zip(&scene.forced);
    let forced = forced.filter(|(_, forced)| **forced);
    Candidates {
        pairs: scene.pairs.len(),
        jobs,
        predicted_motions,
        forced: forced.map(|(collider, _)| collider.handle).collect(),
        depth: scene.depth,
        colliders: scene.medial,
    }
}

/// The jobs that [`find`] will return at the next step of a world, with the user's parameters, if nothing is changed
/// until then.
pub fn expect(sets: Sets, recycled: &RecyclingRecord) -> Vec<PairJob> {
    let parameters = lowered(sets.parameters);
    let scene = ContactScene::new(Sets {
        parameters: &parameters,
        ..sets
    });
    let asked = |pair: &&[usize; 2]| scene.asked(pair) || !recycled.recycles(&scene.place(pair));
    let asked = scene.pairs.iter().filter(asked);
    asked.map(|pair| scene.at_the_end(pair).1).collect()
}

/// The medial colliders at the start of a step, and which of them are near each other.
struct ContactScene {
    medial: MedialColliders,
    /// Near pairs, each in the narrow phase's order.
    pairs: Vec<[usize; 2]>,
    /// Whether rapier has to be made to ask for the contacts of each of them.
    forced: Vec<bool>,
    /// Whether it asks for them in any case: the user has hooks on it, or it is made to ask.
    asked: Vec<bool>,
    /// Depth of the deepest contact of a medial collider that takes part, a length.
    depth: Real,
}

impl ContactScene {
    fn new(sets: Sets) -> Self {
        let mut medial = MedialColliders::new(&sets);
        let mut boxes: Vec<Aabb> = medial.all.iter().map(|collider| collider.aabb).collect();
        let neighbor = |collider: &MedialCollider| Neighbor::medial(&sets, collider);
        let mut neighbors: Vec<Neighbor> = medial.all.iter().map(neighbor).collect();
        for (aabb, neighbor) in neighbor_speeds::others(&sets) {
            boxes.push(aabb);
            neighbors.push(neighbor);
        }
        let met = overlapping_pairs(&boxes);
        let pushed = neighbor_speeds::neighbor_speed_bounds(&neighbors, &met);
        let hangs = hanging::hang(&sets, &medial);
        for (collider, (pushed, hangs)) in medial.all.iter_mut().zip(pushed.into_iter().zip(hangs))
        {
            collider.pushed = pushed;
            collider.hangs = hangs;
        }
        let both_medial = met
            .into_iter()
            .filter(|pair| pair.iter().all(|k| *k < medial.all.len()));
        let wanted = both_medial.filter(|pair| medial.meet(*pair));
        let pairs = wanted.map(|pair| medial.in_order(pair)).collect();
        let (forced, depth) = hanging::find(&sets, &medial);
        let hooks = medial.all.iter().map(|collider| collider.hooks);
        let asked = hooks.zip(&forced);
        let asked = asked
            .map(|(hooks, forced)| is_hooked(hooks) || kept_longer(hooks) || *forced)
            .collect();
        Self {
            medial,
            pairs,
            forced,
            asked,
            depth,
        }
    }

    fn of(&self, pair: &[usize; 2]) -> [&MedialCollider; 2] {
        pair.map(|k| &self.medial.all[k])
    }

    fn place(&self, pair: &[usize; 2]) -> PairPose {
        let [a, b] = self.of(pair);
        PairPose {
            ids: [a, b].map(|c| c.mesh.instance_id()),
            pos12: a.pose().inv_mul(b.pose()),
            rotations: [a, b].map(|c| c.pose().rotation),
            reach: a.reach.max(b.reach),
        }
    }

    fn is_muted(&self, pair: &[usize; 2], place: &PairPose, muted: &HashSet<PairKey>) -> bool {
        let [a, b] = self.of(pair);
        !muted.is_empty() && muted.contains(&PairKey::new(&a.mesh, &b.mesh, &place.pos12))
    }

    fn asked(&self, pair: &[usize; 2]) -> bool {
        pair.iter().any(|k| self.asked[*k])
    }

    /// The job at the poses that the velocities lead to.
    fn at_the_end(&self, pair: &[usize; 2]) -> (PredictedMotion, PairJob) {
        let [a, b] = self.of(pair);
        let parameters = &self.medial.parameters;
        let skins = a.skin + b.skin;
        let pos12 = a.pose().inv_mul(b.pose());
        // Same summation order as rapier, to match its bits.
        let prediction = parameters.prediction_distance() + skins;
        let job = PairJob::of([&a.mesh, &b.mesh], &pos12, prediction);
        PredictedMotion::new([a, b], parameters, job)
    }
}
