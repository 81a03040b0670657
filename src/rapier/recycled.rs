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
use std::collections::HashMap;

/// Cosine of the rotation of either body since its pair's last update above which rapier recycles.
const ROTATION_COSINE: Real = 0.98;

struct Frozen {
    pos12: Pose,
    rotations: [Rotation; 2],
    touching: bool,
    /// Step in which the pair was last near.
    seen: u64,
}

/// Relative poses at which each pair was last updated in full.
#[derive(Default)]
pub struct Recycled {
    frozen: HashMap<[u64; 2], Frozen>,
    step: u64,
    /// Drift below which a pair in contact, and one without contacts, is recycled.
    limits: [Real; 2],
}

impl Recycled {
    /// Starts a step.
    pub fn begin(&mut self, parameters: &IntegrationParameters) {
        let last = self.step;
        self.frozen.retain(|_, f| f.seen == last);
        self.step += 1;
        let distance = if parameters.contact_recycling {
            parameters.contact_recycle_distance()
        } else {
            0.0
        };
        self.limits = [distance, distance.min(parameters.prediction_distance())];
    }

    /// Whether rapier will update this pair in full, which it does in any case if it is `asked` to; if so
    /// its account starts anew at this pose.
    pub fn needs_update(&mut self, job: &PairJob, rotations: [Rotation; 2], asked: bool) -> bool {
        let key = ids(job);
        let recycled = !asked && self.recycles(job, rotations);
        if let Some(f) = self.frozen.get_mut(&key) {
            f.seen = self.step;
            if recycled {
                return false;
            }
        }
        let frozen = Frozen {
            pos12: job.pos12,
            rotations,
            touching: false,
            seen: self.step,
        };
        self.frozen.insert(key, frozen);
        true
    }

    /// Whether rapier keeps the contacts of this pair, as far as is known now.
    pub fn recycles(&self, job: &PairJob, rotations: [Rotation; 2]) -> bool {
        self.frozen.get(&ids(job)).is_some_and(|f| {
            let limit = self.limits[usize::from(!f.touching)];
            let turned = |k: usize| {
                let c = f.rotations[k].dot(rotations[k]);
                2.0 * c * c - 1.0 <= ROTATION_COSINE
            };
            drift(&f.pos12, job) <= limit && limit > 0.0 && !turned(0) && !turned(1)
        })
    }

    /// Notes whether a pair just updated is in contact.
    pub fn set_touching(&mut self, job: &PairJob, touching: bool) {
        if let Some(f) = self.frozen.get_mut(&ids(job)) {
            f.touching = touching;
        }
    }

    /// Forgets a pair that rapier asked for although it was not expected to.
    pub fn forget(&mut self, ids: [u64; 2]) {
        self.frozen.remove(&ids);
    }
}

fn ids(job: &PairJob) -> [u64; 2] {
    [job.mesh1.instance_id(), job.mesh2.instance_id()]
}

/// Bound on how far a point of either mesh moved relative to the other since the pose `then`.
fn drift(then: &Pose, job: &PairJob) -> Real {
    let now = &job.pos12;
    let extent = |aabb: parry3d::bounding_volume::Aabb| aabb.mins.length().max(aabb.maxs.length());
    let reach = extent(job.mesh1.aabb()).max(extent(job.mesh2.aabb()));
    let turn = then.rotation.inverse() * now.rotation;
    // The chord of a rotation by θ at distance 1 is 2 sin(θ/2) = 2 |vector part|.
    let chord = 2.0 * (turn.x * turn.x + turn.y * turn.y + turn.z * turn.z).sqrt();
    (now.translation - then.translation).length() + chord * reach
}
