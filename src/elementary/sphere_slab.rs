//! Which interpolated sphere of a medial slab is nearest to a sphere, at a fixed time. Source: paper §4.2 ("its routine
//! can be readily generalized to sphere-slab tests"); derivation in [`crate::math::nearest`].
//!
//! Corners: the slab's three spheres; the fourth repeats the third. `α` weighs the second sphere,
//! `β` the third, the first has the rest.
//!
//! | case | minimum |
//! |---|---|
//! | foot inside the triangle | interior stationary point |
//! | foot outside, or a tangent plane does not exist (`|g| ≥ 1`) | one of the 3 edges, clamped |
//! | triangle without area | edges only |
//! | centre in the triangle's plane and inside | interior, `y = 0`, `S = −R` |

use crate::math::lane::Lane;
use crate::math::nearest::{Family, Nearest, nearest_in_triangle};

/// Nearest sphere of the slab: `α` and `β` as above.
#[inline(always)]
pub fn nearest_spheres<L: Lane>(f: &Family<L>) -> Nearest<L> {
    nearest_in_triangle(f)
}
