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
//! The tangent planes of a slab are those of `medial/exact.rs`.
//!
//! Departure from Q-MAT: planes are not weighted by area, which was better on 7 of 8 models.

use crate::math::sphere::Ball;
use crate::medial::exact::tangent_normals_beyond;
use crate::meshing::geometry::bounds::{Point, direction, perpendicular};

/// Pull towards the starting point that makes every system solvable, over the trace of `A`: small
/// against any curvature that planes give, large against rounding.
const TIKHONOV: f64 = 1e-9;

/// sin² of the angle between two edges of a slab, the longer taken for both (a pure number), below which it counts as a
/// cone.
const COLLINEAR_SIN_SQ: f64 = 1e-20;

type Vector4 = [f64; 4];

/// A sum of squared distances to planes.
#[derive(Clone, Copy, Default)]
pub struct Quadric {
    /// Lower triangle of the symmetric matrix, row by row: a collapse spends most of its time on sums
    /// of these.
    a: [f64; 10],
    b: Vector4,
    c: f64,
}

/// Place of the lower triangle's row and column in [`Quadric::a`], and of the same element above it.
const AT: [[usize; 4]; 4] = [[0, 1, 3, 6], [1, 2, 4, 7], [3, 4, 5, 8], [6, 7, 8, 9]];

impl Quadric {
    /// Adds the plane of unit normal `n` that `ball` touches.
    pub fn add_plane(&mut self, n: Point, ball: &Ball, weight: f64) {
        let n4 = [n.x, n.y, n.z, 1.0];
        let d = dot(n4, coordinates(ball));
        for i in 0..4 {
            for j in 0..=i {
                self.a[AT[i][j]] += n4[i] * n4[j] * weight;
            }
            self.b[i] += n4[i] * (weight * d);
        }
        self.c += weight * d * d;
    }

    /// The sum of both.
    pub fn plus(&self, o: &Self) -> Self {
        let mut sum = *self;
        sum.a.iter_mut().zip(&o.a).for_each(|(x, y)| *x += y);
        sum.b.iter_mut().zip(&o.b).for_each(|(x, y)| *x += y);
        sum.c += o.c;
        sum
    }

    /// Sum of the weights of its planes: the radius enters each with coefficient 1.
    pub fn weight(&self) -> f64 {
        self.a[AT[3][3]]
    }

    /// The error of a ball; rounding may not make it negative.
    pub fn error(&self, ball: &Ball) -> f64 {
        let m = coordinates(ball);
        let row = |i: usize| {
            let [x, y, z, w] = AT[i].map(|k| self.a[k]);
            x * m[0] + y * m[1] + z * m[2] + w * m[3]
        };
        let am = [row(0), row(1), row(2), row(3)];
        (dot(m, am) - 2.0 * dot(self.b, m) + self.c).max(0.0)
    }

    /// The ball of least error, near `start` where planes leave it free.
    pub fn minimiser(&self, start: &Ball) -> Option<Ball> {
        let diagonal = [0, 1, 2, 3].map(|i| self.a[AT[i][i]]);
        let pull = TIKHONOV * diagonal.iter().sum::<f64>();
        let mut a = self.a;
        let mut b = self.b;
        for (i, x) in coordinates(start).into_iter().enumerate() {
            a[AT[i][i]] += pull;
            b[i] += x * pull;
        }
        let [x, y, z, radius] = solve(a, b)?;
        Some(Ball {
            center: Point::new(x, y, z),
            radius,
        })
    }
}

/// Solves `A x = b` by Cholesky's factors, if `A` is positive definite.
fn solve(mut a: [f64; 10], mut b: Vector4) -> Option<Vector4> {
    for j in 0..4 {
        for k in 0..j {
            let factor = a[AT[j][k]];
            for i in j..4 {
                a[AT[i][j]] -= factor * a[AT[i][k]];
            }
        }
        let pivot = a[AT[j][j]];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let root = pivot.sqrt();
        a[AT[j][j]] = root;
        for i in j + 1..4 {
            a[AT[i][j]] /= root;
        }
    }
    for i in 0..4 {
        b[i] /= a[AT[i][i]];
        for k in i + 1..4 {
            b[k] -= b[i] * a[AT[k][i]];
        }
    }
    for i in (0..4).rev() {
        let known: f64 = (i + 1..4).map(|k| a[AT[k][i]] * b[k]).sum();
        b[i] = (b[i] - known) / a[AT[i][i]];
    }
    Some(b)
}

fn dot(x: Vector4, y: Vector4) -> f64 {
    (x[0] * y[0] + x[2] * y[2]) + (x[1] * y[1] + x[3] * y[3])
}

fn coordinates(ball: &Ball) -> Vector4 {
    let c = ball.center;
    [c.x, c.y, c.z, ball.radius]
}

/// Outward unit normals of the two planes that touch three balls, if there are any. Where the centres are nearly in a
/// line there are none: the slab is as thin as a cone, and its edges carry the error.
pub fn slab_normals(balls: [Ball; 3]) -> Option<[Point; 2]> {
    let [a, b, c] = balls.map(|ball| ball.center);
    let longest_sq = (b - a).length_sq().max((c - a).length_sq());
    tangent_normals_beyond(&balls, COLLINEAR_SIN_SQ * longest_sq.powi(2))
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
