//! The sphere of a linearly interpolated family that is nearest to another: closed forms at a
//! fixed time. Source: paper §4.2, Eqs. (1) and (2) at fixed `t`, in Minkowski-difference form. Twin on a device:
//! `shaders/nearest.wgsl`.
//!
//! # Derivation
//! Subtracting the two families leaves one family of difference vectors and radius sums,
//! ```text
//! y(α, β) = w + α u + β v,    R(α, β) = r0 + α da + β db,    S(α, β) = |y| − R
//! ```
//! and `S`, the signed distance of Eq. (2), is convex in `(α, β)`: a norm of an affine map minus
//! an affine map. So its minimum over a box or a triangle is either the interior stationary point
//! or lies on an edge, where it is a convex function of one variable whose unconstrained minimum
//! may be clamped. We enumerate: interior and all edges, keep the smallest value.
//!
//! **Edge.** Along `y + x e` with radius slope `d`, put `D = |e|² − d²` and
//! `q = |y × e|²` (not `|y|²|e|² − (y·e)²`: its square root would keep only half of the digits where
//! `y` and `e` are parallel, a centre on a cone's axis). Stationarity,
//! `n·e = d` with `n = (y + x e)/|y + x e|`, gives `x = (d √(q/D) − y·e)/|e|²`. For `D ≤ 0` one
//! end sphere contains the other and `S` is monotone: the larger sphere's end wins.
//!
//! **Interior.** Stationarity asks for a unit `n` with `n·u = da`, `n·v = db`. With `v′ = v − k u` and
//! `w′` the parts of `v` and `w` across `u` (`k = u·v/|u|²`), `n·v′ = d′ = db − k da`, so the height of `n` over
//! the plane of `u` and `v` is `h`, `h² = 1 − da²/|u|² − d′²/|v′|²`. `y` is parallel to `n`, and its
//! height is that of `w`, `w″ = w′ − v′ (w′·v′)/|v′|²`: `|y| = s = |w″|/h`. Along `v′` and `u` then
//! `β = (s d′ − w′·v′)/|v′|²`, `α = (s da − u·w − β u·v)/|u|²`. It exists iff `h² > 0` and `u`, `v` are
//! independent. Near-parallel axes, at an angle `θ`, make `β` uncertain by some `EPSILON/θ`; but the
//! distance along the valley in which it moves changes by `θ` times that, since `α` follows `β`. (From the
//! reciprocal basis `v × N`, `N × u` with `N = u × v`, each would have an error of its own, and `y` would
//! be off by `√EPSILON` of the length of the axes.)
//!
//! A strip method (clamp one parameter, solve the other) is wrong by up to 0.13, coordinate
//! descent by 3e-2 in units of the input: hence the enumeration.

use super::lane::{Lane, Vec3};

/// Difference of two interpolated families at a fixed time: `y = w + α u + β v`,
/// `R = r0 + α da + β db`.
#[derive(Clone, Copy, Debug)]
pub struct Family<L> {
    /// `y` at α = β = 0.
    pub w: Vec3<L>,
    /// Change of `y` with α.
    pub u: Vec3<L>,
    /// Change of `y` with β.
    pub v: Vec3<L>,
    /// Sum of the radii at α = β = 0.
    pub r0: L,
    /// Change of the sum with α.
    pub da: L,
    /// Change of the sum with β.
    pub db: L,
}

/// A member of a [`Family`] and its signed distance.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<L> {
    /// First interpolation parameter.
    pub alpha: L,
    /// Second interpolation parameter.
    pub beta: L,
    /// Signed distance `S = |y| − R`.
    pub distance: L,
    /// Difference of the centres.
    pub y: Vec3<L>,
    /// `|y|`.
    pub length: L,
}

impl<L: Lane> Family<L> {
    /// The member at `(alpha, beta)`.
    #[inline(always)]
    pub fn at(&self, alpha: L, beta: L) -> Nearest<L> {
        let y = self.w + self.u * alpha + self.v * beta;
        let length = y.length();
        let radius = self.r0 + self.da * alpha + self.db * beta;
        Nearest {
            alpha,
            beta,
            distance: length - radius,
            y,
            length,
        }
    }
}

