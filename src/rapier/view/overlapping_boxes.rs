//! Finds all pairs of overlapping boxes, by sweep and prune (Baraff 1992), eight boxes at a time.

use crate::math::{Real, Vector};
use parry3d::bounding_volume::Aabb;
use wide::f32x8;

/// All pairs of boxes that meet, the lower index first, eight at a time. The sweep goes along the axis on
/// which their centres spread most: heaps may be towers.
pub fn overlapping_pairs(boxes: &[Aabb]) -> Vec<[usize; 2]> {
    let axis = widest(boxes);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    let least = |k: usize| boxes[k].mins[axis];
    order.sort_by(|&i, &j| least(i).total_cmp(&least(j)).then(i.cmp(&j)));
    let eights = |of: fn(&Aabb) -> Vector, axis: usize| -> Vec<f32x8> {
        let eight = |some: &[usize]| {
            let mut all = [Real::NAN; 8];
            for (place, k) in all.iter_mut().zip(some) {
                *place = of(&boxes[*k])[axis];
            }
            f32x8::from(all)
        };
        order.chunks(8).map(eight).collect()
    };
    // NaN meets nothing.
    let sides = [0, 1, 2].map(|k| {
        let axis = (axis + k) % 3;
        (axis, eights(|b| b.mins, axis), eights(|b| b.maxs, axis))
    });
    let (_, mins, _) = &sides[0];
    let mut pairs = Vec::new();
    for (n, &i) in order.iter().enumerate() {
        let a = &boxes[i];
        let end = f32x8::splat(a.maxs[axis]);
        for e in (n + 1) / 8..mins.len() {
            let mut meet = mins[e].simd_le(end);
            if n < 8 * e && meet.to_bitmask() == 0 {
                break;
            }
            for (axis, mins, maxs) in &sides {
                meet = meet
                    & mins[e].simd_le(f32x8::splat(a.maxs[*axis]))
                    & maxs[e].simd_ge(f32x8::splat(a.mins[*axis]));
            }
            let mut meet = meet.to_bitmask();
            while meet != 0 {
                let m = 8 * e + meet.trailing_zeros() as usize;
                meet &= meet - 1;
                if m > n {
                    pairs.push([i.min(order[m]), i.max(order[m])]);
                }
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
