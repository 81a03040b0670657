//! Numbers that are the same on every machine.

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// Evenly spread between two numbers.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        low + (high - low) * (z >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A unit vector, all directions alike.
    pub fn direction(&mut self) -> Vector3<f64> {
        let y = self.range(-1.0, 1.0);
        let (sin, cos) = self.range(0.0, TAU).sin_cos();
        let across = (1.0 - y * y).sqrt();
        Vector3::new(across * cos, y, across * sin)
    }
}
