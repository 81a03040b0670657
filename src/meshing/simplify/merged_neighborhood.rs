//! The neighbourhood of an edge of a medial mesh as it would be after its two balls are merged into one, to judge
//! what the merge costs.

use crate::meshing::certify::prepared_primitives::Prepared;
use crate::meshing::draft::Corners;
use crate::meshing::simplify::collapse::Simplifier;

/// Neighbourhood of an edge once it is merged; its first ball stands for the new one.
pub struct Merged {
    /// The edge.
    pub edge: [u32; 2],
    /// Balls joined to either end.
    pub neighbors: Vec<u32>,
    /// Primitives of the new ball.
    pub primitives: Vec<Corners>,
}

impl Merged {
    /// The neighbourhood after the ends of an edge are merged.
    pub fn new(s: &Simplifier, [a, b]: [u32; 2]) -> Self {
        let complex = s.complex();
        let both = complex.neighbors(a).iter().chain(complex.neighbors(b));
        let mut neighbors: Vec<u32> = both.copied().filter(|&v| v != a && v != b).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        let of_a = complex.faces_at(a).filter(|f| !f.contains(&b));
        let of_b = complex.faces_at(b).filter(|f| !f.contains(&a));
        let moved = of_b.map(|f| f.map(|v| if v == b { a } else { v }));
        let mut primitives: Vec<Corners> = of_a.chain(moved).collect();
        let faces = primitives.len();
        for &v in &neighbors {
            if !primitives[..faces].iter().any(|f| f.contains(&v)) {
                primitives.push([a, v, v]);
            }
        }
        if neighbors.is_empty() {
            primitives.push([a; 3]);
        }
        Self {
            edge: [a, b],
            neighbors,
            primitives,
        }
    }

    /// Primitives at the neighbours that stay as they are.
    pub fn around(&self, s: &Simplifier) -> Vec<Prepared> {
        let kept = |c: &Corners| !self.edge.iter().any(|v| c.contains(v));
        let complex = s.complex();
        let at = |&v: &u32| complex.primitives_at(v).filter(kept);
        let balls = |c: Corners| c.map(|v| complex.balls[v as usize]);
        let all = self.neighbors.iter().flat_map(at);
        all.map(|c| Prepared::new(c, balls(c))).collect()
    }
}
