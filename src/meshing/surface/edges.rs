//! The edges of a triangle mesh, and the shells that its triangles form across them.
//!
//! Shells are found by union and find (Tarjan 1975), each triangle with the parity of its
//! orientation relative to its shell's root, so that a contradiction (a Möbius strip) shows where
//! it closes.

use crate::error::BuildError;
use crate::meshing::watch::{Watch, bytes_of};

/// One use of an edge by a triangle. The edge's lower vertex is that of its group.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Use {
    /// The edge's higher vertex.
    hi: u32,
    /// The triangle, twice, plus 1 where it runs from the lower vertex to the higher.
    packed: u32,
}

impl Use {
    /// Index of the triangle.
    pub fn triangle(&self) -> usize {
        (self.packed >> 1) as usize
    }

    /// Whether the triangle runs from the lower vertex to the higher.
    pub fn forward(&self) -> bool {
        self.packed & 1 == 1
    }
}

/// All edges of a mesh, grouped by their lower vertex. Sorting them at once would be slower, and report no progress.
pub struct Edges {
    /// Place where the uses of each lower vertex begin; one more for the end.
    start: Vec<u32>,
    uses: Vec<Use>,
}

impl Edges {
    /// The edges of triangles whose indices are below `vertices`.
    pub fn new(
        vertices: usize,
        triangles: &[[u32; 3]],
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
        let mut start = vec![0u32; vertices + 1];
        for (i, t) in triangles.iter().enumerate() {
            watch.every(i)?;
            for (u, v) in sides(t) {
                start[u.min(v) as usize + 1] += 1;
            }
        }
        let mut sum = 0;
        for s in &mut start {
            sum += *s;
            *s = sum;
        }
        let mut next = start.clone();
        let mut uses = vec![Use { hi: 0, packed: 0 }; 3 * triangles.len()];
        watch.hold(bytes_of(&uses) + 2 * bytes_of(&start) + size_of_val(triangles));
        for (i, t) in triangles.iter().enumerate() {
            watch.every(i)?;
            for (u, v) in sides(t) {
                let at = &mut next[u.min(v) as usize];
                uses[*at as usize] = Use {
                    hi: u.max(v),
                    packed: (i as u32) << 1 | u32::from(u < v),
                };
                *at += 1;
            }
        }
        for v in 0..vertices {
            watch.every(v)?;
            uses[start[v] as usize..start[v + 1] as usize].sort_unstable();
        }
        Ok(Self { start, uses })
    }

    /// All edges: lower and higher vertex, and uses, by triangle.
    pub fn iter(&self) -> impl Iterator<Item = ([u32; 2], &[Use])> {
        self.start.windows(2).zip(0u32..).flat_map(|(range, lo)| {
            let group = &self.uses[range[0] as usize..range[1] as usize];
            let edges = group.chunk_by(|a, b| a.hi == b.hi);
            edges.map(move |uses| ([lo, uses[0].hi], uses))
        })
    }
}

/// Triangles joined into shells.
#[derive(Clone)]
pub struct Shells {
    parent: Vec<u32>,
    /// Whether a triangle faces against its parent; never of a root.
    odd: Vec<bool>,
}

impl Shells {
    /// Shells of one triangle each.
    pub fn new(triangles: usize) -> Self {
        Self {
            parent: (0..triangles as u32).collect(),
            odd: vec![false; triangles],
        }
    }

    /// The root of a triangle's shell, and whether the triangle faces against it.
    pub fn find(&mut self, triangle: usize) -> (usize, bool) {
        let (mut at, mut odd) = (triangle, false);
        while self.parent[at] as usize != at {
            let up = self.parent[at] as usize;
            // Halving: each step hangs a triangle under its grandparent.
            self.odd[at] ^= self.odd[up];
            self.parent[at] = self.parent[up];
            odd ^= self.odd[at];
            at = self.parent[at] as usize;
        }
        (at, odd)
    }

    /// Joins the triangles of an edge of two; false if they cannot face the same way.
    pub fn join(&mut self, a: &Use, b: &Use) -> bool {
        let against = a.forward() == b.forward();
        self.join_triangles([a.triangle(), b.triangle()], against)
    }

    /// Joins two triangles, which face `against` each other or the same way; false if that contradicts what is known.
    pub fn join_triangles(&mut self, [a, b]: [usize; 2], against: bool) -> bool {
        let ((root_a, odd_a), (root_b, odd_b)) = (self.find(a), self.find(b));
        if root_a == root_b {
            return (odd_a ^ odd_b) == against;
        }
        // The lower index stays, so that the result does not depend on the order of the edges.
        let (root, child) = (root_a.min(root_b), root_a.max(root_b));
        self.parent[child] = root as u32;
        self.odd[child] = odd_a ^ odd_b ^ against;
        true
    }
}
