//! Functions whose last bit is the platform's: with feature `enhanced-determinism` those of the crate
//! libm, the same everywhere. Square roots and the four operations are exact on every machine.

#[cfg(feature = "enhanced-determinism")]
mod of {
    pub use libm::{sincos, sincosf};
}

#[cfg(not(feature = "enhanced-determinism"))]
mod of {
    pub fn sincos(x: f64) -> (f64, f64) {
        x.sin_cos()
    }
    pub fn sincosf(x: f32) -> (f32, f32) {
        x.sin_cos()
    }
}

/// Sine and cosine of an angle in radians.
pub fn sin_cos_f64(angle: f64) -> (f64, f64) {
    of::sincos(angle)
}

/// Sine and cosine of an angle in radians.
pub fn sin_cos_f32(angle: f32) -> (f32, f32) {
    of::sincosf(angle)
}
