//! The roof of a prism over a polygon with holes, as balls and slabs: exact, as the medial axis of a convex polyhedron
//! is, and with flat sheets at reflex edges too.
//!
//! # Derivation
//! Let `t(x)` be the roof over the polygon (`wavefront.rs`) and `h` half the prism's height. The ball of radius
//! `r = min(t(x), h − |z|)` about `(x, z)` lies in the prism, and is largest where two of its faces are equally near:
//! - between an edge of the polygon and a cap: over the edge's cell, where `t ≤ h`, at `|z| = h − t`;
//! - between two edges: over the ridges of the roof, for `|z| ≤ h − t`, as walls;
//! - between the caps: where `t` would be larger than `h`, at `z = 0`.
//!
//! Each is flat, and `r` linear on it. Valleys need no walls: their balls touch no face.

use crate::math::fast_hash::{FastMap, FastSet};
use crate::meshing::axis::wavefront::{PolygonRoof, polygon_roof};
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::polygon_triangles::{polygon_area, polygon_triangles};
use crate::meshing::geometry::union_find::Groups;

/// Seeds of roofs, should rounding spoil one.
const SEEDS: u64 = 4;

/// The cells and the top of a roof have the polygon's area but for this share.
const SAME_AREA: f64 = 1e-3;

/// The balls and slabs of the prism over `loops` (in the plane `z = 0`, matter on their left), from `z = −half` to
/// `half`. Nodes of the roof joined by ridges shorter than `same` are one. `None` where the polygon is not simple.
pub fn prism_axis(loops: &[Vec<Point>], half: f64, same: f64) -> Option<Draft> {
    (0..SEEDS).find_map(|seed| {
        let roof = polygon_roof(loops, half, seed)?;
        Lift::new(loops, half, roof, same).whole()
    })
}

/// Balls and slabs that only some edges of the polygon contribute: the sheets between these edges and the caps, and the
/// walls between two of them.
pub fn prism_axis_of(loops: &[Vec<Point>], half: f64, same: f64, is_of: &[bool]) -> Option<Draft> {
    let roof = polygon_roof(loops, half, 0)?;
    let mut lift = Lift::new(loops, half, roof, same);
    lift.cells(&|side| is_of[side])?;
    lift.walls(&|side| is_of[side]);
    Some(lift.draft)
}

struct Lift<'a> {
    loops: &'a [Vec<Point>],
    half: f64,
    roof: PolygonRoof,
    /// For each node of the roof, the node that stands for it.
    own: Vec<u32>,
    draft: Draft,
    /// The balls of a node: above and below, or the same in the middle.
    balls: FastMap<u32, [u32; 2]>,
    faces: FastSet<[u32; 3]>,
}

impl<'a> Lift<'a> {
    fn new(loops: &'a [Vec<Point>], half: f64, mut roof: PolygonRoof, same: f64) -> Self {
        let count = roof.nodes.len();
        let mut groups = Groups::new(count);
        // Corners of the polygon stay, and what is at the top stays there.
        let is_fixed = |p: &Point| p.z == 0.0 || p.z >= half;
        let mut held: Vec<u32> = (0..count as u32).collect();
        for edge in &roof.edges {
            let [a, b] = edge.ends;
            let way = (roof.nodes[a as usize] - roof.nodes[b as usize]).length();
            let [a, b] = [a, b].map(|v| groups.find(v));
            let [p, q] = [a, b].map(|v| held[v as usize]);
            let [at_p, at_q] = [p, q].map(|v| roof.nodes[v as usize]);
            let both_fixed = is_fixed(&at_p) && is_fixed(&at_q) && (at_p.z == 0.0 || at_q.z == 0.0);
            if a == b || way > same || (at_p - at_q).length() > 2.0 * same || both_fixed {
                continue;
            }
            groups.join(a, b);
            let root = groups.find(a);
            held[root as usize] = if is_fixed(&at_q) { q } else { p };
        }
        for around in &roof.top {
            for k in 0..around.len() {
                let [a, b] = [around[k].0, around[(k + 1) % around.len()].0];
                let [a, b] = [a, b].map(|v| groups.find(v));
                let [p, q] = [a, b].map(|v| roof.nodes[held[v as usize] as usize]);
                if a != b && (p - q).length() <= same {
                    let kept = held[a as usize];
                    groups.join(a, b);
                    held[groups.find(a) as usize] = kept;
                }
            }
        }
        let own: Vec<u32> = (0..count as u32)
            .map(|v| held[groups.find(v) as usize])
            .collect();
        for node in &mut roof.nodes {
            node.z = node.z.min(half);
        }
        Self {
            loops,
            half,
            roof,
            own,
            draft: Draft::default(),
            balls: FastMap::default(),
            faces: FastSet::default(),
        }
    }

    /// The medial mesh of the whole prism; `None` if its sheets do not add up to the area of the polygon.
    fn whole(mut self) -> Option<Draft> {
        let mut area = self.cells(&|_| true)?;
        area += self.top();
        self.walls(&|_| true);
        let wanted: f64 = self.loops.iter().map(|l| polygon_area(l)).sum();
        ((area - wanted).abs() <= SAME_AREA * wanted).then_some(self.draft)
    }

