//! Which pairs rapier will not ask for: while a pair's relative pose stays near the one of its last
//! full update, the narrow phase recycles its contacts (`narrow_phase/pair_update.rs` of rapier
//! 0.36). This keeps the same account, so that a resting pile costs no contact computation.
//!
//! A wrong guess costs time, never correctness: a pair that is asked for and was not computed is a
//! miss, computed on the spot as the batch would have done. So a loaded world, whose account is empty, goes
//! on bit by bit.

use crate::batch::PairJob;
use crate::math::{Pose, Real, Rotation};
use rapier3d::dynamics::IntegrationParameters;

/// Cosine of the rotation of either body since its pair's last update above which rapier recycles.
const ROTATION_COSINE: Real = 0.98;

/// Where two colliders are.
pub struct Place {
    /// Their instance ids.
    pub ids: [u64; 2],
    /// Pose of the second in the first's frame.
    pub pos12: Pose,
    /// Rotations of both.
    pub rotations: [Rotation; 2],
    /// Largest distance of a corner of either's box from its origin.
    pub reach: Real,
}

#[derive(Clone, Copy)]
struct Frozen {
    ids: [u64; 2],
    pos12: Pose,
    rotations: [Rotation; 2],
    touching: bool,
}

/// Relative poses at which each pair was last updated in full.
#[derive(Default)]
pub struct Recycled {
    /// Of the step before, in the order of their ids.
    last: Vec<Frozen>,
    /// Of this one.
    now: Vec<Frozen>,
    /// How many of the step before come before all that are still to be told.
    passed: usize,
    /// Drift below which a pair in contact, and one without contacts, is recycled.
    limits: [Real; 2],
}

impl Recycled {
    /// Starts a step.
    pub fn begin(&mut self, parameters: &IntegrationParameters) {
        std::mem::swap(&mut self.last, &mut self.now);
        self.now.clear();
        self.passed = 0;
        let distance = if parameters.contact_recycling {
            parameters.contact_recycle_distance()
        } else {
            0.0
        };
        self.limits = [distance, distance.min(parameters.prediction_distance())];
    }

    /// Whether rapier will update this pair in full, which it does in any case if it is `asked` to; if so
    /// its account starts anew at this pose. Pairs that are near are told in the order of their ids; of the
    /// others the account is lost.
    pub fn needs_update(&mut self, pair: &Place, asked: bool) -> bool {
        let rest = &self.last[self.passed..];
        self.passed += rest.iter().take_while(|f| f.ids < pair.ids).count();
        let known = self.last.get(self.passed).filter(|f| f.ids == pair.ids);
        let kept = known.filter(|f| !asked && f.recycles(pair, self.limits));
        self.now.push(kept.copied().unwrap_or(Frozen {
            ids: pair.ids,
            pos12: pair.pos12,
            rotations: pair.rotations,
            touching: false,
        }));
        kept.is_none()
    }

    /// Whether rapier keeps the contacts of this pair, as far as is known now.
    pub fn recycles(&self, pair: &Place) -> bool {
        let known = place(&self.now, pair.ids).map(|at| &self.now[at]);
        known.is_some_and(|f| f.recycles(pair, self.limits))
    }

    /// Notes whether a pair just updated is in contact.
    pub fn set_touching(&mut self, job: &PairJob, touching: bool) {
        if let Some(at) = place(&self.now, ids(job)) {
            self.now[at].touching = touching;
        }
    }

    /// Forgets a pair that rapier asked for although it was not expected to.
    pub fn forget(&mut self, ids: [u64; 2]) {
        if let Some(at) = place(&self.now, ids) {
            self.now.remove(at);
        }
    }
}

/// The place of a pair in a list in the order of the ids.
fn place(all: &[Frozen], ids: [u64; 2]) -> Option<usize> {
    all.binary_search_by_key(&ids, |f| f.ids).ok()
}

fn ids(job: &PairJob) -> [u64; 2] {
    [job.mesh1.instance_id(), job.mesh2.instance_id()]
}

impl Frozen {
    fn recycles(&self, pair: &Place, limits: [Real; 2]) -> bool {
        let limit = limits[usize::from(!self.touching)];
        let turned = |k: usize| {
            let c = self.rotations[k].dot(pair.rotations[k]);
            2.0 * c * c - 1.0 <= ROTATION_COSINE
        };
        self.drift(pair) <= limit && limit > 0.0 && !turned(0) && !turned(1)
    }

    /// Bound on how far a point of either mesh moved relative to the other since.
    fn drift(&self, pair: &Place) -> Real {
        let (then, now) = (&self.pos12, &pair.pos12);
        let turn = then.rotation.inverse() * now.rotation;
        // The chord of a rotation by θ at distance 1 is 2 sin(θ/2) = 2 |vector part|.
        let chord = 2.0 * (turn.x * turn.x + turn.y * turn.y + turn.z * turn.z).sqrt();
        (now.translation - then.translation).length() + chord * pair.reach
    }
}
