//! Every numeric constant of the queries, with its unit, its derivation and what breaks when it is
//! wrong.

use crate::math::Real;

/// Rounding slack of a certificate, in units of `EPSILON × scale` (no unit).
///
/// `scale` bounds the numbers whose rounding enters a bound of the distance ([`crate::elementary::path::Path::scale`]):
/// - on straight paths the largest `|y|` over the corners at both ends of the step, the largest radius sum, and
///   the target distance. A corner is one rounded difference of centres, wherever the world's origin is;
/// - in rigid motion the way and swing of a corner in the step, its arms from both centres of rotation, these
///   centres' distances from their bodies' origins, and the distance of those origins: positions are sums of these,
///   which may cancel where a body is far from its own origin.
///
/// A corner is a sum of at most 8 rounded terms of that size. Measured on 78,860 hits in `f32`: below 0.5 some
/// `lower` exceeded the true contact time, from 1 on none did; 8 leaves a margin of 8 and costs nothing but
/// a larger smallest tolerance. The slack is never below `√TINY` (1e-15 in `f32`, 1e-100 in `f64`, in the user's
/// unit), whose square is the smallest that keeps its digits.
pub const SLACK_ULPS: f64 = 8.0;

/// Smallest tolerance in units of the slack. At 2 the last step before contact is at least one
/// slack long, so the bracket always closes.
pub const TOLERANCE_PER_SLACK: f64 = 2.0;

/// Default contact distance, in the user's unit of length. A tenth of a millimetre when that is
/// the metre: below what a renderer shows, above what `f32` poses resolve within 500 m.
pub const TOLERANCE: f32 = 1.0e-4;

/// Default width at which the bracket of the contact time stops, as a fraction of the step.
pub const TIME_TOLERANCE: f32 = 1.0e-6;

/// Default cap of the bracket's iterations. Most queries need 2, hard ones up to 200; bodies that are
/// equal but for a few ulps and turn together need the most. Of ten million hard queries a cap of 64
/// left 1,944 unresolved in `f64` at tolerance 1e-9 and 269 in `f32` at 1e-4; 4096 leaves 56 and 0.
/// A lower cap bounds the time of the worst query, and costs an answer there.
pub const MAX_ITERATIONS: u32 = 4096;

/// Part of a certified time step that is taken, in units of `EPSILON` below 1: covers the rounding
/// of the division that gave it, and of the sum with the time reached.
pub const STEP_ULPS: f64 = 4.0;

/// Regularisation of the turning rate's normal equations (no unit). Only the quality of a direction
/// depends on it, never soundness: the corners are checked for whatever direction comes.
pub const TURNING_REGULARISATION: f64 = 1.0e-6;

/// Time that stands for "no root in the step", as a fraction of the step; any number above 1 serves.
pub const NEVER: f64 = 4.0;

/// Cosine from which two directions count as one (10°): those of contacts of one patch, of points of one manifold, and
/// of a normal and the same one after its body has turned. Smaller, and contacts of different faces have one normal;
/// larger, and normals that are only rounding's are told apart.
pub const ONE_DIRECTION: f64 = 0.985;

/// Rounding of a few sums and products of lengths, in units of `EPSILON` times the sum of their sizes (no unit). Not
/// tuned: far above what such a computation rounds. Too small, and a bound may be wrong by its rounding; larger, and
/// pairs are looked at that need not be.
pub const ROUNDING_ULPS: f64 = 64.0;

/// The same rounding in [`Real`], as a fraction of the sum of the sizes.
pub const REAL_ROUNDING: Real = ROUNDING_ULPS as Real * Real::EPSILON;

/// The same rounding in `f64`, as a fraction of the sum of the sizes.
pub const F64_ROUNDING: f64 = ROUNDING_ULPS * f64::EPSILON;

/// Rounding of up to ten operations in [`Real`] on numbers of one size, as a fraction of it: bounds of speeds, ways and
/// boxes are raised by it. Smaller, and a bound may be wrong by its rounding.
pub const FEW_OPERATIONS: Real = 16.0 * Real::EPSILON;

/// Rounding of heights of spheres along a direction that are compared, as a fraction of the coordinates: about eight
/// ulps of `f32`. Smaller, and faces at one height may count as lower and higher.
pub const HEIGHT_ROUNDING: Real = 1.0e-6;

/// Angle in radians that a body turns at most in a piece of a search: the sagitta is then below 3 % of the lever arm.
/// Larger pieces cull worse and prove less; smaller ones repeat the walk down the trees, and cost a pair each on a GPU.
pub const PIECE_ANGLE: f64 = 0.5;

/// Ratio of their radii up to which two nodes of trees are split together, here and in the shaders. With 1 (one at a
/// time) approaches take a fifth longer, fast queries a tenth; 1.5 is nearly as good.
pub const SIMILAR_RADII: f64 = 3.0;

/// Rounding slack of a bound computed on a GPU, in units of `EPSILON × scale` (no unit).
///
/// WGSL lets a device reassociate, fuse, divide to 2.5 ulps and flush what is subnormal. `scale` is
/// the sum of the lengths in play; the worst error measured over four orders of summation was 3
/// half-ulps of the terms' sum, at most some ten times `scale`. Too small, and a device may call
/// free what is not; larger only sends more to the CPU.
pub const GPU_SLACK_ULPS: f64 = 32.0;
