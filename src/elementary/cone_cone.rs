//! Which interpolated spheres of two medial cones are nearest to each other, at a fixed time. Source: paper §4.2,
//! Eq. (2) at fixed `t`, the QCQP of its reference 23, solved in closed form (derivation in
//! [`crate::math::nearest`]).
//!
//! Corners of the parameter box, in the order used everywhere: `(α, β)` = (0, 0), (1, 0), (0, 1),
//! (1, 1), with `y = c2(β) − c1(α)`.
//!
//! | case | minimum |
//! |---|---|
//! | axes skew, foot points inside both | interior stationary point |
//! | foot outside one segment | edge of the box, clamped |
//! | parallel or collinear axes | edge of the box: `u × v = 0`, no interior point |
//! | one end sphere contains the other | that end: `D ≤ 0` in the edge case |
//! | zero length (a sphere) | both ends agree |
//! | axes cross | interior, `y = 0`, `S = −R` |

use crate::math::lane::{Lane, Vec3};
use crate::math::nearest::{Family, Nearest, nearest_in_box};

/// Family of difference vectors from three of the corners and their radius sums.
#[inline(always)]
pub fn family<L: Lane>(y: &[Vec3<L>; 4], radius: &[L; 4]) -> Family<L> {
    Family {
        w: y[0],
        u: y[1] - y[0],
        v: y[2] - y[0],
        r0: radius[0],
        da: radius[1] - radius[0],
        db: radius[2] - radius[0],
    }
}

/// Nearest sphere pair: `α` on the first cone, `β` on the second.
#[inline(always)]
pub fn nearest_spheres<L: Lane>(f: &Family<L>) -> Nearest<L> {
    nearest_in_box(f)
}
