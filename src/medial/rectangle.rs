//! Rectangles swept by a sphere, round the primitives below the nodes of a medial mesh's tree. They fit chains of
//! cones and sheets of slabs, which balls do not. Source: Larsen, Gottschalk, Lin and Manocha, "Fast proximity queries
//! with swept sphere volumes" (1999).
//!
//! The plane of a rectangle is that of the two larger principal axes of the spheres' centres, its sides the best of
//! `SIDE_DIRECTIONS` directions in that plane. Sides are shortened as far as the swept sphere's roundings still hold
//! everything. Only square roots enter, so that rectangles are the same bits on every machine.

use super::simplex::Simplex;
use super::sphere::MedialSphere;
use super::tree::{NodeKind, SphereTree};
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::sphere::Ball;

/// A rectangle swept by a sphere.
#[derive(Clone, Copy, Debug, Default)]
pub struct SweptRectangle {
    /// Spheres of one radius at the corners, whose hull it is: a first one, its two neighbours, the opposite one.
    pub corners: [MedialSphere; 4],
}

/// One of each inner node of a tree.
#[derive(Clone, Debug, Default)]
pub struct SweptRectangles(Vec<SweptRectangle>);

impl SweptRectangles {
    /// The rectangles of the nodes of a mesh's tree.
    pub fn new(spheres: &[MedialSphere], primitives: &[Simplex], tree: &SphereTree) -> Self {
        let inner = tree.nodes().len() / 2;
        let mut all = Self(vec![SweptRectangle::default(); inner]);
        all.fit(0, spheres, primitives, tree);
        all
    }

    /// The rectangle of the node whose first child is `first`: children come in pairs, behind the root.
    pub fn of(&self, first: u32) -> &SweptRectangle {
        &self.0[(first as usize - 1) / 2]
    }

    /// Fits the rectangles of a node and of all nodes below it; returns the spheres below the node, each once.
    fn fit(
        &mut self,
        node: u32,
        spheres: &[MedialSphere],
        primitives: &[Simplex],
        tree: &SphereTree,
    ) -> Vec<u32> {
        match tree.nodes()[node as usize].kind() {
            NodeKind::Primitive(primitive) => {
                let simplex = &primitives[primitive as usize];
                let mut members = simplex.vertices[..simplex.len as usize].to_vec();
                members.sort_unstable();
                members
            }
            NodeKind::Nodes(first, second) => {
                let mut members = self.fit(first, spheres, primitives, tree);
                members.extend(self.fit(second, spheres, primitives, tree));
                members.sort_unstable();
                members.dedup();
                let local = |v: &u32| {
                    let s = &spheres[*v as usize];
                    Ball::new(Vec3::from_vector(s.center), s.radius.into())
                };
                let balls: Vec<_> = members.iter().map(local).collect();
                self.0[(first as usize - 1) / 2] = fitted(&balls);
                members
            }
        }
    }
}

/// Cosines and sines of the directions tried for a rectangle's sides: multiples of 11.25°.
const SIDE_DIRECTIONS: [(f64, f64); 8] = [
    (1.0, 0.0),
    (0.980_785_280_403_230_4, 0.195_090_322_016_128_27),
    (0.923_879_532_511_286_7, 0.382_683_432_365_089_8),
    (0.831_469_612_302_545_2, 0.555_570_233_019_602_2),
    (
        std::f64::consts::FRAC_1_SQRT_2,
        std::f64::consts::FRAC_1_SQRT_2,
    ),
    (0.555_570_233_019_602_2, 0.831_469_612_302_545_2),
    (0.382_683_432_365_089_8, 0.923_879_532_511_286_7),
    (0.195_090_322_016_128_27, 0.980_785_280_403_230_4),
];

