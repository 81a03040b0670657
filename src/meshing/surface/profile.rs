//! The profile of a body that is a prism: two caps across an axis and walls along it. Its outline is brought to fewer
//! edges, within a thickness.

use crate::meshing::geometry::bounds::{Point, direction, perpendicular};
use crate::meshing::geometry::polygon_triangles::polygon_area;
use crate::meshing::surface::checked_surface::{Surface, cross};
use std::collections::BTreeMap;

/// Normals of caps and walls are off the axis, or square to it, by less than this (rad).
const SQUARE: f64 = 1e-2;

/// Normals of large triangles from which axes are tried: each, and what is square to two of them.
const NORMALS: usize = 4;

/// Share of the area that may be neither cap nor wall, as small fillets and chamfers are. The error that this makes is
/// measured afterwards.
const NEITHER: f64 = 0.03;

/// Corners of a cap are in one plane but for this (longest side 1).
const LEVEL: f64 = 3e-4;

/// Lines that meet at a smaller angle than this (rad) meet where the outline leaves the one for the other.
const BLUNT: f64 = 0.05;

/// Halvings by which the least thickness is sought.
const HALVINGS: usize = 12;

/// A prism.
pub struct Profile {
    /// Directions: two across it, and its axis.
    axes: [Point; 3],
    /// Middle of the prism along the axis.
    middle: f64,
    /// Half its height.
    pub half: f64,
    /// Loops around the caps in the plane `z = 0`, matter on their left.
    pub loops: Vec<Vec<Point>>,
}

impl Profile {
    /// The profile of a surface, if it has one.
    pub fn new(surface: &Surface) -> Option<Self> {
        let area = |t: usize| 0.5 * cross(surface.corners(t)).length();
        let mut largest: Vec<usize> = (0..surface.triangles.len()).collect();
        largest.sort_by(|&t, &u| area(u).total_cmp(&area(t)).then(t.cmp(&u)));
        let mut tried: Vec<Point> = Vec::new();
        for t in largest {
            let normal = surface.normals[t];
            if tried.iter().any(|a| a.dot(normal).abs() > 1.0 - SQUARE) {
                continue;
            }
            if tried.len() == NORMALS {
                break;
            }
            // It is that of a cap, or of a wall, as one before.
            let walls = tried.iter().map(|other| direction(other.cross(normal)));
            for axis in std::iter::once(normal).chain(walls) {
                if neither(surface, axis) < NEITHER * surface.area
                    && let Some(profile) = Self::along(surface, axis)
                {
                    return Some(profile);
                }
            }
            tried.push(normal);
        }
        None
    }

    /// The profile across an axis.
    fn along(surface: &Surface, axis: Point) -> Option<Self> {
        let u = perpendicular(axis);
        let axes = [u, axis.cross(u), axis];
        let heights = || surface.vertices.iter().map(|p| p.dot(axis));
        let high = heights().fold(f64::NEG_INFINITY, f64::max);
        let low = heights().fold(f64::INFINITY, f64::min);
        let is_cap = |t: &[u32; 3]| {
            let on = |v: &u32| surface.vertices[*v as usize].dot(axis) > high - LEVEL;
            t.iter().all(on)
        };
        // Edges of the upper cap that are of one triangle, from start to end.
        let mut ends: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for &[a, b, c] in surface.triangles.iter().filter(|t| is_cap(t)) {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                *ends.entry([p, q]).or_default() += 1;
                *ends.entry([q, p]).or_default() -= 1;
            }
        }
        let mut next: BTreeMap<u32, u32> = BTreeMap::new();
        for ([p, q], _) in ends.into_iter().filter(|e| e.1 > 0) {
            if next.insert(p, q).is_some() {
                return None;
            }
        }
        let mut loops = Vec::new();
        while let Some((&first, _)) = next.first_key_value() {
            let mut around = Vec::new();
            let mut at = first;
            while let Some(to) = next.remove(&at) {
                let p = surface.vertices[at as usize];
                around.push(Point::new(p.dot(axes[0]), p.dot(axes[1]), 0.0));
                at = to;
            }
            if at != first || around.len() < 3 {
                return None;
            }
            // Slivers that close a seam bound nothing.
            let perimeter = sides(&around).map(|side| side.length()).sum::<f64>();
            if polygon_area(&around).abs() > LEVEL * perimeter {
                loops.push(around);
            }
        }
        let profile = Self {
            axes,
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
            loops,
        };
        (!profile.loops.is_empty()).then_some(profile)
    }

    /// A point of the prism's own frame in the builder's.
    pub fn place(&self, p: Point) -> Point {
        let [u, v, axis] = self.axes;
        u * p.x + v * p.y + axis * (self.middle + p.z)
    }

    /// The loops of fewer edges, within `thickness` outside of the outline; `None` where one has fewer than three.
    pub fn loops_within(&self, thickness: f64) -> Option<Vec<Vec<Point>>> {
        self.loops
            .iter()
            .map(|points| fewer(points, thickness))
            .collect()
    }
}

