//! The roof over a convex polyhedron: the four-dimensional polytope `{(x, r): 0 ≤ r ≤ dᵢ − nᵢ·x}` of all balls
//! inside it.
//!
//! The largest ball about `x` has the least of those heights, so the two-dimensional faces of the roof, each on
//! the planes of two faces, are the sheets of the medial axis, its corners the spheres, and what is on the ground
//! `r = 0` is the polyhedron itself (Culver, Keyser and Manocha, "Exact computation of the medial axis of a
//! polyhedron", 2004, for bodies that need not be convex).
//!
//! # Method
//! A box is cut by one half space after the other, as polyhedra are in Lasserre, "An analytical expression and
//! an algorithm for the volume of a convex polyhedron" (1983), with the graph of corners and edges kept: a corner
//! lies on four sides, and leaves along the edge of each three of them. Offsets are moved by up to
//! [`PERTURBATION`], so that no five sides meet; of a corner at which they should, several are left, that far
//! apart. New corners are interpolated between old ones, so rounding never makes the graph wrong alone: only
//! signs do, and then some edge has one end, which is found out.

use crate::math::fast_hash::FastMap;
use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::convex::Plane;
use crate::meshing::geometry::random::Random;

/// Offsets are moved by up to this (longest side 1): far above rounding, far below what counts as exact.
const PERTURBATION: f64 = 1e-11;

/// Half the side of the box that is cut (longest side 1, centred).
const HALF_BOX: f64 = 4.0;

/// The ground, `r ≥ 0`, among sides.
pub const GROUND: u32 = 0;

/// The sides of faces follow the ground and the seven others of the box.
pub const FIRST: u32 = 8;

/// A corner of the roof: a ball that touches what its sides are of.
#[derive(Clone, Copy)]
pub struct RoofCorner {
    /// The four sides that it lies on, in ascending order.
    pub sides: [u32; 4],
    /// Corner at the other end of the edge that leaves each of these sides.
    pub next: [u32; 4],
    /// The ball.
    pub ball: Ball,
}

impl RoofCorner {
    /// Place of a side among the corner's.
    pub fn place(&self, side: u32) -> Option<usize> {
        self.sides.iter().position(|&s| s == side)
    }
}

/// The corners of the roof over the points below all planes, of which there are at most `most`; side
/// `FIRST + i` is that of plane `i`, whose offset is moved. `None` where planes do not bound a body, or rounding
/// spoilt the graph: other `seed`s may not.
pub fn roof(planes: &mut [Plane], most: usize, seed: u64) -> Option<Vec<RoofCorner>> {
    let mut random = Random::new(seed);
    let mut corners = whole();
    for (i, plane) in planes.iter_mut().enumerate() {
        plane.offset += PERTURBATION * (2.0 * random.unit() - 1.0);
        corners = cut(corners, FIRST + i as u32, |ball| {
            plane.depth(ball.center) - ball.radius
        })?;
        if corners.len() > most {
            return None;
        }
    }
    let is_far = |c: &RoofCorner| c.sides.iter().any(|&s| s != GROUND && s < FIRST);
    (!corners.iter().any(is_far)).then_some(corners)
}

/// The box.
fn whole() -> Vec<RoofCorner> {
    let corner = |i: u32| {
        let bit = |k: u32| i >> k & 1;
        let at = |k: u32| if bit(k) == 0 { -HALF_BOX } else { HALF_BOX };
        RoofCorner {
            sides: [0, 1, 2, 3].map(|k| 2 * k + bit(k)),
            next: [0, 1, 2, 3].map(|k| i ^ (1 << k)),
            ball: Ball {
                center: Point::new(at(1), at(2), at(3)),
                radius: if bit(0) == 0 { 0.0 } else { HALF_BOX },
            },
        }
    };
    (0..16).map(corner).collect()
}

/// The part of a polytope where `height`, which is linear, is not negative; `side` is larger than all of its.
fn cut(
    corners: Vec<RoofCorner>,
    side: u32,
    height: impl Fn(&Ball) -> f64,
) -> Option<Vec<RoofCorner>> {
    let heights: Vec<f64> = corners.iter().map(|c| height(&c.ball)).collect();
    let mut index = vec![u32::MAX; corners.len()];
    let mut kept = Vec::with_capacity(corners.len());
    for (i, corner) in corners.iter().enumerate() {
        if heights[i] >= 0.0 {
            index[i] = kept.len() as u32;
            kept.push(*corner);
        }
    }
    if kept.is_empty() {
        return None;
    }
    // First end of the new edge on each two sides that the cut crosses.
    let mut open: FastMap<[u32; 2], (u32, usize)> = FastMap::default();
    for i in 0..corners.len() {
        let own = index[i];
        if own == u32::MAX {
            continue;
        }
        let corner = &corners[i];
        for slot in 0..4 {
            let other = corner.next[slot] as usize;
            if index[other] != u32::MAX {
                kept[own as usize].next[slot] = index[other];
                continue;
            }
            let along = heights[i] / (heights[i] - heights[other]);
            let ends = [corner.ball, corners[other].ball, corners[other].ball];
            let mut rest = corner
                .sides
                .into_iter()
                .filter(|&s| s != corner.sides[slot]);
            let triple = [rest.next()?, rest.next()?, rest.next()?];
            let new = kept.len() as u32;
            kept[own as usize].next[slot] = new;
            kept.push(RoofCorner {
                sides: [triple[0], triple[1], triple[2], side],
                next: [u32::MAX, u32::MAX, u32::MAX, own],
                ball: Ball::interpolate(ends, [1.0 - along, along, 0.0]),
            });
            for (without, pair) in [[1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
                let pair = pair.map(|k: usize| triple[k]);
                match open.remove(&pair) {
                    Some((end, place)) => {
                        kept[end as usize].next[place] = new;
                        kept[new as usize].next[without] = end;
                    }
                    None => {
                        open.insert(pair, (new, without));
                    }
                }
            }
        }
    }
    open.is_empty().then_some(kept)
}
