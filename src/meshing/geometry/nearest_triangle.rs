//! Distances to triangles: boxes over them, four side by side.
//!
//! Nearest point on a triangle: Ericson, Real-Time Collision Detection (2005), §5.1.5.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::geometry::four_boxes::{Child, FourBoxes, FourPoints, nearest_first, slack};
use crate::meshing::geometry::triangle::closest_on_triangle;
use crate::meshing::watch::{Watch, bytes_of};
use std::cell::Cell;
use std::ops::{ControlFlow, Range};

struct Node {
    boxes: FourBoxes,
    children: [Child; 4],
}

/// Boxes over triangles; node 0 is the root.
pub struct NearestTriangle {
    nodes: Vec<Node>,
    corners: Vec<[Point; 3]>,
    /// Largest coordinate.
    reach: f64,
}

impl NearestTriangle {
    /// The tree of triangles that lie in the order of a tree which halves: each half of them is a group,
    /// and each half of that.
    pub fn new(corners: Vec<[Point; 3]>, watch: &mut Watch) -> Result<Self, BuildError> {
        let far = |p: &Point| p.x.abs().max(p.y.abs()).max(p.z.abs());
        let mut tree = Self {
            nodes: Vec::with_capacity(corners.len() / 3 + 1),
            reach: corners.iter().flatten().map(far).fold(0.0, f64::max),
            corners,
        };
        tree.group(0..tree.corners.len(), watch)?;
        Ok(tree)
    }

    /// Bytes of its arrays.
    pub fn bytes(&self) -> usize {
        bytes_of(&self.nodes) + bytes_of(&self.corners)
    }

    /// The triangles.
    pub fn corners(&self) -> &[[Point; 3]] {
        &self.corners
    }

    /// Turns a triangle round.
    pub fn turn(&mut self, triangle: usize) {
        self.corners[triangle].swap(1, 2);
    }

    /// Adds the node of a group, and those below it; gives its index and the box around it.
    fn group(&mut self, of: Range<usize>, watch: &mut Watch) -> Result<(u32, Bounds), BuildError> {
        let halves = |r: Range<usize>| {
            let middle = r.start + r.len() / 2;
            [r.start..middle, middle..r.end]
        };
        let [left, right] = halves(of);
        let ([a, b], [c, d]) = (halves(left), halves(right));
        let index = self.nodes.len();
        watch.every(index)?;
        self.nodes.push(Node {
            boxes: FourBoxes::new([None; 4]),
            children: [Child::Nothing; 4],
        });
        let mut boxes = [None; 4];
        for (k, part) in [a, b, c, d].into_iter().enumerate() {
            let (child, bounds) = match part.len() {
                0 => continue,
                1 => {
                    let only = part.start;
                    (Child::Leaf(only as u32), Bounds::of(self.corners[only]))
                }
                _ => {
                    let (group, bounds) = self.group(part, watch)?;
                    (Child::Group(group), bounds)
                }
            };
            boxes[k] = Some(bounds);
            self.nodes[index].children[k] = child;
        }
        self.nodes[index].boxes = FourBoxes::new(boxes);
        let around = boxes.into_iter().flatten();
        Ok((index as u32, around.fold(Bounds::EMPTY, Bounds::union)))
    }

    /// Squared distance to a triangle.
    pub fn distance_sq_to(&self, triangle: u32, p: Point) -> f64 {
        (closest_on_triangle(p, &self.corners[triangle as usize]) - p).length_sq()
    }

    /// Squared distance to the nearest triangle within the squared distance `limit_sq` and its index
    /// (of those as near the last), infinite if there is none; with `any`, of the first one found.
    pub fn search(&self, p: Point, limit_sq: f64, any: bool) -> (f64, u32) {
        self.search_counted(p, limit_sq, any, &mut 0)
    }

    /// Does the same as [`Self::search`]; adds the number of nodes and triangles that were looked at to `work`.
    pub fn search_counted(&self, p: Point, limit_sq: f64, any: bool, work: &mut u64) -> (f64, u32) {
        let mut found = (f64::INFINITY, 0);
        let mut best_sq = limit_sq;
        let mut triangles = 0;
        *work += self.visit(p, limit_sq.sqrt(), |triangle| {
            triangles += 1;
            let distance_sq = self.distance_sq_to(triangle, p);
            if distance_sq > best_sq || distance_sq == found.0 && triangle < found.1 {
                return ControlFlow::Continue(None);
            }
            best_sq = distance_sq;
            found = (distance_sq, triangle);
            match any {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(Some(best_sq.sqrt())),
            }
        });
        *work += triangles;
        found
    }

    /// Calls `see` for all triangles within `distance` of `p`.
    pub fn each_within(&self, p: Point, distance: f64, mut see: impl FnMut(&[Point; 3])) {
        self.visit(p, distance, |triangle| {
            if self.distance_sq_to(triangle, p) <= distance * distance {
                see(&self.corners[triangle as usize]);
            }
            ControlFlow::Continue(None)
        });
    }

    /// Calls `see` for triangles that may be within `limit` of `p`, nearer groups first; `see` may return a new limit,
    /// or end the search. Returns the number of nodes that were looked at.
    fn visit(
        &self,
        p: Point,
        limit: f64,
        see: impl FnMut(u32) -> ControlFlow<(), Option<f64>>,
    ) -> u64 {
        let point = FourPoints::splat(p);
        let nodes = Cell::new(0);
        let look = |group: u32| {
            nodes.set(nodes.get() + 1);
            let node = &self.nodes[group as usize];
            let bounds = node.boxes.distance_sq(&point).sqrt();
            (bounds.to_array(), node.children)
        };
        nearest_first(limit, slack(p, self.reach), look, see);
        nodes.get()
    }
}
