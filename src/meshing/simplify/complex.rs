//! The medial mesh as a complex that edges can be collapsed in: who is joined to whom, and how many
//! primitives there are.
//!
//! Source of the link condition: Dey, Edelsbrunner, Guha and Nekhayev, "Topology preserving edge
//! contraction" (1999).

use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::Point;
use crate::meshing::watch::bytes_of;

/// Balls, edges and faces, with what lies around each ball.
#[derive(Clone)]
pub struct Complex {
    /// The balls; those merged into others stay, and are no longer alive.
    pub balls: Vec<Ball>,
    alive: Vec<bool>,
    /// Balls joined to each, in ascending order.
    neighbors: Vec<Vec<u32>>,
    /// Faces of each ball.
    faces_of: Vec<Vec<u32>>,
    faces: Vec<[u32; 3]>,
    primitives: usize,
    /// The last [`Self::cones`] that met each ball, and how many there were.
    seen: Vec<u32>,
    round: u32,
}

impl Complex {
    /// Takes a draft.
    pub fn new(draft: Draft) -> Self {
        let n = draft.balls.len();
        let of_faces = draft
            .faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let edges = draft.edges.iter().copied().chain(of_faces);
        let edges = edges.filter(|[a, b]| a != b);
        let mut neighbors = with_room(n, edges.clone().flatten());
        for [a, b] in edges {
            neighbors[a as usize].push(b);
            neighbors[b as usize].push(a);
        }
        for list in &mut neighbors {
            list.sort_unstable();
            list.dedup();
        }
        let mut faces_of = with_room(n, draft.faces.iter().copied().flatten());
        for (i, face) in draft.faces.iter().enumerate() {
            for &v in face {
                faces_of[v as usize].push(i as u32);
            }
        }
        let mut complex = Self {
            balls: draft.balls,
            alive: vec![true; n],
            neighbors,
            faces_of,
            primitives: draft.faces.len(),
            faces: draft.faces,
            seen: vec![0; n],
            round: 0,
        };
        let ends: usize = (0..n as u32).map(|v| complex.cones(v)).sum();
        let lone = (0..n as u32).filter(|&v| complex.is_lone(v)).count();
        complex.primitives += ends / 2 + lone;
        complex
    }

    /// Bytes of its arrays.
    pub fn bytes(&self) -> usize {
        let lists = |of: &Vec<Vec<u32>>| bytes_of(of) + of.iter().map(bytes_of).sum::<usize>();
        let around = lists(&self.neighbors) + lists(&self.faces_of);
        let of_each = bytes_of(&self.balls) + self.alive.len() + bytes_of(&self.seen);
        of_each + bytes_of(&self.faces) + around
    }

    /// Number of slabs, cones that belong to no slab, and lone balls.
    pub fn primitives(&self) -> usize {
        self.primitives
    }

    /// Whether the ball is still there.
    pub fn is_alive(&self, v: u32) -> bool {
        self.alive[v as usize]
    }

    /// Whether a ball is joined to no other.
    pub fn is_lone(&self, v: u32) -> bool {
        self.alive[v as usize] && self.neighbors[v as usize].is_empty()
    }

    /// Balls joined to a ball, in ascending order.
    pub fn neighbors(&self, v: u32) -> &[u32] {
        &self.neighbors[v as usize]
    }

    /// Whether an edge joins two balls.
    pub fn is_edge(&self, a: u32, b: u32) -> bool {
        self.neighbors[a as usize].binary_search(&b).is_ok()
    }

    /// Faces, each as its balls.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Faces at a ball.
    pub fn faces_at(&self, v: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        let faces = self.faces_of[v as usize].iter();
        faces.map(|&f| self.faces[f as usize])
    }

    /// Primitives at a ball.
    pub fn primitives_at(&self, v: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        let cone = move |&&u: &&u32| self.opposite(v, u).next().is_none();
        let cones = self.neighbors[v as usize].iter().filter(cone);
        let lone = self.is_lone(v).then_some([v; 3]);
        self.faces_at(v)
            .chain(cones.map(move |&u| [v, u, u]))
            .chain(lone)
    }

