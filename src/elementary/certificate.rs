//! The certificate: lower bounds of the distance of two primitives that hold for all of their interpolated spheres
//! at once, and how long these bounds stay positive. They replace the paper's termination conditions (§4.4), which
//! take a local minimum for proof of a miss. On a device `stays_free` in `shaders/elementary.wgsl` proves by fixed
//! directions in the same way.
//!
//! # Fixed direction
//! For a unit `n`, `D(t) ≥ min over corners of n·y_i(t) − R_i`: the right-hand side is affine in
//! the parameters, so its minimum is at a corner, and `n·y ≤ |y|`. It stays positive while every
//! corner's `a0 + a1 τ + a2 τ²` does, with
//! ```text
//! a0 = n·y_i − R_i − slack     a1 = n·ẏ_i     a2 = 0 on straight paths
//! ```
//! # Turning direction
//! For `n(τ) = n + τ m` with `m ⊥ n`, `|n(τ)| ≤ 1 + τ²m²/2`, so `D > 0` while every corner has
//! ```text
//! a0 as above     a1 = n·ẏ_i + m·y_i     a2 = m·ẏ_i − ½ m² max(R_i, 0)
//! ```
//! Any `m` is sound. The best one keeps `n` normal to the active face of the domain to first
//! order, so that the bound is tangent to `D`.
//!
//! # Curved paths
//! With `|ÿ| ≤ A`, `|y⃛| ≤ J`, `|n(τ)| ≤ f` for `τ ≤ h`, Taylor's remainder adds to `a2` the larger
//! of `−fA/2` (position to second order unknown) and `n·ÿ/2 − h|m|A/2 − f h J/6` (known, third
//! order unknown).

use super::path::{Corners, Path};
use super::test_list::Domain;
use crate::math::lane::{Lane, Mask, Vec3};
use crate::math::nearest::{Family, Nearest};
use crate::math::tolerance::{NEVER, TURNING_REGULARISATION};

/// Edges of the domain along which the nearest sphere pair is free to move, with their rates and
/// radius slopes; zero where it is not.
#[derive(Clone, Copy)]
pub struct ActiveFace<L> {
    /// Direction of the nearest pair, `y/|y|`.
    rough: Vec3<L>,
    edge: [Vec3<L>; 2],
    rate: [Vec3<L>; 2],
    slope: [L; 2],
}

impl<L: Lane> ActiveFace<L> {
    /// Reads the face off the parameters of the nearest pair. A bound of the domain holds the pair only
    /// where the distance falls beyond it (the sign of its Lagrange multiplier): among pairs that differ
    /// by rounding alone, the one found may lie on a bound that the nearest one does not touch, and a
    /// direction for that corner would prove nothing.
    #[inline(always)]
    pub fn new(domain: Domain, f: &Family<L>, s: &Nearest<L>, rates: &[Vec3<L>; 4]) -> Self {
        let (zero, one) = (L::zero(), L::one());
        let none = Vec3::zero();
        let rough = s.y * (one / s.length.max(L::splat(L::TINY).sqrt()));
        let (u_rate, v_rate) = (rates[1] - rates[0], rates[2] - rates[0]);
        // How fast the distance grows with α and β.
        let (a, b) = (rough.dot(f.u) - f.da, rough.dot(f.v) - f.db);
        let (first, second) = (s.alpha.le(zero), s.beta.le(zero));
        let (third, free_a, free_b) = match domain {
            Domain::Box => {
                let held_a = (first & zero.le(a)) | (one.le(s.alpha) & a.le(zero));
                let held_b = (second & zero.le(b)) | (one.le(s.beta) & b.le(zero));
                (L::Mask::splat(false), !held_a, !held_b)
            }
            Domain::Triangle => {
                let last = L::splat(1.0 - 8.0 * L::EPSILON).lt(s.alpha + s.beta);
                let held_a = first & L::select(last, b, zero).le(a);
                let held_b = second & L::select(last, a, zero).le(b);
                let held_sum = last & L::select(second, a, b).le(zero);
                // On the third edge, α + β = 1, the only freedom is from u to v.
                let third = held_sum & !(held_a | held_b);
                (third, !(held_a | held_sum), !(held_b | held_sum))
            }
        };
        let pick =
            |along: Vec3<L>, u: Vec3<L>| Vec3::select(third, along, Vec3::select(free_a, u, none));
        Self {
            rough,
            edge: [pick(f.v - f.u, f.u), Vec3::select(free_b, f.v, none)],
            rate: [
                pick(v_rate - u_rate, u_rate),
                Vec3::select(free_b, v_rate, none),
            ],
            slope: [
                L::select(third, f.db - f.da, L::select(free_a, f.da, zero)),
                L::select(free_b, f.db, zero),
            ],
        }
    }

