//! Jobs that were sent to a GPU before their answers were needed: finds the answer to a job that is asked later, if
//! it is the same bit by bit.

use super::gpu::{Proposal, Proposals};
use super::job::Sweep;
use crate::math::fast_hash::FastMap;
use parry3d::query::NonlinearRigidMotion;

/// All that a sweep's answer depends on: instance ids, which are never given twice, and numbers, by
/// their bits.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct Key {
    meshes: [u64; 2],
    motions: [[u32; 16]; 2],
    seconds: u32,
    reach: u64,
    lists: bool,
}

impl Key {
    pub(super) fn of(sweep: &Sweep<'_>) -> Self {
        let bits = |m: &NonlinearRigidMotion| {
            let (t, q) = (m.start.translation, m.start.rotation);
            let (c, v, w) = (m.local_center, m.linvel, m.angvel);
            [
                t.x, t.y, t.z, q.x, q.y, q.z, q.w, c.x, c.y, c.z, v.x, v.y, v.z, w.x, w.y, w.z,
            ]
            .map(f32::to_bits)
        };
        let [m, n] = &sweep.motions;
        Self {
            meshes: sweep.meshes.map(|mesh| mesh.instance_id()),
            motions: [bits(m), bits(n)],
            seconds: sweep.seconds.to_bits(),
            reach: sweep.reach.to_bits(),
            lists: sweep.lists,
        }
    }
}

/// Jobs on the device.
#[derive(Default)]
pub(super) struct Early {
    /// Index of each.
    pub(super) sent: FastMap<Key, u32>,
    /// Answers of the device to the jobs sent, once they are collected.
    pub(super) proposals: Proposals,
    /// Whether the device still has them.
    pub(super) pending: bool,
}

impl Early {
    /// Forgets all jobs that were sent; memory is kept for the next ones.
    pub(super) fn forget(&mut self) {
        self.sent.clear();
        self.proposals.clear();
        self.pending = false;
    }

    /// Answer of the device to this sweep, if it was sent.
    pub(super) fn proposal(&self, sweep: &Sweep<'_>) -> Option<Proposal> {
        let index = self.sent.get(&Key::of(sweep))?;
        self.proposals.get(*index as usize).copied()
    }
}
