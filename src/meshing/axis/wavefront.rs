//! The roof over a polygon with holes: the edges of the polygon move inward at one speed, and the corners of the
//! shrinking outline trace its ridges and valleys, up to a height. Seen from above this is the straight skeleton
//! (Aichholzer, Aurenhammer, Alberts and Gärtner, "A novel type of skeleton for polygons", 1995).
//!
//! All is linear in the height: a ball about a point of the roof, of its height, touches the edge that the point's cell
//! is of, and lies in the polygon. At a reflex corner the roof is lower than the distance to the corner, and its edges
//! are straight, where those of the medial axis are parabolas.
//!
//! # Method
//! The next of all events is looked for again after each: an edge that vanishes, or a reflex corner that meets an edge
//! and splits the outline. Lines are turned and moved a little at random ([`PERTURBATION`]), so that no two events
//! coincide and no corner is between parallel edges.

use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::random::Random;

/// Lines are turned by up to this (rad) and moved by as much (longest side 1): far below what the roof is to be near
/// to.
const PERTURBATION: f64 = 1e-7;

/// An event this much before the last, and a corner this far beyond the end of an edge, are rounding.
const ROUNDING: f64 = 1e-9;

/// Events for each edge of the polygon, at most: a simple one has fewer than two.
const EVENTS: usize = 8;

/// A line that moves: `normal · x = offset + height`.
#[derive(Clone, Copy)]
struct Line {
    normal: Point,
    offset: f64,
}

/// A corner of the outline, between the edge before it and the one that begins at it.
#[derive(Clone, Copy)]
struct Corner {
    before: usize,
    after: usize,
    previous: usize,
    next: usize,
    /// The node of the roof where it began.
    from: u32,
    /// Place that the corner would have at height 0, and the way that it moves as the height grows by 1.
    start: Point,
    speed: Point,
    is_reflex: bool,
    is_alive: bool,
}

impl Corner {
    fn at(&self, height: f64) -> Point {
        self.start + self.speed * height
    }
}

/// A ridge or a valley of the roof.
pub struct RoofEdge {
    /// Nodes at the two ends.
    pub ends: [u32; 2],
    /// The edges of the polygon whose cells it bounds.
    pub sides: [usize; 2],
    /// Whether it is a valley, from a reflex corner.
    pub is_valley: bool,
}

/// A roof.
pub struct PolygonRoof {
    /// Points `(x, y, height)`. The first are the corners of the polygon, in order.
    pub nodes: Vec<Point>,
    /// Ridges and valleys.
    pub edges: Vec<RoofEdge>,
    /// The shrunken outline at the height at which the roof ends: loops of nodes, each with the edge of the polygon
    /// that follows it.
    pub top: Vec<Vec<(u32, usize)>>,
}

struct Wavefront {
    lines: Vec<Line>,
    corners: Vec<Corner>,
    roof: PolygonRoof,
    now: f64,
}

enum Event {
    Vanishes(usize),
    Splits(usize, usize),
}

/// The roof over a polygon up to `height`: loops around it, matter on their left. `None` where it is not simple, or
/// where rounding spoilt it: another `seed` may do.
pub fn polygon_roof(loops: &[Vec<Point>], height: f64, seed: u64) -> Option<PolygonRoof> {
    if crosses_itself(loops) {
        return None;
    }
    let mut front = Wavefront::new(loops, seed)?;
    let most = EVENTS * front.lines.len();
    for _ in 0..most {
        match front.next_event(height) {
            None => {
                front.end(height);
                return Some(front.roof);
            }
            Some((at, Event::Vanishes(v))) => front.vanish(v, at)?,
            Some((at, Event::Splits(v, w))) => front.split(v, w, at)?,
        }
    }
    None
}

