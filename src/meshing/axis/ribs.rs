//! A prism as its thick part, which is a prism of fewer edges, and ribs: what is thinner.
//!
//! The outline moves inward by a depth, and the lines of the edges that are left, moved back, bound the thick part: the
//! opening of the outline. Edges that are gone by then are of ribs (teeth, webs, thin walls). A rib is exact, as the
//! part of the prism's roof that is over its edges, or one or two upright plates with round rims, which are a few
//! slabs.

use crate::meshing::axis::prism_axis::{prism_axis, prism_axis_of};
use crate::meshing::axis::wavefront::{PolygonRoof, RoofEdge, polygon_roof};
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::{Point, direction};
use std::f64::consts::SQRT_2;

/// Angle (rad) between two lines below which they are one.
const SAME_LINE: f64 = 0.02;

/// A ridge from a corner of the outline is not of a plate where the corner is at most this many radii from the ball at
/// its other end: at right angles it is 1.41.
const MAX_RIDGE_RATIO: f64 = 1.6;

/// How ribs are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rib {
    /// Ribs are parts of the roof, which is exact.
    Exact,
    /// Each rib is a plate over its ridge.
    Plate,
    /// Each rib is two plates, one along each side.
    TwoPlates,
}

/// An outline, and its thick part.
pub struct Opened<'a> {
    outline: &'a [Vec<Point>],
    /// Half the thickness of the thickest ribs.
    thin: f64,
    /// For each edge of the outline, whether it belongs to a rib. At least one does.
    pub is_rib: Vec<bool>,
    /// Loops around the thick part: none where all is ribs.
    pub loops: Vec<Vec<Point>>,
}

impl<'a> Opened<'a> {
    /// The part of an outline that is thicker than twice `thin`; `None` where all of it is, or where it has no polygon.
    pub fn new(outline: &'a [Vec<Point>], thin: f64) -> Option<Self> {
        let sides = sides(outline);
        let eroded = polygon_roof(outline, thin, 0)?;
        let mut is_rib = vec![true; sides.len()];
        let mut loops = Vec::new();
        for around in &eroded.top {
            let left: Vec<usize> = around.iter().map(|&(_, side)| side).collect();
            left.iter().for_each(|&side| is_rib[side] = false);
            loops.push(corners(&left, &sides)?);
        }
        is_rib.contains(&true).then_some(Self {
            outline,
            thin,
            is_rib,
            loops,
        })
    }

    /// The balls and slabs of the prism from `z = −half` to `half` whose thick part is that over `thick`. Ridges
    /// shorter than `same` are points.
    pub fn draft(&self, thick: &[Vec<Point>], half: f64, same: f64, rib: Rib) -> Option<Draft> {
        let draft = match thick.is_empty() {
            true => Draft::default(),
            false => prism_axis(thick, half, same)?,
        };
        if rib == Rib::Exact {
            let ribs = prism_axis_of(self.outline, half, same, &self.is_rib)?;
            return Some(draft.and(ribs));
        }
        let plates = Plates {
            sides: &sides(self.outline),
            roof: &polygon_roof(self.outline, half.min(2.0 * self.thin), 0)?,
            thick,
            half,
            two: rib == Rib::TwoPlates,
            draft,
        };
        Some(plates.draft(&self.is_rib, same))
    }
}

/// Ribs made of plates.
struct Plates<'a> {
    sides: &'a [[Point; 2]],
    roof: &'a PolygonRoof,
    /// Outline of what they stand on.
    thick: &'a [Vec<Point>],
    half: f64,
    two: bool,
    draft: Draft,
}

