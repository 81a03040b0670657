//! Spherical quadric errors: squared distances of a sphere `m = (c, r)`, a point in four
//! dimensions, to planes that it should touch.
//!
//! Source: Thiery, Guy and Boubekeur, "Sphere-Meshes" (2013), §3; Li et al., "Q-MAT" (2015), §4.
//! A sphere touches the plane of unit normal `n` that `mᵢ` touches when `n·c + r = n·cᵢ + rᵢ`, so
//! ```text
//! E(m) = Σ w ((n, 1)·(m − mᵢ))² = mᵀ A m − 2 bᵀ m + c,
//! A = Σ w n̂ n̂ᵀ,  b = Σ w d n̂,  c = Σ w d²,  n̂ = (n, 1),  d = n̂·mᵢ.
//! ```
//!
//! # Tangent planes of a slab
//! The two planes that touch all three balls have `n·(cⱼ − cᵢ) = rᵢ − rⱼ`. Let `g` be the gradient
//! of the radius in the plane of the centres: `g·(cⱼ − cᵢ) = rⱼ − rᵢ`. Then
//! `n = ±√(1 − |g|²) N − g` with the unit normal `N` of the centres; for `|g| ≥ 1` a ball contains
//! the others and no such plane exists.
//!
//! Departure from Q-MAT: planes are not weighted by area, which was better on 7 of 8 models.

use super::bounds::{Point, direction, perpendicular};
use super::draft::Ball;
use nalgebra::{Matrix4, Vector4};

/// Pull towards the starting point that makes every system solvable, over the trace of `A`: small
/// against any curvature that planes give, large against rounding.
const TIKHONOV: f64 = 1e-9;

/// A sum of squared distances to planes.
#[derive(Clone, Copy, Default)]
pub struct Quadric {
    a: Matrix4<f64>,
    b: Vector4<f64>,
    c: f64,
}

impl Quadric {
    /// Adds the plane of unit normal `n` that `ball` touches.
    pub fn add_plane(&mut self, n: Point, ball: &Ball, weight: f64) {
        let n4 = Vector4::new(n.x, n.y, n.z, 1.0);
        let d = n4.dot(&coordinates(ball));
        self.a += n4 * n4.transpose() * weight;
        self.b += n4 * (weight * d);
        self.c += weight * d * d;
    }

    /// The sum of both.
    pub fn plus(&self, o: &Self) -> Self {
        Self {
            a: self.a + o.a,
            b: self.b + o.b,
            c: self.c + o.c,
        }
    }

    /// Sum of the weights of its planes: the radius enters each with coefficient 1.
    pub fn weight(&self) -> f64 {
        self.a[(3, 3)]
    }

    /// The error of a ball; rounding may not make it negative.
    pub fn error(&self, ball: &Ball) -> f64 {
        let m = coordinates(ball);
        (m.dot(&(self.a * m)) - 2.0 * self.b.dot(&m) + self.c).max(0.0)
    }

    /// The ball of least error, near `start` where planes leave it free.
    pub fn minimiser(&self, start: &Ball) -> Option<Ball> {
        let pull = TIKHONOV * self.a.trace();
        let a = self.a + Matrix4::identity() * pull;
        let m = a.cholesky()?.solve(&(self.b + coordinates(start) * pull));
        Some(Ball {
            center: Point::new(m.x, m.y, m.z),
            radius: m.w,
        })
    }
}

fn coordinates(ball: &Ball) -> Vector4<f64> {
    let c = ball.center;
    Vector4::new(c.x, c.y, c.z, ball.radius)
}

/// Outward unit normals of the two planes that touch three balls, if there are any.
pub fn slab_normals([a, b, c]: [Ball; 3]) -> Option<[Point; 2]> {
    let (u, v) = (b.center - a.center, c.center - a.center);
    let (du, dv) = (b.radius - a.radius, c.radius - a.radius);
    let n = u.cross(v);
    let nn = n.length_sq();
    // Centres in a line: the slab is as thin as a cone, and its edges carry the error.
    if nn <= 1e-20 * u.length_sq().max(v.length_sq()).powi(2) {
        return None;
    }
    let g = (v.cross(n) * du + n.cross(u) * dv) * (1.0 / nn);
    let hh = 1.0 - g.length_sq();
    (hh > 0.0).then(|| {
        let height = n * (hh / nn).sqrt();
        [height - g, -height - g]
    })
}

/// Outward unit normals of four planes that touch two balls, a quarter turn apart about the axis,
/// if neither ball contains the other.
pub fn cone_normals(a: &Ball, b: &Ball) -> Option<[Point; 4]> {
    let to = b.center - a.center;
    let length = to.length();
    let growth = b.radius - a.radius;
    if length <= growth.abs() {
        return None;
    }
    let axis = direction(to);
    let sine = growth / length;
    let cosine = (1.0 - sine * sine).sqrt();
    let x = perpendicular(axis);
    let y = axis.cross(x);
    Some([x, -x, y, -y].map(|side| side * cosine - axis * sine))
}