impl Wavefront {
    fn new(loops: &[Vec<Point>], seed: u64) -> Option<Self> {
        let mut random = Random::new(seed);
        let mut front = Self {
            lines: Vec::new(),
            corners: Vec::new(),
            roof: PolygonRoof {
                nodes: Vec::new(),
                edges: Vec::new(),
                top: Vec::new(),
            },
            now: 0.0,
        };
        let mut links = Vec::new();
        for points in loops {
            let first = front.lines.len();
            let n = points.len();
            for (k, p) in points.iter().enumerate() {
                let along = points[(k + 1) % n] - *p;
                if along.length() < ROUNDING {
                    return None;
                }
                let mut off = || PERTURBATION * (2.0 * random.unit() - 1.0);
                let turned = along * (1.0 / along.length());
                let turned = turned + inward(turned) * off();
                let normal = inward(turned * (1.0 / turned.length()));
                front.lines.push(Line {
                    normal,
                    offset: normal.dot(*p + along * 0.5) + off(),
                });
                links.push((first + (k + n - 1) % n, first + (k + 1) % n));
                front.roof.nodes.push(*p);
            }
        }
        for (k, &(previous, next)) in links.iter().enumerate() {
            let corner = front.corner(previous, k, k as u32)?;
            front.corners.push(Corner {
                previous,
                next,
                ..corner
            });
        }
        Some(front)
    }

    /// A corner between two edges, that begins at a node.
    fn corner(&self, before: usize, after: usize, from: u32) -> Option<Corner> {
        let [a, b] = [self.lines[before], self.lines[after]];
        let turn = cross(a.normal, b.normal);
        if turn.abs() < 1e-3 * PERTURBATION {
            return None;
        }
        // The point on both lines whose offsets are `p` and `q`.
        let meet = |p: f64, q: f64| {
            let x = (p * b.normal.y - q * a.normal.y) / turn;
            let y = (q * a.normal.x - p * b.normal.x) / turn;
            Point::new(x, y, 0.0)
        };
        Some(Corner {
            before,
            after,
            previous: 0,
            next: 0,
            from,
            start: meet(a.offset, b.offset),
            speed: meet(1.0, 1.0),
            is_reflex: turn < 0.0,
            is_alive: true,
        })
    }

    /// Height at which a moving corner reaches a moving line.
    fn meets(&self, corner: &Corner, line: usize) -> f64 {
        let line = self.lines[line];
        (line.offset - line.normal.dot(corner.start)) / (line.normal.dot(corner.speed) - 1.0)
    }

    /// The first event up to `most`, and its height.
    fn next_event(&self, most: f64) -> Option<(f64, Event)> {
        let mut first: Option<(f64, Event)> = None;
        let mut limit = most;
        let alive = |v: &usize| self.corners[*v].is_alive;
        for v in (0..self.corners.len()).filter(alive) {
            let corner = &self.corners[v];
            let next = &self.corners[corner.next];
            // An edge shrinks if its ends approach each other.
            let line = self.lines[corner.after];
            let along = Point::new(line.normal.y, -line.normal.x, 0.0);
            let closing = (corner.speed - next.speed).dot(along);
            let length = (next.start - corner.start).dot(along);
            if closing > 0.0 && length / closing < limit {
                limit = (length / closing).max(self.now);
                first = Some((limit, Event::Vanishes(v)));
            }
        }
        for v in (0..self.corners.len()).filter(alive) {
            let corner = &self.corners[v];
            if !corner.is_reflex {
                continue;
            }
            for w in (0..self.corners.len()).filter(alive) {
                let edge = &self.corners[w];
                if w == v || edge.next == v || edge.after == corner.after {
                    continue;
                }
                let at = self.meets(corner, edge.after);
                if !(at > self.now - ROUNDING && at < limit) {
                    continue;
                }
                let line = self.lines[edge.after];
                let above = line.normal.dot(corner.at(self.now)) - line.offset - self.now;
                let along = Point::new(line.normal.y, -line.normal.x, 0.0);
                let p = corner.at(at);
                let from = (p - edge.at(at)).dot(along);
                let to = (self.corners[edge.next].at(at) - p).dot(along);
                if above > -ROUNDING && from > -ROUNDING && to > -ROUNDING {
                    limit = at.max(self.now);
                    first = Some((limit, Event::Splits(v, w)));
                }
            }
        }
        first
    }