/// The swept rectangle of some balls.
fn fitted(balls: &[Ball]) -> SweptRectangle {
    let middle =
        balls.iter().fold(Vec3::zero(), |sum, b| sum + b.center) * (1.0 / balls.len() as f64);
    let [x, y, normal] = principal_axes(balls, middle);
    let sized = |sides: [Vec3<f64>; 2]| {
        let rectangle = around(balls, middle, sides, normal);
        let [u, v] = rectangle.1.map(|[lo, hi]| hi - lo + 2.0 * rectangle.2);
        (u * v, sides, rectangle)
    };
    let best = SIDE_DIRECTIONS
        .map(|(cos, sin)| sized([x * cos + y * sin, y * cos - x * sin]))
        .into_iter()
        .min_by(|a, b| a.0.total_cmp(&b.0));
    // There are turns.
    let Some((_, [u, v], (height, [[u0, u1], [v0, v1]], radius))) = best else {
        return SweptRectangle::default();
    };
    let place = |a: f64, b: f64| (middle + normal * height + u * a + v * b).to_vector();
    let corners = [place(u0, v0), place(u1, v0), place(u0, v1), place(u1, v1)];
    // Corners are rounded by half an ulp of single precision, axes by some of double precision.
    let size = corners.iter().map(|c| c.abs().max_element());
    let size = size.fold(radius as Real, Real::max);
    let radius = (radius as Real).next_up() + 8.0 * Real::EPSILON * size;
    SweptRectangle {
        corners: corners.map(|corner| MedialSphere::new(corner, radius)),
    }
}

/// Height over the plane through `middle`, ranges along both sides, and radius, of a rectangle that holds the balls.
fn around(
    balls: &[Ball],
    middle: Vec3<f64>,
    [u, v]: [Vec3<f64>; 2],
    normal: Vec3<f64>,
) -> (f64, [[f64; 2]; 2], f64) {
    let local = |b: &Ball| {
        let y = b.center - middle;
        ([y.dot(u), y.dot(v), y.dot(normal)], b.radius)
    };
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    for ([.., z], r) in balls.iter().map(local) {
        (low, high) = (low.min(z - r), high.max(z + r));
    }
    let (height, radius) = (0.5 * (low + high), 0.5 * (high - low));
    // How far a sphere of this radius may be from a ball's centre within the plane, and still hold it.
    let play = |z: f64, r: f64| {
        let room = (radius - r).max(0.0);
        (room * room - (z - height) * (z - height)).max(0.0)
    };
    let range = |lows: f64, highs: f64| match lows <= highs {
        true => [lows, highs],
        false => [0.5 * (lows + highs); 2],
    };
    let mut along = [[0.0; 2]; 2];
    for side in 0..2 {
        let (mut lo, mut hi) = (f64::MAX, f64::MIN);
        for (at, r) in balls.iter().map(local) {
            let off = if side == 0 {
                0.0
            } else {
                beyond(at[0], along[0])
            };
            let play = (play(at[2], r) - off * off).max(0.0).sqrt();
            (lo, hi) = (lo.min(at[side] + play), hi.max(at[side] - play));
        }
        along[side] = range(lo, hi);
    }
    // The measure that decides: how far the balls reach from this rectangle.
    let reach = balls.iter().map(local).map(|(at, r)| {
        let [x, y] = [0, 1].map(|k| beyond(at[k], along[k]));
        let z = at[2] - height;
        (x * x + y * y + z * z).sqrt() + r
    });
    (height, along, reach.fold(0.0, f64::max))
}

/// How far a number is outside a range.
fn beyond(x: f64, [lo, hi]: [f64; 2]) -> f64 {
    (lo - x).max(x - hi).max(0.0)
}

/// Sweeps of Jacobi's method: fewer leave an axis off by more than a rectangle notices.
const SWEEPS: usize = 6;

/// Unit eigenvectors of the covariance of the balls' centres, of the largest eigenvalue first (Jacobi's method).
fn principal_axes(balls: &[Ball], middle: Vec3<f64>) -> [Vec3<f64>; 3] {
    let mut m = [[0.0; 3]; 3];
    for ball in balls {
        let y = ball.center - middle;
        let y = [y.x, y.y, y.z];
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += y[i] * y[j];
            }
        }
    }
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
            if m[p][q] == 0.0 {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (t * t + 1.0).sqrt();
            let sin = t * cos;
            if !(t.is_finite() && sin.is_finite()) {
                continue;
            }
            for row in &mut m {
                (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
            }
            let turn = |rows: &mut [[f64; 3]; 3]| {
                let (a, b) = (rows[p], rows[q]);
                rows[p] = [0, 1, 2].map(|k| cos * a[k] - sin * b[k]);
                rows[q] = [0, 1, 2].map(|k| sin * a[k] + cos * b[k]);
            };
            turn(&mut m);
            turn(&mut axes);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| m[b][b].total_cmp(&m[a][a]));
    order.map(|k| Vec3::new(axes[k][0], axes[k][1], axes[k][2]))
}