    fn at(&self, node: u32) -> Point {
        self.roof.nodes[node as usize]
    }

    /// Sheets between edges and the caps; their area, seen from above.
    fn cells(&mut self, is_of: &dyn Fn(usize) -> bool) -> Option<f64> {
        let sides: usize = self.loops.iter().map(Vec::len).sum();
        let mut bounds: Vec<Vec<[u32; 2]>> = vec![Vec::new(); sides];
        let mut first = 0;
        for points in self.loops {
            let n = points.len();
            for k in 0..n {
                bounds[first + k].push([first + k, first + (k + 1) % n].map(|v| v as u32));
            }
            first += n;
        }
        for edge in &self.roof.edges {
            for side in edge.sides {
                bounds[side].push(edge.ends);
            }
        }
        for around in &self.roof.top {
            for k in 0..around.len() {
                let (node, side) = around[k];
                bounds[side].push([node, around[(k + 1) % around.len()].0]);
            }
        }
        let mut area = 0.0;
        for (_, bound) in (0..).zip(bounds).filter(|(side, _)| is_of(*side)) {
            let bound = bound.iter().map(|ends| ends.map(|v| self.own[v as usize]));
            for around in chained(bound.filter(|[a, b]| a != b).collect())? {
                area += self.cell(around);
            }
        }
        Some(area)
    }

    /// The two sheets over a cell, and its area.
    fn cell(&mut self, mut around: Vec<u32>) -> f64 {
        let flat = |p: Point| Point::new(p.x, p.y, 0.0);
        let points: Vec<Point> = around.iter().map(|&v| flat(self.at(v))).collect();
        let area = polygon_area(&points);
        if area < 0.0 {
            around.reverse();
        }
        let triangles = polygon_triangles(vec![around], |v| flat(self.roof.nodes[v as usize]));
        for t in triangles {
            let balls = t.map(|v| self.balls_of(v));
            for side in [0, 1] {
                self.slab(balls.map(|b| b[side]));
            }
        }
        area.abs()
    }

    /// The sheet between the caps; its area.
    fn top(&mut self) -> f64 {
        let mut loops = Vec::new();
        for around in &self.roof.top {
            let mut nodes: Vec<u32> = around.iter().map(|n| self.own[n.0 as usize]).collect();
            nodes.dedup();
            while nodes.len() > 1 && nodes.first() == nodes.last() {
                nodes.pop();
            }
            if nodes.len() > 2 {
                loops.push(nodes);
            }
        }
        let flat = |v: u32| {
            let p = self.roof.nodes[v as usize];
            Point::new(p.x, p.y, 0.0)
        };
        let triangles = polygon_triangles(loops, flat);
        let mut area = 0.0;
        for t in triangles {
            area += polygon_area(&t.map(|v| {
                let p = self.at(v);
                Point::new(p.x, p.y, 0.0)
            }));
            let balls = t.map(|v| self.balls_of(v)[0]);
            self.slab(balls);
        }
        area
    }

    /// Walls over the ridges between edges.
    fn walls(&mut self, is_of: &dyn Fn(usize) -> bool) {
        let edges = std::mem::take(&mut self.roof.edges);
        for edge in edges.iter().filter(|e| !e.is_valley) {
            let [a, b] = edge.ends.map(|v| self.own[v as usize]);
            if a == b || !edge.sides.iter().all(|side| is_of(*side)) {
                continue;
            }
            let [[a_up, a_low], [b_up, b_low]] = [a, b].map(|v| self.balls_of(v));
            self.slab([a_up, a_low, b_up]);
            self.slab([b_up, b_low, a_low]);
            if a_up == a_low && b_up == b_low {
                self.draft.edges.push([a_up, b_up]);
            }
        }
    }

    /// The balls of a node.
    fn balls_of(&mut self, node: u32) -> [u32; 2] {
        let p = self.at(node);
        let (half, draft) = (self.half, &mut self.draft);
        *self.balls.entry(node).or_insert_with(|| {
            let mut ball = |z: f64| {
                draft.balls.push(Ball {
                    center: Point::new(p.x, p.y, z),
                    radius: p.z,
                });
                draft.balls.len() as u32 - 1
            };
            let up = ball(half - p.z);
            let low = if p.z < half { ball(p.z - half) } else { up };
            [up, low]
        })
    }

    /// Adds a slab of three different balls that is not there yet.
    fn slab(&mut self, balls: [u32; 3]) {
        let [a, b, c] = balls;
        let mut key = balls;
        key.sort_unstable();
        if a != b && b != c && c != a && self.faces.insert(key) {
            self.draft.faces.push(balls);
        }
    }
}

/// Segments as closed loops of nodes; `None` where they have ends.
fn chained(mut segments: Vec<[u32; 2]>) -> Option<Vec<Vec<u32>>> {
    let mut loops = Vec::new();
    while let Some([first, mut at]) = segments.pop() {
        let mut around = vec![first];
        while at != first {
            around.push(at);
            let next = segments.iter().position(|s| s.contains(&at))?;
            let [a, b] = segments.swap_remove(next);
            at = if a == at { b } else { a };
        }
        if around.len() > 2 {
            loops.push(around);
        }
    }
    Some(loops)
}
