//! SplitMix64 (Steele, Lea, Flood 2014): small, and the same numbers everywhere.

use rapier3d::prelude::{Real, Vector};
use std::f32::consts::TAU;

/// The state; start with any number.
pub struct Random(pub u64);

impl Random {
    /// Even over an interval.
    pub fn between(&mut self, low: Real, high: Real) -> Real {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let share = ((z ^ (z >> 31)) >> 40) as Real / (1u64 << 24) as Real;
        low + (high - low) * share
    }

    /// Even over the unit sphere.
    pub fn direction(&mut self) -> Vector {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        let across = (1.0 - y * y).sqrt();
        Vector::new(across * cos, y, across * sin)
    }
}