impl Plates<'_> {
    fn draft(mut self, is_rib: &[bool], same: f64) -> Draft {
        for edge in self.roof.edges.iter().filter(|e| !e.is_valley) {
            let [p, q] = edge.ends.map(|v| self.roof.nodes[v as usize]);
            let is_of_rib = edge.sides.iter().all(|&side| is_rib[side]);
            if !is_of_rib || flat(p - q).length() < same || is_short(p, q) {
                continue;
            }
            let Some(part) = self.outside(p, q) else {
                continue;
            };
            let at = |k: usize, side: usize| {
                let node = edge.ends[k];
                let whole = part[k] == [0.0, 1.0][k];
                if let Some(corner) = self.corner_at(node, side).filter(|_| self.two && whole) {
                    return (corner + self.roof.nodes[node as usize]) * 0.5;
                }
                let ball = p + (q - p) * part[k];
                match self.two {
                    true => {
                        let touched = flat(ball) + outward(self.sides[side]) * (0.5 * ball.z);
                        Point::new(touched.x, touched.y, 0.5 * ball.z)
                    }
                    false => ball,
                }
            };
            let plates: Vec<[Point; 2]> = match self.two {
                true => edge.sides.iter().map(|&s| [at(0, s), at(1, s)]).collect(),
                false => vec![[at(0, edge.sides[0]), at(1, edge.sides[0])]],
            };
            plates.into_iter().for_each(|ends| self.push(ends));
        }
        self.draft
    }

    /// Adds an upright plate between two balls `(x, y, r)` whose rims cover the corners at the caps.
    fn push(&mut self, ends: [Point; 2]) {
        let half = self.half;
        let draft = &mut self.draft;
        let [[a, b], [c, d]] = ends.map(|p| {
            [1.0, -1.0].map(|up| {
                draft.balls.push(Ball {
                    center: Point::new(p.x, p.y, up * (half - p.z).max(0.0)),
                    radius: SQRT_2 * p.z,
                });
                draft.balls.len() as u32 - 1
            })
        });
        draft.faces.extend([[a, b, c], [c, d, b]]);
    }

    /// The corner of the outline from which a short ridge of a side comes to a node.
    fn corner_at(&self, node: u32, side: usize) -> Option<Point> {
        let ends = |v: &[u32; 2]| v.map(|v| self.roof.nodes[v as usize]);
        let at = |e: &&RoofEdge| {
            let [p, q] = ends(&e.ends);
            !e.is_valley && e.ends.contains(&node) && e.sides.contains(&side) && is_short(p, q)
        };
        let edge = self.roof.edges.iter().find(at)?;
        ends(&edge.ends).into_iter().find(|p| p.z == 0.0)
    }

    /// The part of a ridge that is not over the thick part, from where to where; `None` where all is.
    fn outside(&self, p: Point, q: Point) -> Option<[f64; 2]> {
        let [p, q] = [p, q].map(flat);
        let mut cuts: Vec<f64> = Vec::new();
        for [a, b] in sides(self.thick) {
            let (way, along) = (q - p, b - a);
            let turn = cross(way, along);
            let (s, t) = (cross(a - p, along) / turn, cross(a - p, way) / turn);
            if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
                cuts.push(s);
            }
        }
        cuts.sort_by(f64::total_cmp);
        match (self.is_in_thick(p), self.is_in_thick(q)) {
            (true, true) => None,
            (false, true) => Some([0.0, *cuts.first()?]),
            (true, false) => Some([*cuts.last()?, 1.0]),
            (false, false) => Some([0.0, 1.0]),
        }
    }

    fn is_in_thick(&self, p: Point) -> bool {
        let crosses = |[a, b]: &[Point; 2]| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
        };
        sides(self.thick)
            .iter()
            .filter(|side| crosses(side))
            .count()
            % 2
            == 1
    }
}

/// Whether a ridge comes from a corner that hardly sticks out of the ball at its other end.
fn is_short(p: Point, q: Point) -> bool {
    p.z.min(q.z) == 0.0 && flat(p - q).length() < MAX_RIDGE_RATIO * p.z.max(q.z)
}

fn flat(p: Point) -> Point {
    Point::new(p.x, p.y, 0.0)
}

fn cross(a: Point, b: Point) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The sides of loops, in order.
fn sides(loops: &[Vec<Point>]) -> Vec<[Point; 2]> {
    let of = |points: &Vec<Point>| -> Vec<[Point; 2]> {
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(p, q)| [*p, *q]).collect()
    };
    loops.iter().flat_map(of).collect()
}

fn outward([p, q]: [Point; 2]) -> Point {
    let along = direction(q - p);
    Point::new(along.y, -along.x, 0.0)
}

/// Corners of the polygon that some sides (`left`) of another leave, once they are made longer or shorter to meet.
fn corners(left: &[usize], sides: &[[Point; 2]]) -> Option<Vec<Point>> {
    let out = |side: usize| outward(sides[side]);
    let mut lines: Vec<usize> = Vec::new();
    for &side in left {
        let is_same = |other: &usize| out(*other).dot(out(side)) > SAME_LINE.cos();
        if !lines.last().is_some_and(is_same) {
            lines.push(side);
        }
    }
    while lines.len() > 1 && out(lines[0]).dot(out(lines[lines.len() - 1])) > SAME_LINE.cos() {
        lines.pop();
    }
    let n = lines.len();
    let corner = |k: usize| {
        let [a, b] = [lines[(k + n - 1) % n], lines[k]];
        let [na, nb] = [a, b].map(out);
        let [p, q] = [a, b].map(|side| out(side).dot(sides[side][0]));
        let turn = cross(na, nb);
        (turn.abs() > 0.5 * SAME_LINE).then(|| {
            Point::new(
                (p * nb.y - q * na.y) / turn,
                (q * na.x - p * nb.x) / turn,
                0.0,
            )
        })
    };
    if n < 3 {
        return None;
    }
    (0..n).map(corner).collect()
}