    /// A unit direction with `n·e = d` along the free edges, as optimality asks. `y/|y|` alone is ill-conditioned for
    /// thin primitives: without this 8–13 % of such queries stall in `f32`. The one of the two with the larger bound is
    /// kept.
    #[inline(always)]
    pub fn direction(&self, domain: Domain, f: &Family<L>) -> Vec3<L> {
        let tiny = L::splat(L::TINY);
        let one = L::one();
        let rough = self.rough;
        let [e1, e2] = self.edge;
        let inverse = one / e1.length_sq().max(tiny);
        // The second edge across the first: near-parallel edges keep their digits so.
        let k = e1.dot(e2) * inverse;
        let across = e2 - e1 * k;
        let r1 = rough.dot(e1) - self.slope[0];
        let r2 = rough.dot(across) - (self.slope[1] - self.slope[0] * k);
        let k2 = r2 / across.length_sq().max(tiny);
        let refined = rough - e1 * (r1 * inverse) - across * k2;
        let refined = refined * (one / refined.length_sq().max(tiny).sqrt());
        let better = lower_bound(domain, f, rough).lt(lower_bound(domain, f, refined));
        Vec3::select(better, refined, rough)
    }

    /// Rate of change of the optimal direction: the optimality conditions `n·e = d`, `n ∥ y`,
    /// differentiated on the active face.
    #[inline(always)]
    pub fn turning_rate(&self, s: &Nearest<L>, n: Vec3<L>, y_rate: Vec3<L>) -> Vec3<L> {
        let one = L::one();
        let [e1, e2] = self.edge;
        let (n1, n2, along) = (n.dot(e1), n.dot(e2), n.dot(y_rate));
        let regular = |g: L| {
            L::select(
                g.le(L::splat(L::TINY)),
                one,
                g * L::splat(1.0 + TURNING_REGULARISATION),
            )
        };
        let a11 = regular(e1.length_sq() - n1 * n1);
        let a22 = regular(e2.length_sq() - n2 * n2);
        let a12 = e1.dot(e2) - n1 * n2;
        let b1 = -(s.length * self.rate[0].dot(n) + e1.dot(y_rate) - n1 * along);
        let b2 = -(s.length * self.rate[1].dot(n) + e2.dot(y_rate) - n2 * along);
        let determinant = (a11 * a22 - a12 * a12).max(a11 * a22 * L::splat(TURNING_REGULARISATION));
        let x1 = (b1 * a22 - b2 * a12) / determinant;
        let x2 = (b2 * a11 - b1 * a12) / determinant;
        let moved = y_rate + e1 * x1 + e2 * x2;
        (moved - n * n.dot(moved)) * (one / s.length.max(L::splat(L::TINY)))
    }
}

/// Lower bound of the distance at a fixed time, from one unit direction: the minimum over corners.
#[inline(always)]
pub fn lower_bound<L: Lane>(domain: Domain, f: &Family<L>, n: Vec3<L>) -> L {
    let zero = L::zero();
    let du = n.dot(f.u) - f.da;
    let dv = n.dot(f.v) - f.db;
    let base = n.dot(f.w) - f.r0;
    match domain {
        Domain::Box => base + du.min(zero) + dv.min(zero),
        Domain::Triangle => base + du.min(dv).min(zero),
    }
}

/// First `τ > 0` with `a0 + a1 τ + a2 τ² = 0`, for `a0 > 0`; [`NEVER`] if there is none.
#[inline(always)]
pub fn first_root<L: Lane>(a0: L, a1: L, a2: L) -> L {
    let (zero, one) = (L::zero(), L::one());
    let discriminant = a1 * a1 - L::splat(4.0) * a2 * a0;
    let denominator = discriminant.max(zero).sqrt() - a1;
    let exists = zero.le(discriminant) & L::splat(L::TINY).lt(denominator);
    let root = L::splat(2.0) * a0 / L::select(exists, denominator, one);
    L::select(exists, root, L::splat(NEVER))
}

