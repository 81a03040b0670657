//! Time at which a point that moves straight first comes within a distance of the origin: the smaller root of `|y + t
//! ẏ| = R`, paper Eq. (4), for every pair of balls on straight paths.
//!
//! It is found from the point of closest approach, `y + t₀ ẏ` with `t₀ = −y·ẏ/|ẏ|²`, as
//! `t₀ − √(R² − |y + t₀ ẏ|²)/|ẏ|`. The discriminant of the parabola, `(y·ẏ)² − |ẏ|²(|y|² − R²)`, is a difference of
//! numbers of the size `|y|²|ẏ|²`, and leaves an error of `EPSILON |y|²/2R` in the distance: more than
//! `R` itself for a ball of 1e-6 m that comes from 10 km, even in `f64`.
//!
//! # Rounding
//! `t₀` is good to 4 half-ulps, the point of closest approach so to `5 EPSILON |y|`, along its way and across,
//! and the root to a motion of as much. With `R` larger by `m ≥ 10 EPSILON |y|` it is never later than the
//! exact root for `R`: `√(X + Δ) ≥ √X + e` as soon as `Δ ≥ 2eR + e²`, where `X = R² − a² ≤ R²`, and a shift
//! of `R` by `m` and of `a ≤ R` by `e` makes `Δ ≥ 2R(m − e) + m² − e²`; `m = 2e` suffices.

use super::lane::{Lane, Vec3};

/// Time of the first touch, and whether there is one: the point passes within `radius`, at any time.
/// Before 0 where it is within at 0.
#[inline(always)]
pub fn first_touch<L: Lane>(y: Vec3<L>, rate: Vec3<L>, radius: L) -> (L, L::Mask) {
    let zero = L::zero();
    let speed_sq = rate.length_sq().max(L::splat(L::TINY));
    let closest = -(y.dot(rate) / speed_sq);
    let across = (y + rate * closest).length_sq();
    let inside = radius * radius - across;
    let time = closest - (inside.max(zero) / speed_sq).sqrt();
    (time, zero.le(radius) & zero.le(inside))
}
