//! Signed distance of two sets of interpolated spheres at a fixed time, with its own proof.
//!
//! Independent of the crate: no case table, no closed form, no code shared. The distance is
//! `S = min over λ of |Σ λ_k z_k| − Σ λ_k R_k`, with `λ` in the simplex over the corners
//! `k` = (sphere of one side, sphere of the other), `z_k` the difference of their centres and
//! `R_k` the sum of their radii (paper, Eq. 2). As `|y| = max n·y` over `|n| ≤ 1`, exchanging the
//! two (von Neumann's minimax theorem: both sets are convex and compact) gives the concave twin
//! ```text
//! S = max over |n| ≤ 1 of g(n),    g(n) = min over k of n·z_k − R_k
//! ```
//! which holds for any sign of `S`. Any `λ` bounds `S` from above and any `n` from below, so a
//! pair `(λ, n)` is a proof, up to the rounding of the two sums.
//!
//! The pair comes from a primal-dual interior-point method (Mehrotra's predictor–corrector, SIAM
//! J. Optim. 2, 1992) on: maximise `τ` subject to `s_k = n·z_k − R_k − τ ≥ 0` and
//! `q = 1 − |n|² ≥ 0`, with multipliers `λ_k` and `ν`. Optimality: `Σ λ_k = 1`, `Σ λ_k z_k = ν n`,
//! `λ_k s_k = 0`, `ν q = 0`. Parallel, coincident or zero-length bodies need no special case: the
//! unknowns are `n` and `τ` alone, whatever the corners are.

use nalgebra::{Cholesky, Const, Matrix3, Vector3};

/// Most corners: two slabs, at both ends of an interval of time.
const MAX_CORNERS: usize = 18;

/// Gap of the two bounds at which a distance counts as solved, in units of the problem's scale.
/// The bounds prove themselves, so this decides only how sharp they are.
const GAP: f64 = 1.0e-13;

/// Steps after which the bounds are given as they are. Eight is usual, 30 the most that helped.
/// Where medial surfaces are made to cross and rounding leaves them 1e-8 apart, one search in a
/// hundred stalls with bounds that far from each other.
const MAX_STEPS: usize = 60;

/// Part of the way to the nearest constraint that a step takes: the usual choice.
const TO_BOUNDARY: f64 = 0.995;

/// Added to the diagonal, in units of the trace, where rounding leaves the step's equations
/// without a positive pivot (a distance of 0 between bodies that touch in a plane).
const SHIFT: f64 = 8.0 * f64::EPSILON;

/// Smallest slack of a constraint, above the rounding of `n·z_k − R_k` at scale 1.
const LEAST_SLACK: f64 = 4.0 * f64::EPSILON;

/// One number per corner; those past the last corner stay 0.
pub type PerCorner = [f64; MAX_CORNERS];

/// Differences of the spheres of two bodies: centres `z` and radius sums `r`.
#[derive(Clone, Copy, Debug)]
pub struct Corners {
    z: [Vector3<f64>; MAX_CORNERS],
    r: PerCorner,
    len: usize,
}

impl Corners {
    /// No corner yet.
    pub fn new() -> Self {
        Self {
            z: [Vector3::zeros(); MAX_CORNERS],
            r: [0.0; MAX_CORNERS],
            len: 0,
        }
    }

    /// Adds one difference of centres and its sum of radii.
    pub fn push(&mut self, z: Vector3<f64>, r: f64) {
        self.z[self.len] = z;
        self.r[self.len] = r;
        self.len += 1;
    }

    /// The differences of centres.
    pub fn centers(&self) -> &[Vector3<f64>] {
        &self.z[..self.len]
    }

    /// Largest `|z_k|` plus largest `R_k`.
    pub fn scale(&self) -> f64 {
        let z = self.z[..self.len].iter().map(|z| z.norm());
        z.fold(0.0, f64::max) + self.largest_radius()
    }

    /// The difference of centres and the radius sum of the spheres interpolated by `λ`.
    pub fn blend(&self, weights: &PerCorner) -> (Vector3<f64>, f64) {
        (0..self.len).fold((Vector3::zeros(), 0.0), |(z, r), k| {
            (z + self.z[k] * weights[k], r + self.r[k] * weights[k])
        })
    }

    /// `g(n)`, a lower bound of the signed distance for `|n| ≤ 1`.
    pub fn support(&self, n: &Vector3<f64>) -> f64 {
        let gap = |k| n.dot(&self.z[k]) - self.r[k];
        (0..self.len).map(gap).fold(f64::INFINITY, f64::min)
    }

    fn largest_radius(&self) -> f64 {
        self.r[..self.len].iter().copied().fold(0.0, f64::max)
    }
}

/// Bounds of a signed distance, and what proves them.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    /// The distance is at least this.
    pub lower: f64,
    /// The distance is at most this.
    pub upper: f64,
    /// The `n` that proves `lower`: from the second body to the first, at most of length 1.
    pub normal: Vector3<f64>,
    /// The `λ` that proves `upper`, in the order the corners were pushed.
    pub weights: PerCorner,
    /// Steps of the method.
    pub steps: usize,
}

