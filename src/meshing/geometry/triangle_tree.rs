//! A tree of boxes over the source triangles, in double precision: distance and winding number.
//!
//! Distances: `nearest_triangle.rs`. Winding numbers: `winding.rs`; the dipoles that they need are formed here.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Bounds, Point, coordinate, direction};
use crate::meshing::geometry::closed::closes;
use crate::meshing::geometry::nearest_triangle::NearestTriangle;
use crate::meshing::geometry::triangle::closest_on_triangle;
use crate::meshing::watch::{Watch, bytes_of};

/// Triangles in a leaf. 2 to 8 differ by less than a tenth in time.
const LEAF: usize = 4;

pub(super) struct Node {
    pub(super) bounds: Bounds,
    /// Leaf: first triangle. Inner: first of two neighbouring children.
    pub(super) first: u32,
    /// Leaf: number of triangles. Inner: 0.
    pub(super) count: u32,
    pub(super) dipole: Dipole,
}

/// First guess of the distance of a ball or sample to the surface (longest side 1); only time depends on it.
pub const GUESS: f64 = 0.004;

/// A group of triangles as seen from afar: a dipole at its centroid.
#[derive(Clone, Copy)]
pub(super) struct Dipole {
    pub(super) center: Point,
    /// Sum of the area vectors.
    pub(super) moment: Point,
    area: f64,
    /// Upper bound on the distance from `center` to the farthest corner of the group.
    pub(super) radius: f64,
}

/// Boxes over triangles; node 0 is the root.
pub struct TriangleTree {
    /// Nodes of the tree for winding numbers.
    pub(super) nodes: Vec<Node>,
    pub(super) nearest: NearestTriangle,
    /// Place of each triangle among those given.
    given: Vec<u32>,
    /// How much each triangle counts in the winding number: 1, or −1 where it is seen from behind,
    /// or 0 where it bounds nothing.
    pub(super) counts: Vec<i8>,
    /// Whether the triangles that count close a surface.
    pub(super) is_closed: bool,
}

/// Middle of a triangle, and its place among those given.
type Item = (Point, u32);

/// Larger groups report before they are split: a millisecond's work.
const LARGE: usize = 8_192;

impl TriangleTree {
    /// Builds the tree of `count` triangles by halving at the median of the longest spread of
    /// their middles.
    ///
    /// Each triangle counts in the winding number until [`Self::recount`].
    pub fn new(
        count: usize,
        corners: impl Fn(usize) -> [Point; 3],
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let mut items: Vec<Item> = Vec::with_capacity(count);
        for i in 0..count {
            watch.every(i)?;
            let [a, b, c] = corners(i);
            items.push(((a + b + c) * (1.0 / 3.0), i as u32));
        }
        let mut nodes = vec![Node::EMPTY];
        build(&mut nodes, 0, (0, &mut items), &corners, watch)?;
        let sorted = items.iter().map(|i| corners(i.1 as usize)).collect();
        let mut tree = Self {
            nodes,
            nearest: NearestTriangle::new(sorted, watch)?,
            given: items.into_iter().map(|i| i.1).collect(),
            counts: vec![1; count],
            is_closed: false,
        };
        tree.sum_up(watch)?;
        Ok(tree)
    }

    /// Place, among the triangles that the tree was built of, of one that it gave.
    pub fn given(&self, triangle: u32) -> u32 {
        self.given[triangle as usize]
    }

    /// Bytes of its arrays.
    pub fn bytes(&self) -> usize {
        let of_each = bytes_of(&self.given) + bytes_of(&self.counts);
        bytes_of(&self.nodes) + self.nearest.bytes() + of_each
    }

    /// Lets each triangle, by its place among those given, count as `counts` says: 1, −1 or 0.
    pub fn recount(
        &mut self,
        counts: impl Fn(u32) -> i8,
        watch: &mut Watch,
    ) -> Result<(), BuildError> {
        for (i, (count, &given)) in self.counts.iter_mut().zip(&self.given).enumerate() {
            watch.every(i)?;
            *count = counts(given);
        }
        self.sum_up(watch)
    }

    /// Turns the triangles that are seen from behind round, so that they count as 1.
    pub fn turn(&mut self) {
        for (triangle, count) in self.counts.iter_mut().enumerate() {
            if *count < 0 {
                self.nearest.turn(triangle);
                *count = 1;
            }
        }
    }