    /// The third balls of the faces at an edge.
    pub fn opposite(&self, a: u32, b: u32) -> impl Iterator<Item = u32> + '_ {
        self.faces_of[a as usize].iter().filter_map(move |&f| {
            let face = self.faces[f as usize];
            let third = |&v: &u32| v != a && v != b;
            face.contains(&b).then(|| face.into_iter().find(third))?
        })
    }

    /// Cones (edges without a face) at a ball.
    fn cones(&mut self, v: u32) -> usize {
        self.round += 1;
        for &f in &self.faces_of[v as usize] {
            for u in self.faces[f as usize] {
                self.seen[u as usize] = self.round;
            }
        }
        let cone = |&&u: &&u32| self.seen[u as usize] != self.round;
        self.neighbors[v as usize].iter().filter(cone).count()
    }

    /// Middles of what merging the ends of an edge closes (link condition): loops of three edges that
    /// no face fills, and shells of four faces. Where there is none, the complex keeps its topology.
    pub fn closed_by(&self, a: u32, b: u32) -> impl Iterator<Item = Point> + '_ {
        let filled: Vec<u32> = self.opposite(a, b).collect();
        let mut shells = Vec::new();
        for (j, &y) in filled.iter().enumerate() {
            for &x in &filled[..j] {
                let has = |v: u32| self.opposite(x, y).any(|w| w == v);
                if self.is_edge(x, y) && has(a) && has(b) {
                    shells.push([a, b, x, y]);
                }
            }
        }
        let common = common(&self.neighbors[a as usize], &self.neighbors[b as usize]);
        let open = common.filter(move |v| !filled.contains(v));
        let shells = shells.into_iter().map(|shell| self.middle(&shell));
        open.map(move |v| self.middle(&[a, b, v])).chain(shells)
    }

    fn middle(&self, vertices: &[u32]) -> Point {
        let sum = vertices
            .iter()
            .map(|&v| self.balls[v as usize].center)
            .fold(Point::zero(), |a, b| a + b);
        sum * (1.0 / vertices.len() as f64)
    }

    /// Merges ball `b` into `a`, which becomes `ball`.
    pub fn collapse(&mut self, a: u32, b: u32, ball: Ball) {
        // Only edges at `a` or `b` can gain or lose their last face: a face that becomes the
        // repeat of another leaves that other at its third edge.
        let shared = usize::from(self.opposite(a, b).next().is_none());
        self.primitives -= self.cones(a) + self.cones(b) - shared;
        self.balls[a as usize] = ball;
        self.alive[b as usize] = false;
        for f in std::mem::take(&mut self.faces_of[b as usize]) {
            let moved = self.faces[f as usize].map(|v| if v == b { a } else { v });
            let degenerate = self.faces[f as usize].contains(&a);
            if degenerate || self.is_face(a, moved) {
                self.drop_face(f);
            } else {
                self.faces[f as usize] = moved;
                self.faces_of[a as usize].push(f);
            }
        }
        for v in std::mem::take(&mut self.neighbors[b as usize]) {
            remove(&mut self.neighbors[v as usize], b);
            if v != a {
                insert(&mut self.neighbors[v as usize], a);
                insert(&mut self.neighbors[a as usize], v);
            }
        }
        self.primitives += self.cones(a) + usize::from(self.is_lone(a));
    }

    /// Drops a lone ball.
    pub fn remove_lone(&mut self, v: u32) {
        if self.is_lone(v) {
            self.alive[v as usize] = false;
            self.primitives -= 1;
        }
    }

    fn is_face(&self, a: u32, face: [u32; 3]) -> bool {
        let same = |&f: &u32| face.iter().all(|v| self.faces[f as usize].contains(v));
        self.faces_of[a as usize].iter().any(same)
    }

    fn drop_face(&mut self, f: u32) {
        self.primitives -= 1;
        for v in self.faces[f as usize] {
            self.faces_of[v as usize].retain(|&g| g != f);
        }
    }

    /// Draft of what is alive.
    pub fn draft(&self) -> Draft {
        let mut index = vec![u32::MAX; self.balls.len()];
        let mut draft = Draft::default();
        for (v, ball) in self.balls.iter().enumerate() {
            if self.alive[v] {
                index[v] = draft.balls.len() as u32;
                draft.balls.push(*ball);
            }
        }
        for v in 0..self.balls.len() as u32 {
            let later = self.neighbors(v).iter().filter(|&&u| u > v);
            draft
                .edges
                .extend(later.map(|&u| [index[v as usize], index[u as usize]]));
            // A face is listed at its first ball.
            let own = self.faces_of[v as usize]
                .iter()
                .map(|&f| self.faces[f as usize]);
            draft.faces.extend(
                own.filter(|f| f[0] == v)
                    .map(|f| f.map(|u| index[u as usize])),
            );
        }
        draft
    }
}

/// Empty lists, each with room for as often as its index is met.
fn with_room(lists: usize, met: impl Iterator<Item = u32>) -> Vec<Vec<u32>> {
    let mut counts = vec![0; lists];
    met.for_each(|v| counts[v as usize] += 1);
    counts.into_iter().map(Vec::with_capacity).collect()
}

/// Members of both of two ascending lists.
fn common<'a>(a: &'a [u32], b: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let mut rest = b.iter().copied().peekable();
    a.iter().copied().filter(move |&v| {
        while rest.next_if(|&u| u < v).is_some() {}
        rest.peek() == Some(&v)
    })
}

fn insert(sorted: &mut Vec<u32>, value: u32) {
    if let Err(at) = sorted.binary_search(&value) {
        sorted.insert(at, value);
    }
}

fn remove(sorted: &mut Vec<u32>, value: u32) {
    if let Ok(at) = sorted.binary_search(&value) {
        sorted.remove(at);
    }
}
