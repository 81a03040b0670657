//! Numbers that look random and are the same on every machine.

use rapier3d::prelude::*;

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// In `[0, 1)`.
    pub fn unit(&mut self) -> Real {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as Real / (1u64 << 24) as Real
    }

    /// In `[low, high)`.
    pub fn within(&mut self, low: Real, high: Real) -> Real {
        low + (high - low) * self.unit()
    }

    /// A unit vector.
    pub fn direction(&mut self) -> Vector {
        loop {
            let v = Vector::new(self.unit(), self.unit(), self.unit()) * 2.0 - Vector::ONE;
            if (0.01..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}