    /// Forms the dipoles, children before parents, and sees whether what counts is closed.
    fn sum_up(&mut self, watch: &mut Watch) -> Result<(), BuildError> {
        for index in (0..self.nodes.len()).rev() {
            watch.every(index)?;
            let node = &self.nodes[index];
            let first = node.first as usize;
            self.nodes[index].dipole = if node.count > 0 {
                let range = first..first + node.count as usize;
                Dipole::of(&self.nearest.corners()[range.clone()], &self.counts[range])
            } else {
                let [left, right] = [first, first + 1].map(|n| &self.nodes[n]);
                Dipole::of_both(&left.dipole, &right.dipole, &node.bounds)
            };
        }
        self.is_closed = closes(self.nearest.corners(), &self.counts, watch)?;
        Ok(())
    }

    /// Distance to the surface, and the triangle that gives it; `hint` is a triangle that is likely
    /// near.
    pub fn distance_from(&self, p: Point, hint: u32) -> (f64, u32) {
        self.distance_counted(p, hint, &mut 0)
    }

    /// Does the same as [`Self::distance_from`]; adds the number of nodes and triangles that were looked at to `work`.
    fn distance_counted(&self, p: Point, hint: u32, work: &mut u64) -> (f64, u32) {
        let at_hint = self.nearest.distance_sq_to(hint, p);
        let (distance_sq, triangle) = self.nearest.search_counted(p, at_hint, false, work);
        match distance_sq <= at_hint {
            true => (distance_sq.sqrt(), triangle),
            false => (at_hint.sqrt(), hint),
        }
    }

    /// Point of the surface at the distance of [`Self::distance_from`]; adds the number of nodes and triangles that
    /// were looked at to `work`.
    pub fn closest_counted(&self, p: Point, hint: u32, work: &mut u64) -> (Point, u32) {
        let (_, triangle) = self.distance_counted(p, hint, work);
        let corners = &self.nearest.corners()[triangle as usize];
        (closest_on_triangle(p, corners), triangle)
    }

    /// Whether a triangle is within `distance`.
    pub fn is_within(&self, triangle: u32, p: Point, distance: f64) -> bool {
        distance >= 0.0 && self.nearest.distance_sq_to(triangle, p) <= distance * distance
    }

    /// A triangle within `distance`, if there is one.
    pub fn some_within(&self, p: Point, distance: f64) -> Option<u32> {
        if distance < 0.0 {
            return None;
        }
        let (distance_sq, triangle) = self.nearest.search(p, distance * distance, true);
        (distance_sq < f64::INFINITY).then_some(triangle)
    }

    /// Whether some triangle is within `distance`.
    pub fn any_within(&self, p: Point, distance: f64) -> bool {
        self.some_within(p, distance).is_some()
    }

    /// Distance to the surface, if it is within `limit`, and the triangle that gives it.
    pub fn nearest_within(&self, p: Point, limit: f64) -> Option<(f64, u32)> {
        let (distance_sq, triangle) = self.nearest.search(p, limit.max(0.0).powi(2), false);
        (distance_sq < f64::INFINITY).then(|| (distance_sq.sqrt(), triangle))
    }

    /// The point of the surface nearest to `p`, if it is within `limit`.
    pub fn closest_within(&self, p: Point, limit: f64) -> Option<Point> {
        let (_, triangle) = self.nearest_within(p, limit)?;
        Some(closest_on_triangle(
            p,
            &self.nearest.corners()[triangle as usize],
        ))
    }

    /// The point of the surface nearest to `p`; `guess` is its likely distance, and only the time
    /// depends on it.
    pub fn closest(&self, p: Point, guess: f64) -> Point {
        self.closest_triangle(p, guess).0
    }

    /// Does the same as [`Self::closest`], and gives the triangle that the point is of. The tree must not be empty.
    pub fn closest_triangle(&self, p: Point, guess: f64) -> (Point, u32) {
        let within = |limit: f64| self.nearest_within(p, limit).map(|found| found.1);
        let nearest = within(guess).or_else(|| within(f64::INFINITY)).unwrap_or(0);
        let corners = &self.nearest.corners()[nearest as usize];
        (closest_on_triangle(p, corners), nearest)
    }

