//! Lower bounds of the distance that hold for all interpolation parameters at once, and how long
//! they stay positive. They replace the paper's termination conditions (§4.4), which accept a
//! local minimum as proof of a miss.
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
use crate::math::tolerance::{NEVER, PARALLEL_ULPS, TURNING_REGULARISATION};

/// Edges of the domain along which the nearest sphere pair is free to move, with their rates and
/// radius slopes; zero where it is not.
#[derive(Clone, Copy)]
pub struct ActiveFace<L> {
    edge: [Vec3<L>; 2],
    rate: [Vec3<L>; 2],
    slope: [L; 2],
}

impl<L: Lane> ActiveFace<L> {
    /// Reads the face off the parameters of the nearest pair.
    #[inline(always)]
    pub fn new(domain: Domain, f: &Family<L>, s: &Nearest<L>, rates: &[Vec3<L>; 4]) -> Self {
        let (zero, one) = (L::zero(), L::one());
        let (u_rate, v_rate) = (rates[1] - rates[0], rates[2] - rates[0]);
        let free_a = zero.lt(s.alpha) & s.alpha.lt(one);
        let free_b = zero.lt(s.beta) & s.beta.lt(one);
        let none = Vec3::zero();
        // On the triangle's third edge, α + β = 1, the only freedom is from u to v.
        let third = match domain {
            Domain::Box => L::Mask::splat(false),
            Domain::Triangle => {
                free_a & free_b & (L::splat(1.0 - 8.0 * L::EPSILON)).lt(s.alpha + s.beta)
            }
        };
        let second = free_b & !third;
        let pick =
            |along: Vec3<L>, u: Vec3<L>| Vec3::select(third, along, Vec3::select(free_a, u, none));
        Self {
            edge: [pick(f.v - f.u, f.u), Vec3::select(second, f.v, none)],
            rate: [
                pick(v_rate - u_rate, u_rate),
                Vec3::select(second, v_rate, none),
            ],
            slope: [
                L::select(third, f.db - f.da, L::select(free_a, f.da, zero)),
                L::select(second, f.db, zero),
            ],
        }
    }

    /// A unit direction with `n·e = d` along the free edges, as optimality asks. `y/|y|` alone is
    /// ill-conditioned for thin primitives: without this 8–13 % of such queries stall in `f32`.
    /// Of the two the one with the larger bound is kept.
    #[inline(always)]
    pub fn direction(&self, domain: Domain, f: &Family<L>, s: &Nearest<L>) -> Vec3<L> {
        let tiny = L::splat(L::TINY);
        let one = L::one();
        let rough = s.y * (one / s.length.max(tiny));
        let [e1, e2] = self.edge;
        let (g11, g22, g12) = (e1.length_sq(), e2.length_sq(), e1.dot(e2));
        let (r1, r2) = (rough.dot(e1) - self.slope[0], rough.dot(e2) - self.slope[1]);
        let least = L::splat(PARALLEL_ULPS * L::EPSILON) * g11 * g22;
        let determinant = (g11 * g22 - g12 * g12).max(least);
        let both = tiny.lt(determinant);
        let inverse = one / L::select(both, determinant, one);
        let k1 = L::select(both, (r1 * g22 - r2 * g12) * inverse, r1 / g11.max(tiny));
        let k2 = L::select(both, (r2 * g11 - r1 * g12) * inverse, r2 / g22.max(tiny));
        let refined = rough - e1 * k1 - e2 * k2;
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
    let n = passing * (L::one() / passing.length().max(tiny));
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
