//! Four boxes side by side, in single precision: what a tree's inner nodes are pruned by.
//!
//! A bound computed here may be off by rounding; [`slack`] says by how much at most. Whoever prunes
//! by it adds that to the limit, so that results are those of double precision, bit by bit.

use crate::math::sphere::Ball;
use crate::meshing::geometry::bounds::{Bounds, Point, coordinate};
use std::ops::ControlFlow;
use wide::f32x4;

/// Contents of one of a node's boxes.
#[derive(Clone, Copy)]
pub enum Child {
    /// Nothing: the box is not used.
    Nothing,
    /// A single thing, by index.
    Leaf(u32),
    /// A node, by index.
    Group(u32),
}

/// Calls `see` for leaves whose distance may be below `limit`, nearer groups first, from node 0 on;
/// `see` may return a new limit, or end the search. `look` gives the lower bounds of a node's children,
/// which may be off by `slack`.
#[inline]
pub fn nearest_first(
    limit: f64,
    slack: f64,
    look: impl Fn(u32) -> ([f32; 4], [Child; 4]),
    mut see: impl FnMut(u32) -> ControlFlow<(), Option<f64>>,
) {
    let mut limit = (limit + slack) as f32;
    // Quartering keeps the depth below 17, and each level leaves three waiting.
    let mut stack = [(f32::NEG_INFINITY, Child::Group(0)); 64];
    let mut len = 1;
    while len > 0 {
        len -= 1;
        let (bound, child) = stack[len];
        if bound >= limit {
            continue;
        }
        match child {
            Child::Nothing => {}
            Child::Leaf(leaf) => match see(leaf) {
                ControlFlow::Continue(Some(new)) => limit = (new + slack) as f32,
                ControlFlow::Continue(None) => {}
                ControlFlow::Break(()) => return,
            },
            Child::Group(index) => {
                let (bounds, children) = look(index);
                let first = len;
                for (bound, child) in bounds.into_iter().zip(children) {
                    if bound >= limit {
                        continue;
                    }
                    // The nearest on top.
                    let mut at = len;
                    while at > first && stack[at - 1].0 < bound {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (bound, child);
                    len += 1;
                }
            }
        }
    }
}

/// Corners of four boxes, coordinate by coordinate.
#[derive(Clone, Copy)]
pub struct FourBoxes {
    lo: [f32x4; 3],
    hi: [f32x4; 3],
}

/// Four balls.
#[derive(Clone, Copy)]
pub struct FourBalls {
    centers: FourPoints,
    radii: f32x4,
}

impl FourBalls {
    /// Four balls; where there is none, it reaches infinitely far.
    pub fn new(balls: [Option<Ball>; 4]) -> Self {
        let center = |axis: usize| {
            f32x4::from(balls.map(|b| b.map_or(0.0, |b| coordinate(b.center, axis) as f32)))
        };
        Self {
            centers: FourPoints([0, 1, 2].map(center)),
            radii: f32x4::from(balls.map(|b| b.map_or(f32::INFINITY, |b| b.radius as f32))),
        }
    }

    /// How far each reaches along a direction, from the origin.
    #[inline]
    pub fn reach(&self, way: &FourPoints) -> f32x4 {
        self.centers.dot(way) + self.radii
    }
}

/// Four points.
#[derive(Clone, Copy)]
pub struct FourPoints([f32x4; 3]);

impl FourPoints {
    /// The same point four times.
    #[inline]
    pub fn splat(p: Point) -> Self {
        Self([p.x, p.y, p.z].map(|x| f32x4::splat(x as f32)))
    }

    /// The four dot products.
    #[inline]
    pub fn dot(&self, other: &Self) -> f32x4 {
        let ([x, y, z], [u, v, w]) = (self.0, other.0);
        x * u + y * v + z * w
    }
}

/// Largest error of a distance between `p` and boxes whose coordinates are at most `reach`.
///
/// Rounding a coordinate, of the box or of the point, and their difference: 1.5 ε each of `reach`
/// and of `|p|`; √3 of that for the length, and four operations more of half an ε each on a length of
/// at most √3 their sum. Heights along a unit vector round eight times, each by half an ε of at most √3 their
/// sum. Radii and limits that are taken off or compared with are no larger.
#[inline]
pub fn slack(p: Point, reach: f64) -> f64 {
    /// The sum of these errors, rounded up, over the sum of both lengths (no unit).
    const ULPS: f64 = 16.0 * f32::EPSILON as f64;
    ULPS * (reach + p.x.abs().max(p.y.abs()).max(p.z.abs()))
}

impl FourBoxes {
    /// Four boxes; where there is none, any distance is infinite.
    pub fn new(boxes: [Option<Bounds>; 4]) -> Self {
        let lane = |axis: usize, low: bool| {
            f32x4::from(boxes.map(|b| match (b, low) {
                (Some(b), true) => coordinate(b.lo, axis) as f32,
                (Some(b), false) => coordinate(b.hi, axis) as f32,
                (None, true) => f32::INFINITY,
                (None, false) => f32::NEG_INFINITY,
            }))
        };
        Self {
            lo: [0, 1, 2].map(|axis| lane(axis, true)),
            hi: [0, 1, 2].map(|axis| lane(axis, false)),
        }
    }

    /// How far the point is beyond the nearer side, axis by axis; negative between the sides.
    #[inline]
    fn beyond(&self, p: &FourPoints) -> [f32x4; 3] {
        [0, 1, 2].map(|k| (self.lo[k] - p.0[k]).fast_max(p.0[k] - self.hi[k]))
    }

    /// Squared distances; 0 inside.
    #[inline]
    pub fn distance_sq(&self, p: &FourPoints) -> f32x4 {
        squared(self.beyond(p))
    }

    /// Distances, or minus the depth below the nearest side when inside.
    #[inline]
    pub fn signed_distance(&self, p: &FourPoints) -> f32x4 {
        let beyond = self.beyond(p);
        let deepest = beyond[0].fast_max(beyond[1]).fast_max(beyond[2]);
        squared(beyond).sqrt() + deepest.fast_min(f32x4::ZERO)
    }
}

#[inline]
fn squared(beyond: [f32x4; 3]) -> f32x4 {
    let [x, y, z] = beyond.map(|b| b.fast_max(f32x4::ZERO));
    x * x + y * y + z * z
}
