//! A world's state as one number, the same wherever it was computed.

use rapier3d::prelude::PhysicsWorld;

/// FNV-1a over every bit of every body's pose and velocities.
pub fn state_hash(world: &PhysicsWorld) -> u64 {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for (_, b) in world.bodies.iter() {
        let (t, r, v, w) = (b.translation(), b.rotation(), b.linvel(), b.angvel());
        let all = [
            t.x, t.y, t.z, r.x, r.y, r.z, r.w, v.x, v.y, v.z, w.x, w.y, w.z,
        ];
        for byte in all.into_iter().flat_map(|x| x.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    hash
}