/// Minimiser over `x ∈ [0, 1]` of `|y + x e| − d x` (the edge case above).
#[inline(always)]
pub fn edge_minimum<L: Lane>(y: Vec3<L>, e: Vec3<L>, d: L) -> L {
    let ee = e.length_sq();
    let ye = y.dot(e);
    let q = y.cross(e).length_sq();
    let discriminant = ee - d * d;
    let contained = discriminant.le(ee * L::splat(2.0 * L::EPSILON));
    let safe_discriminant = L::select(contained, L::one(), discriminant);
    let safe_ee = L::select(contained, L::one(), ee);
    let x = (d * (q / safe_discriminant).sqrt() - ye) / safe_ee;
    let end = L::select(L::zero().lt(d), L::one(), L::zero());
    L::select(contained, end, x.clamp01())
}

/// The interior stationary point, not clamped, and whether it exists.
#[inline(always)]
pub fn interior_stationary<L: Lane>(f: &Family<L>) -> (L, L, L::Mask) {
    let (one, tiny) = (L::one(), L::splat(L::TINY));
    let (uu, uv, uw) = (f.u.length_sq(), f.u.dot(f.v), f.u.dot(f.w));
    let inverse_uu = one / uu.max(tiny);
    let k = uv * inverse_uu;
    let (v, w) = (f.v - f.u * k, f.w - f.u * (uw * inverse_uu));
    let vv = v.length_sq();
    let eps_sq = L::splat(64.0 * L::EPSILON * L::EPSILON);
    let independent = tiny.lt(uu) & (f.v.length_sq() * eps_sq + tiny).lt(vv);
    let inverse_vv = one / L::select(independent, vv, one);
    let d = f.db - f.da * k;
    let hh = one - f.da * f.da * inverse_uu - d * d * inverse_vv;
    let real = L::splat(L::EPSILON).lt(hh);
    let wv = w.dot(v);
    let height = w - v * (wv * inverse_vv);
    let s = (height.length_sq() / L::select(real, hh, one)).sqrt();
    let beta = (s * d - wv) * inverse_vv;
    let alpha = (s * f.da - uw - beta * uv) * inverse_uu;
    (alpha, beta, independent & real)
}

#[inline(always)]
fn nearer<L: Lane>(a: Nearest<L>, b: Nearest<L>) -> Nearest<L> {
    let m = b.distance.lt(a.distance);
    Nearest {
        alpha: L::select(m, b.alpha, a.alpha),
        beta: L::select(m, b.beta, a.beta),
        distance: L::select(m, b.distance, a.distance),
        y: Vec3::select(m, b.y, a.y),
        length: L::select(m, b.length, a.length),
    }
}

/// Minimum over the unit box `α, β ∈ [0, 1]`: interior and 4 edges.
#[inline(always)]
pub fn nearest_in_box<L: Lane>(f: &Family<L>) -> Nearest<L> {
    let (zero, one) = (L::zero(), L::one());
    let e0 = f.at(edge_minimum(f.w, f.u, f.da), zero);
    let e1 = f.at(edge_minimum(f.w + f.v, f.u, f.da), one);
    let e2 = f.at(zero, edge_minimum(f.w, f.v, f.db));
    let e3 = f.at(one, edge_minimum(f.w + f.u, f.v, f.db));
    let (alpha, beta, exists) = interior_stationary(f);
    let interior = f.at(
        L::select(exists, alpha.clamp01(), zero),
        L::select(exists, beta.clamp01(), zero),
    );
    nearer(nearer(nearer(e0, e1), nearer(e2, e3)), interior)
}

/// Minimum over the triangle `α, β ≥ 0`, `α + β ≤ 1`: interior and 3 edges.
#[inline(always)]
pub fn nearest_in_triangle<L: Lane>(f: &Family<L>) -> Nearest<L> {
    let (zero, one) = (L::zero(), L::one());
    let e0 = f.at(edge_minimum(f.w, f.u, f.da), zero);
    let e1 = f.at(zero, edge_minimum(f.w, f.v, f.db));
    let x = edge_minimum(f.w + f.u, f.v - f.u, f.db - f.da);
    let e2 = f.at(one - x, x);
    let (alpha, beta, exists) = interior_stationary(f);
    let inside = exists & zero.le(alpha) & zero.le(beta) & (alpha + beta).le(one);
    let interior = f.at(
        L::select(inside, alpha, zero),
        L::select(inside, beta, zero),
    );
    nearer(nearer(e0, e1), nearer(e2, interior))
}