    fn node(&mut self, p: Point, height: f64) -> u32 {
        self.roof.nodes.push(Point::new(p.x, p.y, height));
        self.roof.nodes.len() as u32 - 1
    }

    /// Ends a corner at a node.
    fn close(&mut self, v: usize, node: u32) {
        let corner = &mut self.corners[v];
        corner.is_alive = false;
        self.roof.edges.push(RoofEdge {
            ends: [corner.from, node],
            sides: [corner.before, corner.after],
            is_valley: corner.is_reflex,
        });
    }

    /// Begins a corner between two others.
    fn begin(&mut self, [before, after]: [usize; 2], ends: [usize; 2], node: u32) -> Option<()> {
        let [previous, next] = ends;
        if previous == next {
            // The outline is a line, traced twice: its ridge ends at the other end.
            let other = self.corners[next].at(self.now);
            let other = self.node(other, self.now);
            self.close(next, other);
            self.roof.edges.push(RoofEdge {
                ends: [node, other],
                sides: [before, after],
                is_valley: false,
            });
            return Some(());
        }
        let new = self.corners.len();
        let corner = self.corner(before, after, node)?;
        self.corners.push(Corner {
            previous,
            next,
            ..corner
        });
        self.corners[previous].next = new;
        self.corners[next].previous = new;
        Some(())
    }

    /// The edge after a corner vanishes.
    fn vanish(&mut self, v: usize, at: f64) -> Option<()> {
        self.now = at;
        let w = self.corners[v].next;
        let p = (self.corners[v].at(at) + self.corners[w].at(at)) * 0.5;
        let node = self.node(p, at);
        let sides = [self.corners[v].before, self.corners[w].after];
        let ends = [self.corners[v].previous, self.corners[w].next];
        self.close(v, node);
        self.close(w, node);
        self.begin(sides, ends, node)
    }

    /// A corner meets the edge after another.
    fn split(&mut self, v: usize, w: usize, at: f64) -> Option<()> {
        self.now = at;
        let (corner, edge) = (self.corners[v], self.corners[w]);
        let node = self.node(corner.at(at), at);
        self.close(v, node);
        self.begin(
            [corner.before, edge.after],
            [corner.previous, edge.next],
            node,
        )?;
        // The first may have ended the edge's end.
        self.begin([edge.after, corner.after], [w, corner.next], node)
    }

    /// Ends all corners at a height.
    fn end(&mut self, height: f64) {
        self.now = height;
        for v in 0..self.corners.len() {
            if !self.corners[v].is_alive {
                continue;
            }
            let mut around = Vec::new();
            let mut at = v;
            while self.corners[at].is_alive {
                let node = self.node(self.corners[at].at(height), height);
                around.push((node, self.corners[at].after));
                self.close(at, node);
                at = self.corners[at].next;
            }
            self.roof.top.push(around);
        }
    }
}

/// Whether two edges of loops cross.
fn crosses_itself(loops: &[Vec<Point>]) -> bool {
    let next = |points: &Vec<Point>, k: usize| points[(k + 1) % points.len()];
    let of = |points: &Vec<Point>| -> Vec<[Point; 2]> {
        let edge = |k: usize| [points[k], next(points, k)];
        (0..points.len()).map(edge).collect()
    };
    let edges: Vec<[Point; 2]> = loops.iter().flat_map(of).collect();
    let parts = |[a, b]: [Point; 2], [c, d]: [Point; 2]| {
        let side = |p: Point| cross(b - a, p - a);
        side(c) * side(d) < 0.0
    };
    let crosses = |(k, edge): (usize, &[Point; 2])| {
        let later = edges[k + 1..].iter();
        later
            .clone()
            .any(|other| parts(*edge, *other) && parts(*other, *edge))
    };
    edges.iter().enumerate().any(crosses)
}

/// Unit vector to the left of a direction.
fn inward(along: Point) -> Point {
    Point::new(-along.y, along.x, 0.0)
}

fn cross(a: Point, b: Point) -> f64 {
    a.x * b.y - a.y * b.x
}
