//! The order in which points enter a Delaunay triangulation.
//!
//! Biased randomised rounds (Amenta, Choi and Rote, "Incremental constructions con BRIO", 2003):
//! each round takes half of the points left, at random, so that the expected size stays linear
//! whatever the input; within a round they follow a Hilbert curve (Skilling, "Programming the
//! Hilbert curve", 2004), so that each lands near the one before.

use crate::meshing::geometry::bounds::{Bounds, Point, coordinate};
use crate::meshing::geometry::random::Random;

/// Bits per axis of a place on the curve; three axes fit 48 bits.
const BITS: u32 = 16;

/// The last round, which is the first inserted, has at most this many points.
const SMALLEST_ROUND: usize = 1000;

/// Indices of the points, in order of insertion.
pub fn insertion_order(points: &[Point], bounds: &Bounds) -> Vec<u32> {
    let side = bounds.longest_side();
    let cells = f64::from((1u32 << BITS) - 1);
    let place: Vec<u64> = points
        .iter()
        .map(|&p| {
            let q = p - bounds.lo;
            hilbert([0, 1, 2].map(|k| (coordinate(q, k) / side * cells) as u32))
        })
        .collect();
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    Random::new(2).shuffle(&mut order);
    let mut end = order.len();
    while end > SMALLEST_ROUND {
        let start = end / 2;
        order[start..end].sort_unstable_by_key(|&i| (place[i as usize], i));
        end = start;
    }
    order[..end].sort_unstable_by_key(|&i| (place[i as usize], i));
    order
}

/// Place of a cell along the Hilbert curve (Skilling's transposed form, then interleaved).
fn hilbert([mut x, mut y, mut z]: [u32; 3]) -> u64 {
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        let low = bit - 1;
        if x & bit != 0 {
            x ^= low;
        }
        for other in [&mut y, &mut z] {
            if *other & bit != 0 {
                x ^= low;
            } else {
                let swap = (x ^ *other) & low;
                x ^= swap;
                *other ^= swap;
            }
        }
        bit >>= 1;
    }
    y ^= x;
    z ^= y;
    let mut gray = 0;
    bit = 1 << (BITS - 1);
    while bit > 1 {
        if z & bit != 0 {
            gray ^= bit - 1;
        }
        bit >>= 1;
    }
    let axes = [x ^ gray, y ^ gray, z ^ gray];
    (0..BITS).rev().fold(0, |place, b| {
        axes.iter()
            .fold(place, |place, axis| place << 1 | u64::from(axis >> b & 1))
    })
}