fn corner_count(domain: Domain) -> usize {
    match domain {
        Domain::Box => 4,
        Domain::Triangle => 3,
    }
}

/// How long two directions that need no nearest spheres prove straight paths free: from the middle
/// of the first body to that of the second when they are closest, which settles most misses, and
/// against the drift of the second, which leads to the neighbourhood of most contacts. Each costs a
/// tenth of an iteration of the bracket, and together they save a third of them.
#[inline(always)]
pub fn first_step<L: Lane, P: Path<L>>(
    path: &P,
    domain: Domain,
    c: &Corners<L>,
    slack: L,
    remaining: L,
) -> L {
    let tiny = L::splat(L::TINY);
    // Twice the middles of two opposite corners; lengths cancel.
    let last = corner_count(domain) - 1;
    let middle = c.y[0] + c.y[last];
    let drift = c.rate[0] + c.rate[last];
    let speed_sq = drift.length_sq().max(tiny);
    let closest = -(middle.dot(drift) / speed_sq);
    let passing = middle + drift * closest.max(L::zero()).min(remaining);
    let n = passing * (L::one() / passing.length().max(tiny.sqrt()));
    let step = fixed_step(path, domain, c, n, slack, remaining);
    let n = drift * -(L::one() / speed_sq.sqrt());
    step.max(fixed_step(path, domain, c, n, slack, remaining))
}

/// How long the bound of a fixed direction stays positive. A corner that is not positive now gives
/// 0 even when it recedes: the bound is a minimum, and it is not positive now.
#[inline(always)]
pub fn fixed_step<L: Lane, P: Path<L>>(
    path: &P,
    domain: Domain,
    c: &Corners<L>,
    n: Vec3<L>,
    slack: L,
    remaining: L,
) -> L {
    let (zero, half) = (L::zero(), L::splat(0.5));
    let mut step = L::splat(NEVER);
    for k in 0..corner_count(domain) {
        let a0 = n.dot(c.y[k]) - path.radius()[k] - slack;
        let a1 = n.dot(c.rate[k]);
        let root = if P::CURVED {
            let (a, j) = path.curvature(k);
            let known = half * n.dot(c.acceleration[k]) - remaining * j * L::splat(1.0 / 6.0);
            first_root(a0.max(zero), a1, (-(half * a)).max(known))
        } else {
            let falling = a1.lt(zero);
            let root = -(a0 / L::select(falling, a1, -L::one()));
            L::select(falling, root, L::splat(NEVER))
        };
        step = step.min(L::select(a0.le(zero), zero, root));
    }
    step
}

/// How long the bound of a turning direction stays positive; at most `1/|m|`, beyond which the
/// expansion of `|n(τ)|` is useless.
#[inline(always)]
pub fn turning_step<L: Lane, P: Path<L>>(
    path: &P,
    domain: Domain,
    c: &Corners<L>,
    n: Vec3<L>,
    m: Vec3<L>,
    slack: L,
    remaining: L,
) -> L {
    let (zero, one, half) = (L::zero(), L::one(), L::splat(0.5));
    let mm = m.length_sq();
    let turn = mm.sqrt();
    let cap = one / turn.max(L::splat(L::TINY));
    let horizon = remaining.min(cap);
    let stretch = (one + horizon * horizon * mm).sqrt();
    let mut step = L::splat(NEVER);
    for k in 0..corner_count(domain) {
        let radius = path.radius()[k];
        let a0 = n.dot(c.y[k]) - radius - slack;
        let a1 = n.dot(c.rate[k]) + m.dot(c.y[k]);
        let mut a2 = m.dot(c.rate[k]) - half * mm * radius.max(zero);
        if P::CURVED {
            let (a, j) = path.curvature(k);
            let known = half * n.dot(c.acceleration[k])
                - half * horizon * turn * a
                - stretch * horizon * j * L::splat(1.0 / 6.0);
            a2 = a2 + (-(half * stretch * a)).max(known);
        }
        let root = first_root(a0.max(zero), a1, a2);
        step = step.min(L::select(a0.le(zero), zero, root));
    }
    if P::CURVED {
        // The remainder holds for τ ≤ horizon only.
        step.min(horizon)
    } else {
        step.min(cap)
    }
}
