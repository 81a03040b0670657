//! How far two primitives that touch at the start of a step may sink into each other
//! ([`crate::elementary::InitialContact::Deepen`]) before that counts as a contact. However often this is allowed, no
//! medial axis crosses another.
//!
//! Usually they may sink by a given length: the target distance becomes their distance `s` at the start, minus this
//! length. Where parts are thinner than that, such a target would never be met, because the medial axes would cross
//! before. There all radii are reduced by one factor instead. Let `m` be the distance of the axes at the start. For any
//! `0 < b < m` with `s <= b`, the factor `σ = (m − b) / (m − s)` leaves primitives that are at least `b` apart: two
//! spheres of radius sum `R`, whose centres are no nearer than `m` and no nearer than `R + s`, are farther apart than
//! `σ R` by `m − σ R` and by `R + s − σ R`, of which one is at least `b` (they are equal at `R = m − s`). And spheres
//! whose radii are multiplied by any factor from 0 on still contain the axis: while they do not meet, no axis has
//! crossed another.

/// Share of the asked tolerance below which axes at the start count as crossing: nearer than that, rounding
/// of the poses decides.
const CROSSED: f64 = 1.0e-2;

/// Share of what is left between the axes that one query may take: however often a pair meets, something is left.
/// Larger, and a few meetings bring the axes to rounding; smaller, and pairs that are pressed meet more often.
const SINK_SHARE: f64 = 0.0625;

/// Distance of axes, in units of the asked tolerance, from which on that share is taken: in what is pressed on and
/// on the axes come as near as that, and hardly nearer. Smaller, and rounding of poses puts sheets and wires of
/// radius 0 past each other; larger, and what is thinner than that no longer sinks in at all.
const NEAR_AXES: f64 = 0.25;

/// Share of what is left between axes that are nearer than that which one query may take.
const SINK_SHARE_NEAR_AXES: f64 = 1.0e-4;

/// Share of the way that a query may take which is its tolerance.
const TOLERANCE_SHARE: f64 = 0.25;

/// Condition from which on two primitives count as in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Factor by which all radii are multiplied, from 0 to 1.
    pub scale: f64,
    /// Signed distance of the primitives with these radii that counts as a contact, a length.
    pub target: f64,
    /// Tolerance of that distance, a length.
    pub tolerance: f64,
}

impl Threshold {
    /// The threshold of primitives whose radii stay as they are.
    pub fn new(target: f64, tolerance: f64) -> Self {
        Self {
            scale: 1.0,
            target,
            tolerance,
        }
    }

    /// The threshold of primitives that touch at the start, at the signed distance `distance`: they may get deeper
    /// by `by`, but never as deep as their axes. `thinnest` is the smallest sum of a radius of each, `axes` the
    /// distance of their medial axes at the start.
    pub fn deepened(
        distance: f64,
        thinnest: f64,
        by: f64,
        tolerance: f64,
        axes: impl FnOnce() -> f64,
    ) -> Self {
        let target = distance - by - tolerance;
        let plain = Self::new(target, tolerance);
        // The least distance of the axes where that is met.
        if thinnest + target >= by {
            return plain;
        }
        let axes = axes();
        if axes <= CROSSED * tolerance {
            return plain;
        }
        let by = given(by, axes, tolerance);
        let tolerance = tolerance.min(TOLERANCE_SHARE * by);
        let (scale, target) = if distance > by {
            (1.0, distance - by)
        } else {
            ((axes - by) / (axes - distance), 0.0)
        };
        Self {
            scale,
            target,
            tolerance,
        }
    }
}

/// How much deeper one query may let two primitives get, whose axes are that far from each other.
pub(super) fn given(by: f64, axes: f64, tolerance: f64) -> f64 {
    let share = SINK_SHARE * (axes - NEAR_AXES * tolerance);
    by.min(share.max(SINK_SHARE_NEAR_AXES * axes))
}

/// How far two primitives that touch at the start may certainly travel before they are in contact by
/// [`Threshold::deepened`], a length, if their axes are at least `axes` apart, a length above 0.
pub fn free_way(by: f64, axes: f64, tolerance: f64) -> f64 {
    (1.0 - TOLERANCE_SHARE) * given(by, axes, tolerance)
}