/// Area of triangles that are neither square to an axis nor along it.
fn neither(surface: &Surface, axis: Point) -> f64 {
    let is_neither = |t: &usize| {
        let along = surface.normals[*t].dot(axis).abs();
        along > SQUARE && along < 1.0 - SQUARE * SQUARE
    };
    let all = (0..surface.triangles.len()).filter(is_neither);
    all.map(|t| 0.5 * cross(surface.corners(t)).length()).sum()
}

/// The sides of a loop.
fn sides(around: &[Point]) -> impl Iterator<Item = Point> {
    let n = around.len();
    (0..n).map(move |k| around[(k + 1) % n] - around[k])
}

/// A loop of fewer edges outside of another, within `thickness` and evenly near.
pub fn fewer(points: &[Point], thickness: f64) -> Option<Vec<Point>> {
    let n = points.len();
    let turn = |k: &usize| {
        let (d, e) = (
            direction(points[*k] - points[(k + n - 1) % n]),
            direction(points[(k + 1) % n] - points[*k]),
        );
        -d.dot(e)
    };
    let sharpest = (0..n).max_by(|a, b| turn(a).total_cmp(&turn(b)))?;
    let mut points = points.to_vec();
    points.rotate_left(sharpest);
    let mut ends = runs(&points, thickness);
    let (mut low, mut high) = (0.0, thickness);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let own = runs(&points, middle);
        if own.len() <= ends.len() {
            (high, ends) = (middle, own);
        } else {
            low = middle;
        }
    }
    if ends.len() < 3 {
        return None;
    }
    // Each run's line, moved outward over all of it: normal and offset.
    let line = |k: usize| {
        let (from, to) = (ends[k], ends[(k + 1) % ends.len()]);
        let to = if to <= from { to + n } else { to };
        let along = direction(points[to % n] - points[from]);
        let out = Point::new(along.y, -along.x, 0.0);
        let heights = (from..=to).map(|i| out.dot(points[i % n]));
        (out, heights.fold(f64::NEG_INFINITY, f64::max))
    };
    let corner = |k: usize| {
        let m = ends.len();
        let ((a, p), (b, q)) = (line((k + m - 1) % m), line(k));
        let turn = a.x * b.y - a.y * b.x;
        let at = points[ends[k]];
        let met = Point::new((p * b.y - q * a.y) / turn, (q * a.x - p * b.x) / turn, 0.0);
        match turn.abs() > BLUNT && (met - at).length() < 4.0 * thickness {
            true => met,
            false => at + direction(a + b) * (p - a.dot(at)).max(q - b.dot(at)),
        }
    };
    Some((0..ends.len()).map(corner).collect())
}

/// Indices at which runs of points begin. All points of a run lie within `thickness` across the line between its ends,
/// and each run is as long as can be.
fn runs(points: &[Point], thickness: f64) -> Vec<usize> {
    let n = points.len();
    let fits = |from: usize, to: usize| {
        let along = points[to % n] - points[from];
        let length = along.length();
        if length <= 0.0 {
            return false;
        }
        let out = Point::new(along.y, -along.x, 0.0) * (1.0 / length);
        let (mut low, mut high): (f64, f64) = (0.0, 0.0);
        for i in from + 1..to {
            let to = points[i] - points[from];
            let height = out.dot(to);
            // A line that turns back is no run.
            let way = to.dot(along) / length;
            if !(0.0..=length).contains(&way) {
                return false;
            }
            (low, high) = (low.min(height), high.max(height));
        }
        high - low <= thickness
    };
    let mut ends = vec![0];
    let mut from = 0;
    loop {
        let mut to = from + 1;
        while to < n && fits(from, to + 1) {
            to += 1;
        }
        if to >= n {
            return ends;
        }
        ends.push(to);
        from = to;
    }
}