    /// Signed distance to the surface, negative inside (behind the nearest triangle). `guess` is the likely distance;
    /// only the time depends on it.
    ///
    /// At an edge or a corner several triangles are equally near, and `p` may be before one and behind another. The
    /// triangle from whose plane `p` is farthest decides, since its side is the clearest. The sign can be wrong only if
    /// two of them tie to within rounding, or near a hole of the surface.
    pub fn signed_distance(&self, p: Point, guess: f64) -> f64 {
        self.signed_within(p, guess)
            .or_else(|| self.signed_within(p, f64::INFINITY))
            .unwrap_or(f64::INFINITY)
    }

    /// The signed distance, if the surface is within `limit`; `None` otherwise.
    pub fn signed_within(&self, p: Point, limit: f64) -> Option<f64> {
        let distance = (self.closest_within(p, limit)? - p).length();
        let mut height = 0.0f64;
        self.nearest
            .each_within(p, distance * (1.0 + 1e-9) + 1e-12, |corners| {
                let [a, b, c] = *corners;
                let h = direction((b - a).cross(c - a)).dot(p - closest_on_triangle(p, corners));
                if h.abs() > height.abs() {
                    height = h;
                }
            });
        Some(if height <= 0.0 { -distance } else { distance })
    }
}

/// Splits the items of a node, the first of which is the tree's `first`, at the median of the
/// longest spread.
fn build(
    nodes: &mut Vec<Node>,
    node: usize,
    (first, items): (usize, &mut [Item]),
    corners: &impl Fn(usize) -> [Point; 3],
    watch: &mut Watch,
) -> Result<(), BuildError> {
    if items.len() > LARGE {
        watch.at(0.0)?;
    }
    let leaf = items.len() <= LEAF;
    let children = nodes.len();
    nodes[node] = Node {
        bounds: Bounds::of(items.iter().flat_map(|i| corners(i.1 as usize))),
        first: if leaf { first as u32 } else { children as u32 },
        count: if leaf { items.len() as u32 } else { 0 },
        dipole: Dipole::NONE,
    };
    if leaf {
        return Ok(());
    }
    let axis = Bounds::of(items.iter().map(|i| i.0)).longest_axis();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        coordinate(a.0, axis)
            .total_cmp(&coordinate(b.0, axis))
            .then(a.1.cmp(&b.1))
    });
    nodes.extend([Node::EMPTY, Node::EMPTY]);
    let (left, right) = items.split_at_mut(middle);
    build(nodes, children, (first, left), corners, watch)?;
    build(nodes, children + 1, (first + middle, right), corners, watch)
}

impl Node {
    /// A node without triangles.
    const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        first: 0,
        count: 0,
        dipole: Dipole::NONE,
    };
}

impl Dipole {
    /// The dipole of nothing.
    const NONE: Self = Self {
        center: Point {
            x: 0.0,
            y: 0.0,
            z: 0.0,
        },
        moment: Point {
            x: 0.0,
            y: 0.0,
            z: 0.0,
        },
        area: 0.0,
        radius: 0.0,
    };

    fn of(triangles: &[[Point; 3]], counts: &[i8]) -> Self {
        let mut sum = Self::NONE;
        let counted = || triangles.iter().zip(counts).filter(|t| *t.1 != 0);
        for ([a, b, c], &count) in counted() {
            let n = (*b - *a).cross(*c - *a) * 0.5;
            let weight = n.length();
            sum.area += weight;
            sum.center = sum.center + (*a + *b + *c) * (weight / 3.0);
            sum.moment = sum.moment + n * f64::from(count);
        }
        if sum.area > 0.0 {
            sum.center = sum.center * (1.0 / sum.area);
        }
        let corners = counted().flat_map(|t| *t.0);
        let radius_sq = corners.map(|corner| (corner - sum.center).length_sq());
        sum.radius = radius_sq.fold(0.0, f64::max).sqrt();
        sum
    }

    /// The dipole of two groups that lie in a box.
    fn of_both(left: &Self, right: &Self, bounds: &Bounds) -> Self {
        let area = left.area + right.area;
        if area <= 0.0 {
            return Self::NONE;
        }
        let center = (left.center * left.area + right.center * right.area) * (1.0 / area);
        let reach = |d: &Self| match d.area > 0.0 {
            true => d.radius + (d.center - center).length(),
            false => 0.0,
        };
        Self {
            center,
            moment: left.moment + right.moment,
            area,
            radius: reach(left).max(reach(right)).min(bounds.farthest(center)),
        }
    }
}
