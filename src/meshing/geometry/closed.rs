//! Whether triangles close a surface.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::watch::Watch;
use std::cmp::Ordering;

/// Whether triangles close a surface, each as often as it counts: whether each edge is passed as often one way as the
/// other. The sum of numbers that edges have by their places, positive one way and negative the other, tells: of a
/// surface with a border it is 0 only by chance, in about one of 2⁶⁴ cases.
pub(super) fn closes(
    triangles: &[[Point; 3]],
    counts: &[i8],
    watch: &mut Watch,
) -> Result<bool, BuildError> {
    let mut sum = 0u64;
    for (i, (corners, &count)) in triangles.iter().zip(counts).enumerate() {
        watch.every(i)?;
        let [a, b, c] = corners.map(number);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let edge = mixed(from.min(to) ^ mixed(from.max(to)));
            let times = match from.cmp(&to) {
                Ordering::Less => count,
                // One without length has no way.
                Ordering::Equal => 0,
                Ordering::Greater => -count,
            };
            sum = sum.wrapping_add(edge.wrapping_mul(i64::from(times) as u64));
        }
    }
    Ok(sum == 0)
}

/// A number for a place.
fn number(p: Point) -> u64 {
    // The same bits for 0 and −0.
    let bits = |x: f64| (x + 0.0).to_bits();
    mixed(bits(p.x) ^ mixed(bits(p.y) ^ mixed(bits(p.z))))
}

/// Spreads the bits of a number (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
fn mixed(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
