//! Which way the triangles of a surface face, and whether it is closed.
//!
//! Two triangles that share an edge agree when they use it in opposite directions. A surface whose
//! triangles agree keeps its orientation, for a shell turned inward is how a cavity is written;
//! otherwise each shell is made to agree by flooding across its edges and turned outward. A closed
//! shell faces inward when its signed volume is negative (divergence theorem: the sum of
//! `a · (b × c) / 6`).

use super::bounds::Point;
use super::triangle_tree::solid_angle_of;

/// What [`orient`] found.
pub struct Orientation {
    /// Edges of one triangle.
    pub open_edges: usize,
    /// Edges of more than two triangles.
    pub crowded_edges: usize,
    /// Edges, of two triangles or more, that stay used more often in one direction.
    pub unbalanced_edges: usize,
    /// Triangles turned round.
    pub turned: usize,
    /// Signed volume after turning.
    pub volume: f64,
}

impl Orientation {
    /// What a user should know about it.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let mut say = |count: usize, what: &str| {
            if count > 0 {
                notes.push(format!("{count} {what}"));
            }
        };
        say(self.open_edges, "open edges (edges of one triangle)");
        say(
            self.crowded_edges,
            "non-manifold edges (edges of more than two triangles)",
        );
        say(
            self.unbalanced_edges,
            "edges whose triangles cannot be made to face the same way",
        );
        say(self.turned, "triangles turned to face outward");
        notes
    }
}

/// One use of an edge by a triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Use {
    lo: u32,
    hi: u32,
    triangle: u32,
    forward: bool,
}

/// A neighbour across an edge, and whether both use the edge in the same direction.
type Neighbor = (u32, bool);

/// Turns triangles so that neighbours agree and closed shells face outward.
pub fn orient(vertices: &[Point], triangles: &mut [[u32; 3]]) -> Orientation {
    let uses = sorted_uses(triangles);
    let neighbors = neighbors(triangles.len(), &uses);
    let agree = neighbors.iter().flatten().all(|n| !n.1);
    let (shell, shells, turn) = flood(&neighbors, !agree);
    let mut turned = 0;
    let mut flip = |t: &mut [u32; 3]| {
        t.swap(1, 2);
        turned += 1;
    };
    for (t, &turn) in triangles.iter_mut().zip(&turn) {
        if turn {
            flip(t);
        }
    }
    let mut volumes = vec![0.0; shells];
    for (t, &s) in triangles.iter().zip(&shell) {
        volumes[s as usize] += signed_volume(vertices, t);
    }
    if agree && volumes.iter().sum::<f64>() < 0.0 {
        triangles.iter_mut().for_each(&mut flip);
        volumes.iter_mut().for_each(|v| *v = -*v);
    }
    let inward: Vec<bool> = if agree {
        inverted_shells(vertices, triangles, &shell, &volumes)
    } else {
        volumes.iter().map(|&v| v < 0.0).collect()
    };
    for (t, &s) in triangles.iter_mut().zip(&shell) {
        if inward[s as usize] {
            flip(t);
        }
    }
    let uses = sorted_uses(triangles);
    let edges = || uses.chunk_by(|a, b| (a.lo, a.hi) == (b.lo, b.hi));
    let unbalanced =
        |e: &[Use]| e.len() > 1 && 2 * e.iter().filter(|u| u.forward).count() != e.len();
    Orientation {
        open_edges: edges().filter(|e| e.len() == 1).count(),
        crowded_edges: edges().filter(|e| e.len() > 2).count(),
        unbalanced_edges: edges().filter(|e| unbalanced(e)).count(),
        turned,
        volume: triangles.iter().map(|t| signed_volume(vertices, t)).sum(),
    }
}

fn sorted_uses(triangles: &[[u32; 3]]) -> Vec<Use> {
    let mut uses: Vec<Use> = triangles
        .iter()
        .enumerate()
        .flat_map(|(i, &[a, b, c])| {
            [(a, b), (b, c), (c, a)].map(|(u, v)| Use {
                lo: u.min(v),
                hi: u.max(v),
                triangle: i as u32,
                forward: u < v,
            })
        })
        .collect();
    uses.sort_unstable();
    uses
}

/// Neighbours across edges of exactly two triangles: a crowded edge does not say who belongs
/// together.
fn neighbors(triangles: usize, uses: &[Use]) -> Vec<Vec<Neighbor>> {
    let mut neighbors = vec![Vec::new(); triangles];
    for edge in uses.chunk_by(|a, b| (a.lo, a.hi) == (b.lo, b.hi)) {
        if let [u, v] = edge {
            let same = u.forward == v.forward;
            neighbors[u.triangle as usize].push((v.triangle, same));
            neighbors[v.triangle as usize].push((u.triangle, same));
        }
    }
    neighbors
}

/// Shell of each triangle, number of shells, and (when asked) which triangles to turn so that
/// they agree with the first of their shell.
fn flood(neighbors: &[Vec<Neighbor>], turning: bool) -> (Vec<u32>, usize, Vec<bool>) {
    let mut shell = vec![u32::MAX; neighbors.len()];
    let mut turn = vec![false; neighbors.len()];
    let mut shells = 0;
    let mut waiting = Vec::new();
    for first in 0..neighbors.len() {
        if shell[first] != u32::MAX {
            continue;
        }
        shell[first] = shells;
        waiting.push(first);
        while let Some(t) = waiting.pop() {
            for &(other, same) in &neighbors[t] {
                let other = other as usize;
                if shell[other] == u32::MAX {
                    shell[other] = shells;
                    turn[other] = turning && (turn[t] != same);
                    waiting.push(other);
                }
            }
        }
        shells += 1;
    }
    (shell, shells as usize, turn)
}

/// Shells of negative volume that no other shell encloses: not cavities but shells inside out.
fn inverted_shells(
    vertices: &[Point],
    triangles: &[[u32; 3]],
    shell: &[u32],
    volumes: &[f64],
) -> Vec<bool> {
    let mut inverted = vec![false; volumes.len()];
    for (index, &volume) in volumes.iter().enumerate() {
        if volume >= 0.0 {
            continue;
        }
        let Some(own) = shell.iter().position(|&s| s as usize == index) else {
            continue;
        };
        let p = vertices[triangles[own][0] as usize];
        let winding: f64 = triangles
            .iter()
            .zip(shell)
            .filter(|&(_, &s)| s as usize != index)
            .map(|(t, _)| solid_angle_of(p, &t.map(|v| vertices[v as usize])))
            .sum::<f64>()
            / (4.0 * std::f64::consts::PI);
        inverted[index] = winding < 0.5;
    }
    inverted
}

fn signed_volume(vertices: &[Point], t: &[u32; 3]) -> f64 {
    let [a, b, c] = t.map(|v| vertices[v as usize]);
    a.dot(b.cross(c)) / 6.0
}
