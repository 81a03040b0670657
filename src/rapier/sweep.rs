//! Which boxes meet: sweep and prune (Baraff 1992).

use crate::math::{Real, Vector};
use parry3d::bounding_volume::{Aabb, BoundingVolume};

/// All pairs of boxes that meet, the lower index first. The sweep goes along the axis on which their
/// centres spread most: heaps may be towers.
pub fn meeting(boxes: &[Aabb]) -> Vec<[usize; 2]> {
    let axis = widest(boxes);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    let least = |k: usize| boxes[k].mins[axis];
    order.sort_by(|&i, &j| least(i).total_cmp(&least(j)).then(i.cmp(&j)));
    let sorted: Vec<Aabb> = order.iter().map(|k| boxes[*k]).collect();
    let mut pairs = Vec::new();
    for (n, a) in sorted.iter().enumerate() {
        let behind = sorted.iter().zip(&order).skip(n + 1);
        for (b, &j) in behind.take_while(|(b, _)| b.mins[axis] <= a.maxs[axis]) {
            if a.intersects(b) {
                let i = order[n];
                pairs.push([i.min(j), i.max(j)]);
            }
        }
    }
    pairs
}

/// The axis on which centres spread most, by their mean square.
fn widest(boxes: &[Aabb]) -> usize {
    let count = boxes.len().max(1) as Real;
    let mean = boxes.iter().map(Aabb::center).sum::<Vector>() / count;
    let square = |b: &Aabb| {
        let apart = b.center() - mean;
        apart * apart
    };
    let spread: Vector = boxes.iter().map(square).sum();
    (0..3)
        .max_by(|&i, &j| spread[i].total_cmp(&spread[j]))
        .unwrap_or(0)
}