/// What is to be known of a distance.
#[derive(Clone, Copy, Debug)]
pub enum Goal {
    /// Its value.
    Value,
    /// Whether it exceeds a threshold.
    Side(f64),
}

/// Bounds the signed distance.
pub fn distance(corners: &Corners, goal: Goal) -> Distance {
    // All bodies points in one place still need a unit.
    let scale = corners.scale().max(f64::MIN_POSITIVE);
    let mut unit = *corners;
    for k in 0..unit.len {
        unit.z[k] /= scale;
        unit.r[k] /= scale;
    }
    let mut found = solve(&unit, |bounds| match goal {
        Goal::Value => bounds.upper - bounds.lower <= GAP,
        Goal::Side(threshold) => {
            bounds.lower > threshold / scale || bounds.upper <= threshold / scale
        }
    });
    found.lower *= scale;
    found.upper *= scale;
    found
}

/// The method itself, on corners of scale 1.
fn solve(corners: &Corners, done: impl Fn(&Distance) -> bool) -> Distance {
    let count = corners.len;
    let mut lambda = [0.0; MAX_CORNERS];
    lambda[..count].fill(1.0 / count as f64);
    let mut iterate = Iterate {
        n: Vector3::zeros(),
        tau: -corners.largest_radius() - 1.0,
        nu: 1.0,
        lambda,
    };
    let mut best = Distance {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        normal: iterate.n,
        weights: lambda,
        steps: 0,
    };
    loop {
        iterate.record(corners, &mut best);
        if done(&best) || best.steps == MAX_STEPS {
            return best;
        }
        // None where |n| has reached 1 to the last digit.
        let Some(newton) = Newton::new(corners, &iterate) else {
            return best;
        };
        best.steps += 1;
        let mean = newton.complementarity(None);
        let ahead = newton.step(0.0, None);
        let after = newton.complementarity(Some((&ahead, newton.reach(&ahead, 1.0))));
        let target = mean * (after / mean).clamp(0.0, 1.0).powi(3);
        let step = newton.step(target, Some(&ahead));
        let length = newton.reach(&step, TO_BOUNDARY);
        let (nu, tau) = (newton.nu, newton.tau);
        iterate.n += step.n * length;
        iterate.tau = tau + step.tau * length;
        iterate.nu = nu + step.nu * length;
        for k in 0..count {
            iterate.lambda[k] += step.lambda[k] * length;
        }
    }
}

/// The unknowns.
struct Iterate {
    n: Vector3<f64>,
    tau: f64,
    nu: f64,
    lambda: PerCorner,
}

impl Iterate {
    /// Keeps the better of the bounds so far and those of this iterate.
    fn record(&self, corners: &Corners, best: &mut Distance) {
        // Where g > 0, the unit vector along n gives more.
        let unit = self.n / self.n.norm().max(f64::MIN_POSITIVE);
        for n in [self.n, unit] {
            let lower = corners.support(&n);
            if lower > best.lower {
                best.lower = lower;
                best.normal = n;
            }
        }
        let sum: f64 = self.lambda[..corners.len].iter().sum();
        let (y, radius) = corners.blend(&self.lambda);
        let upper = (y.norm() - radius) / sum;
        if upper < best.upper {
            best.upper = upper;
            best.weights = self.lambda.map(|l| l / sum);
        }
    }
}

/// A direction of change.
struct Step {
    n: Vector3<f64>,
    tau: f64,
    nu: f64,
    lambda: PerCorner,
    s: PerCorner,
}

/// Newton's equations of the optimality conditions at an interior iterate.
///
/// With `w_k = λ_k / s_k`, eliminating `Δs`, `Δλ`, `Δν` and then `Δτ` leaves
/// `(Σ w_k (z_k − z̄)(z_k − z̄)ᵀ + ν I + (2ν/q) n nᵀ) Δn = b`, `z̄` the mean of `z` under `w`:
/// symmetric and positive definite for any corners.
struct Newton<'a> {
    z: &'a [Vector3<f64>],
    n: Vector3<f64>,
    nu: f64,
    tau: f64,
    lambda: &'a PerCorner,
    s: PerCorner,
    q: f64,
    w: PerCorner,
    sum: f64,
    mean: Vector3<f64>,
    factor: Cholesky<f64, Const<3>>,
}

