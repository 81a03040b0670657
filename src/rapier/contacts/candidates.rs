//! Finds the pairs of medial colliders whose contacts rapier may ask for in this step, so that all can be computed
//! in one batch before: pairs whose bounding boxes overlap at the start of the step, and which are not muted.

use crate::batch::PairJob;
use crate::math::Real;
use crate::parry::answers::Key;
use crate::rapier::contacts::neighbor_speeds;
use crate::rapier::contacts::predicted_contacts::{PredictedMotion, Start, Starts};
use crate::rapier::host::forced_updates;
use crate::rapier::host::forced_updates::is_hooked;
use crate::rapier::host::recycling::{Place, RecyclingRecord};
use crate::rapier::view::medial_colliders::{MedialCollider, MedialColliders, Sets};
use crate::rapier::view::overlapping_boxes::meeting;
use parry3d::bounding_volume::Aabb;
use rapier3d::geometry::ColliderHandle;
use std::collections::HashSet;

/// Pairs of medial colliders that are near each other, and which of them rapier's narrow phase will ask for.
pub struct Candidates {
    /// Number of near pairs.
    pub pairs: usize,
    /// The pairs of these that rapier will ask for: they have moved too much for it to keep their contacts.
    pub jobs: Vec<PairJob>,
    /// For each job, how its contacts are moved back from where they were computed to the start of the step.
    pub ahead: Vec<PredictedMotion>,
    /// What is needed to compute pairs that rapier asks for and that are not among the jobs.
    pub starts: Starts,
    /// Colliders whose contacts rapier must be made to ask for.
    pub fresh: HashSet<ColliderHandle>,
    /// Depth of the deepest of all contacts, a length.
    pub depth: Real,
}

/// Finds all pairs of medial colliders that are near each other, of which at least one is dynamic and awake, which are
/// on different bodies, and whose groups are compatible. The order of the two is that of rapier's narrow phase (the
/// lower collider index first).
pub fn find(sets: Sets, recycled: &mut RecyclingRecord, muted: &HashSet<Key>) -> Candidates {
    let scene = Scene::new(sets);
    recycled.begin(sets.parameters);
    let asked = |pair: &&[usize; 2]| {
        let place = scene.place(pair);
        recycled.needs_update(&place, scene.asked(pair)) && !scene.is_muted(pair, &place, muted)
    };
    let asked = scene.pairs.iter().filter(asked);
    let (ahead, jobs) = asked.map(|pair| scene.at_the_end(pair)).unzip();
    let fresh = scene.items.all.iter().zip(&scene.fresh);
    Candidates {
        pairs: scene.pairs.len(),
        jobs,
        ahead,
        fresh: fresh
            .filter(|(_, fresh)| **fresh)
            .map(|(item, _)| item.handle)
            .collect(),
        starts: scene.starts,
        depth: scene.depth,
    }
}

/// The jobs that [`find`] will return at the next step, if nothing is changed until then.
pub fn expect(sets: Sets, recycled: &RecyclingRecord) -> Vec<PairJob> {
    let scene = Scene::new(sets);
    let asked = |pair: &&[usize; 2]| scene.asked(pair) || !recycled.recycles(&scene.place(pair));
    let asked = scene.pairs.iter().filter(asked);
    asked.map(|pair| scene.at_the_end(pair).1).collect()
}

/// The medial colliders at the start of a step, and which of them are near each other.
struct Scene<'a> {
    items: MedialColliders<'a>,
    starts: Starts,
    /// In the narrow phase's order.
    pairs: Vec<[usize; 2]>,
    /// Whether rapier has to be made to ask for the contacts of each of them.
    fresh: Vec<bool>,
    /// Whether it asks for them in any case: the user has hooks on it, or it is `fresh`.
    asked: Vec<bool>,
    /// As in [`Candidates`].
    depth: Real,
}

impl<'a> Scene<'a> {
    fn new(sets: Sets<'a>) -> Self {
        let items = MedialColliders::new(&sets);
        let start = |item: &MedialCollider| item.start(&sets);
        let mut all: Vec<Start> = items.all.iter().map(start).collect();
        let mut boxes: Vec<Aabb> = items.all.iter().map(|item| item.aabb).collect();
        let speed = |(item, start): (&MedialCollider, &Start)| match item.parent {
            Some((body, _)) if neighbor_speeds::is_tied(&sets, body) => Real::MAX,
            _ => start.speed(),
        };
        let mut speeds: Vec<Real> = items.all.iter().zip(&all).map(speed).collect();
        for (aabb, speed) in neighbor_speeds::others(&sets) {
            boxes.push(aabb);
            speeds.push(speed);
        }
        let met = meeting(&boxes);
        let pushed = neighbor_speeds::pushed(&speeds, &met);
        for (start, pushed) in all.iter_mut().zip(pushed) {
            start.pushed = pushed;
        }
        for (start, hangs) in all.iter_mut().zip(forced_updates::hang(&sets, &items)) {
            start.hangs = hangs;
        }
        let medial = met
            .into_iter()
            .filter(|pair| pair.iter().all(|k| *k < items.all.len()));
        let wanted = medial.filter(|pair| items.meet(*pair));
        let pairs = wanted.map(|pair| items.in_order(pair)).collect();
        let starts = Starts {
            ids: items.all.iter().map(|item| item.id).collect(),
            all,
            parameters: *sets.parameters,
        };
        let (fresh, depth) = forced_updates::find(&sets, &items, &starts);
        let hooked = items.all.iter().map(|item| is_hooked(item.collider));
        let asked = hooked
            .zip(&fresh)
            .map(|(hooked, fresh)| hooked || *fresh)
            .collect();
        Self {
            items,
            starts,
            pairs,
            fresh,
            asked,
            depth,
        }
    }

    fn of(&self, pair: &[usize; 2]) -> [&MedialCollider<'a>; 2] {
        pair.map(|k| &self.items.all[k])
    }

    fn place(&self, pair: &[usize; 2]) -> Place {
        let [a, b] = self.of(pair);
        Place {
            ids: [a.id, b.id],
            pos12: a.pose.inv_mul(&b.pose),
            rotations: [a.pose.rotation, b.pose.rotation],
            reach: a.reach.max(b.reach),
        }
    }

    fn is_muted(&self, pair: &[usize; 2], place: &Place, muted: &HashSet<Key>) -> bool {
        let [a, b] = self.of(pair);
        !muted.is_empty() && muted.contains(&Key::new(a.mesh, b.mesh, &place.pos12))
    }

    fn asked(&self, pair: &[usize; 2]) -> bool {
        pair.iter().any(|k| self.asked[*k])
    }

    /// The job at the poses that the velocities lead to.
    fn at_the_end(&self, pair: &[usize; 2]) -> (PredictedMotion, PairJob) {
        let [a, b] = self.of(pair);
        let parameters = &self.starts.parameters;
        let skins = a.skin + b.skin;
        let job = PairJob {
            mesh1: a.mesh.clone(),
            mesh2: b.mesh.clone(),
            pos12: a.pose.inv_mul(&b.pose),
            // Added up as rapier does.
            prediction: parameters.prediction_distance() + skins,
        };
        PredictedMotion::new(pair.map(|k| &self.starts.all[k]), parameters, job)
    }
}
