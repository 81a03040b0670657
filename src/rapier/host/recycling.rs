//! Predicts for which pairs rapier will not ask for contacts. Its narrow phase keeps the contacts of a pair while
//! the relative pose stays near that of the last full update (`narrow_phase/pair_update.rs` of rapier 0.36). This
//! file keeps the same record, so that no contacts are computed in a pile at rest.
//!
//! A wrong prediction costs time and nothing else: contacts that rapier asks for and that were not computed before are
//! computed on the spot, with the same result. So a loaded world, for which this record is empty, goes on bit by
//! bit.

use crate::batch::PairJob;
use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Rotation};
use rapier3d::dynamics::IntegrationParameters;

/// The largest `normalized_contact_recycle_distance` with which worlds with medial colliders are stepped
/// ([`MedialPipeline::step`](crate::rapier::MedialPipeline::step)): how far a pair may move before rapier computes its
/// contacts anew, in units of rapier's length unit (rapier's own default is 0.05). Where at most one in nine of the
/// moving pairs has a medial collider, rapier goes by your distance, and the contacts of these pairs are computed in
/// each step.
///
/// A pair's contacts are computed for all places that may touch until the pair has moved this far, and in the step
/// after. So a smaller distance means that fewer contacts are computed, but more often. The contacts of hanging bodies
/// are computed anew much sooner, and those of dynamic medial bodies whose thickness is less than a quarter of it in
/// each step. To have rapier do so, a step sets the bits 30 and 31 of some colliders' `active_hooks()`, which call no
/// hook. So change hooks by adding to `active_hooks()` or taking from it.
pub const RECYCLE_DISTANCE: Real = 0.004;

/// Parameters of a step with medial colliders: contacts are kept no longer than [`RECYCLE_DISTANCE`] says.
pub fn lowered(parameters: &IntegrationParameters) -> IntegrationParameters {
    let mut parameters = *parameters;
    let distance = &mut parameters.normalized_contact_recycle_distance;
    *distance = distance.min(RECYCLE_DISTANCE);
    parameters
}

/// Cosine of the rotation of either body since its pair's last update above which rapier recycles.
const ROTATION_COSINE: Real = 0.98;

/// Placement of two colliders.
pub struct PairPose {
    /// Instance ids of their meshes.
    pub ids: [u64; 2],
    /// Pose of the second in the first's frame.
    pub pos12: Pose,
    /// Rotations of both.
    pub rotations: [Rotation; 2],
    /// Largest distance of a corner of either's box from its origin.
    pub reach: Real,
}

/// Poses of a pair at its last full update, from which rapier measures how far it has moved.
struct Frozen {
    pos12: Pose,
    rotations: [Rotation; 2],
    touching: bool,
    /// Step in which the pair was last near.
    seen: u64,
}

/// Relative poses at which each pair was last updated in full.
#[derive(Default)]
pub struct RecyclingRecord {
    frozen: FastMap<[u64; 2], Frozen>,
    step: u64,
    /// Drift below which a pair in contact, and one without contacts, is recycled.
    limits: [Real; 2],
}

impl RecyclingRecord {
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

    /// Whether rapier will update this pair in full, which it does in any case if it is `asked` to; if so, the pair's
    /// record is set to this pose.
    pub fn needs_update(&mut self, pair: &PairPose, asked: bool) -> bool {
        let (limits, step) = (self.limits, self.step);
        if let Some(f) = self.frozen.get_mut(&pair.ids) {
            f.seen = step;
            if !asked && f.recycles(pair, limits) {
                return false;
            }
        }
        let frozen = Frozen {
            pos12: pair.pos12,
            rotations: pair.rotations,
            touching: false,
            seen: step,
        };
        self.frozen.insert(pair.ids, frozen);
        true
    }

    /// Whether rapier keeps the contacts of this pair, as far as is known now.
    pub fn recycles(&self, pair: &PairPose) -> bool {
        let frozen = self.frozen.get(&pair.ids);
        frozen.is_some_and(|f| f.recycles(pair, self.limits))
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

impl Frozen {
    fn recycles(&self, pair: &PairPose, limits: [Real; 2]) -> bool {
        let limit = limits[usize::from(!self.touching)];
        let turned = |k: usize| {
            let c = self.rotations[k].dot(pair.rotations[k]);
            2.0 * c * c - 1.0 <= ROTATION_COSINE
        };
        self.drift(pair) <= limit && limit > 0.0 && !turned(0) && !turned(1)
    }

    /// Bound on how far a point of either mesh moved relative to the other since.
    fn drift(&self, pair: &PairPose) -> Real {
        let (then, now) = (&self.pos12, &pair.pos12);
        let turn = then.rotation.inverse() * now.rotation;
        // The chord of a rotation by θ at distance 1 is 2 sin(θ/2) = 2 |vector part|.
        let chord = 2.0 * (turn.x * turn.x + turn.y * turn.y + turn.z * turn.z).sqrt();
        (now.translation - then.translation).length() + chord * pair.reach
    }
}