impl<'a> Newton<'a> {
    fn new(corners: &'a Corners, iterate: &'a Iterate) -> Option<Self> {
        let z = &corners.z[..corners.len];
        let Iterate { n, lambda, .. } = iterate;
        let q = 1.0 - n.norm_squared();
        if q <= 0.0 {
            return None;
        }
        // Rounding may have put τ above what n allows.
        let tau = iterate.tau.min(corners.support(n) - LEAST_SLACK);
        let (mut s, mut w) = ([0.0; MAX_CORNERS], [0.0; MAX_CORNERS]);
        let (mut y, mut sum, mut mean) = (Vector3::zeros(), 0.0, Vector3::zeros());
        for k in 0..z.len() {
            s[k] = n.dot(&z[k]) - corners.r[k] - tau;
            w[k] = lambda[k] / s[k];
            y += z[k] * lambda[k];
            sum += w[k];
            mean += z[k] * w[k];
        }
        mean /= sum;
        // ν n = y with |n| ≤ 1 needs ν ≥ |y|. A smaller ν, which the linear steps allow, leaves the
        // equations with next to no curvature when y is small, and steps that the ball cuts to
        // nothing: one in a thousand searches got stuck.
        let nu = iterate.nu.max(y.norm());
        let mut matrix = Matrix3::identity() * nu + n * n.transpose() * (2.0 * nu / q);
        for k in 0..z.len() {
            let d = z[k] - mean;
            matrix += d * d.transpose() * w[k];
        }
        let factor = matrix.cholesky().or_else(|| {
            let shift = SHIFT * matrix.trace();
            (matrix + Matrix3::identity() * shift).cholesky()
        })?;
        Some(Self {
            z,
            n: *n,
            nu,
            tau,
            lambda,
            s,
            q,
            w,
            sum,
            mean,
            factor,
        })
    }

    /// The step towards `λ_k s_k = ν q = target`; `ahead` adds the second-order terms of the step
    /// tried before.
    fn step(&self, target: f64, ahead: Option<&Step>) -> Step {
        let Self {
            z,
            n,
            nu,
            tau: _,
            lambda,
            s,
            q,
            w,
            ..
        } = self;
        // Δλ_k = e_k − w_k (z_k·Δn − Δτ) and Δν = e_ν + (2ν/q) n·Δn
        let mut e = [0.0; MAX_CORNERS];
        let mut residual_n = -n * *nu;
        let mut residual_tau = 1.0;
        for k in 0..z.len() {
            let second = ahead.map_or(0.0, |a| a.lambda[k] * a.s[k]);
            e[k] = (target - second) / s[k] - lambda[k];
            residual_n += z[k] * (lambda[k] + e[k]);
            residual_tau -= lambda[k] + e[k];
        }
        // Change of ν q along `ahead` beyond its linear part: Δν Δq − ν |Δn|².
        let second = ahead.map_or(0.0, |a| -2.0 * n.dot(&a.n) * a.nu - nu * a.n.norm_squared());
        let e_nu = (target - second) / q - nu;
        residual_n -= n * e_nu;
        // M Δn − Σ w_k z_k Δτ = residual_n and −Σ w_k z_k·Δn + Σ w_k Δτ = residual_tau, where
        // M = Σ w_k z_k z_kᵀ + ν I + (2ν/q) n nᵀ. The second row gives Δτ.
        let dn = self.factor.solve(&(residual_n + self.mean * residual_tau));
        let dtau = self.mean.dot(&dn) + residual_tau / self.sum;
        let (mut dlambda, mut ds) = ([0.0; MAX_CORNERS], [0.0; MAX_CORNERS]);
        for k in 0..z.len() {
            ds[k] = z[k].dot(&dn) - dtau;
            dlambda[k] = e[k] - w[k] * ds[k];
        }
        Step {
            n: dn,
            tau: dtau,
            nu: e_nu + 2.0 * nu / q * n.dot(&dn),
            lambda: dlambda,
            s: ds,
        }
    }

    /// How far along a step all constraints and multipliers stay positive: `part` of the way to
    /// the first that does not, at most 1.
    fn reach(&self, step: &Step, part: f64) -> f64 {
        let mut reach: f64 = 1.0 / part;
        for k in 0..self.z.len() {
            if step.s[k] < 0.0 {
                reach = reach.min(-self.s[k] / step.s[k]);
            }
            if step.lambda[k] < 0.0 {
                reach = reach.min(-self.lambda[k] / step.lambda[k]);
            }
        }
        if step.nu < 0.0 {
            reach = reach.min(-self.nu / step.nu);
        }
        // |n + x Δn|² = 1, in the form that loses no digits for either sign of n·Δn.
        let (b, c) = (self.n.dot(&step.n), step.n.norm_squared());
        let denominator = (b * b + c * self.q).sqrt() + b;
        if denominator > 0.0 {
            reach = reach.min(self.q / denominator);
        }
        part * reach
    }

    /// Mean of the products `λ_k s_k` and `ν q`, now or after a step of a given length.
    fn complementarity(&self, after: Option<(&Step, f64)>) -> f64 {
        let products = match after {
            None => {
                (0..self.z.len()).fold(self.nu * self.q, |sum, k| sum + self.lambda[k] * self.s[k])
            }
            Some((step, length)) => {
                let q = 1.0 - (self.n + step.n * length).norm_squared();
                (0..self.z.len()).fold((self.nu + length * step.nu) * q, |sum, k| {
                    let lambda = self.lambda[k] + length * step.lambda[k];
                    sum + lambda * (self.s[k] + length * step.s[k])
                })
            }
        };
        products / (self.z.len() + 1) as f64
    }
}
