//! Finds contacts that cannot close while a nearer one holds, so that they can be left out: a solver pays as much
//! for them as for those that bear a load.
//!
//! While the bodies move, each place moves against the other by some `δ(p) = δ(q) + ω × (p − q)`. Where
//! contact `k` has the normal `n_k` and the gap `g_k`, and holds, `δ(k) · n_k ≤ g_k`; with `|δ(k)| ≤ R` and
//! `θ` between the normals, contact `c` closes by at most
//!
//! `g_k cos θ + √(R² − g_k²) sin θ + |ω| |c − k|`,
//!
//! or by `R + |ω| |c − k|` where `g_k ≥ R cos θ`. In the narrowing gap between two tubes this leaves only the
//! nearest few contacts.

use super::SpherePair;
use crate::math::Real;
use crate::math::tolerance::REAL_ROUNDING;

/// How far two bodies may move against each other before their contacts are computed again.
#[derive(Clone, Copy, Debug)]
pub struct RelativeMotionBound {
    /// Upper bound of how far any place of one body moves against the other, a length.
    pub travel: Real,
    /// Upper bound of the angle by which one body turns against the other, in radians.
    pub angle: Real,
    /// Gap at which a contact begins to hold, a length: the sum of both contact skins.
    pub skins: Real,
}

impl RelativeMotionBound {
    /// Removes the contacts that cannot close because nearer ones hold, and sorts the others, the nearest first.
    pub fn drop_held_back(&self, contacts: &mut Vec<SpherePair>) {
        contacts.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut kept: Vec<SpherePair> = Vec::with_capacity(contacts.len());
        for c in contacts.drain(..) {
            if !kept.iter().any(|k| self.holds_back(k, &c)) {
                kept.push(c);
            }
        }
        *contacts = kept;
    }

    /// Whether `c` cannot close while `k` holds.
    fn holds_back(&self, k: &SpherePair, c: &SpherePair) -> bool {
        let [gap_k, gap_c] = [k, c].map(|c| (c.distance - self.skins).max(0.0));
        // Too far by more than rounding, before any root is taken.
        let turned = self.angle * self.angle * k.points[0].distance_squared(c.points[0]);
        if turned > gap_c * gap_c * (1.0 + REAL_ROUNDING) {
            return false;
        }
        let cosine = k.normal.dot(c.normal).clamp(-1.0, 1.0);
        let closed = if gap_k < self.travel * cosine {
            let across = (self.travel - gap_k) * (self.travel + gap_k);
            gap_k * cosine + (across * (1.0 - cosine * cosine)).sqrt()
        } else {
            self.travel
        };
        closed + self.angle * k.points[0].distance(c.points[0]) < gap_c
    }
}
