//! The union of a draft's primitives and its boundary.
//!
//! The signed distance `S(p)`, the smallest over all primitives, changes by at most the way one
//! moves. Outside it is the distance to the solid, so the boundary point `S` towards the nearest
//! ball is exact. Inside it is minus the depth in the deepest ball: a lower bound of the depth in
//! the solid, which is what marching steps need.

use crate::math::least_first::least_first;
use crate::meshing::certify::primitive_tree::{DraftTree, NearestPrimitive};
use crate::meshing::draft::{Ball, Corners, Draft};
use crate::meshing::geometry::bounds::{Bounds, Point, direction};
use std::collections::BinaryHeap;

/// Depth (longest side 1) up to which a point counts as on the boundary: far above rounding, far
/// below any error.
const ON_BOUNDARY: f64 = 1e-7;

/// Length (longest side 1) by which a way out of the solid may be overstated in any case: half of what bodies are
/// enlarged by to cover rounding. Without it, bodies with steps of 1e-5 take three times as long.
const WAY_OUT_LENGTH: f64 = 1e-6;

/// How much larger the next cube is in which an exit is searched, and how much larger the first is than the depth: with
/// the first as large as the way out, thin steps and slits take ten times as long.
const LARGER: f64 = 4.0;

/// Length (longest side 1) that is beyond any solid.
pub const MOST_WAY: f64 = 2.0;

/// Room of a rough search for an exit, as a share of the distance that is enough.
const ROUGH: f64 = 0.25;

/// A cube of space.
#[derive(Clone, Copy)]
pub struct Cell {
    /// Middle of the cell.
    pub center: Point,
    half_side: f64,
}

impl Cell {
    /// Distance from the middle to a corner.
    pub fn radius(&self) -> f64 {
        self.half_side * 3f64.sqrt()
    }

    /// Length of a side.
    pub fn side(&self) -> f64 {
        2.0 * self.half_side
    }

    /// The cube of another side about the same middle.
    pub fn with_side(&self, side: f64) -> Self {
        Self {
            center: self.center,
            half_side: 0.5 * side,
        }
    }

    /// The eight cubes of half the side.
    pub fn children(&self) -> impl Iterator<Item = Cell> + use<> {
        let Cell { center, half_side } = *self;
        let quarter = 0.5 * half_side;
        (0..8u32).map(move |child| {
            let way = |bit: u32| {
                if child >> bit & 1 == 0 {
                    quarter
                } else {
                    -quarter
                }
            };
            Cell {
                center: center + Point::new(way(0), way(1), way(2)),
                half_side: quarter,
            }
        })
    }

    fn distance(&self, p: Point) -> f64 {
        let half = Point::new(self.half_side, self.half_side, self.half_side);
        let (lo, hi) = (self.center - half, self.center + half);
        Bounds { lo, hi }.distance_sq(p).sqrt()
    }
}

/// The union of the primitives of a draft, which must have at least one.
pub struct Solid<'a> {
    tree: DraftTree<'a>,
    bounds: Bounds,
}

impl<'a> Solid<'a> {
    /// The solid of a draft.
    pub fn new(draft: &'a Draft) -> Self {
        let boxes = draft
            .balls
            .iter()
            .map(|b| Bounds::of_ball(b.center, b.radius));
        Self {
            tree: DraftTree::new(draft),
            bounds: boxes.fold(Bounds::EMPTY, Bounds::union),
        }
    }

    /// A cube around the solid.
    pub fn whole(&self) -> Cell {
        Cell {
            center: self.bounds.center(),
            half_side: 0.5 * self.bounds.longest_side(),
        }
    }

    /// The primitive nearest to `p`; see [`DraftTree::nearest`].
    pub fn nearest(&self, p: Point, hint: u32) -> NearestPrimitive {
        self.tree.nearest(p, hint)
    }

    /// Primitives of the solid, in the order of the indices that [`Self::nearest`] gives.
    pub fn primitives(&self) -> &[Corners] {
        self.tree.primitives()
    }

    /// The ball of a primitive that is nearest to the point asked for.
    pub fn ball(&self, near: &NearestPrimitive) -> Ball {
        self.tree.ball(near)
    }

    /// Does the same as [`Self::nearest`], if the signed distance is at most `limit` on either side; `None` otherwise.
    pub fn nearest_if_near(&self, p: Point, limit: f64, hint: u32) -> Option<NearestPrimitive> {
        let near = self.tree.nearest_between(p, -limit, limit, hint);
        (near.signed.distance.abs() <= limit).then_some(near)
    }

    /// Signed distance of `p` to one primitive.
    pub fn distance_to(&self, primitive: u32, p: Point) -> f64 {
        self.tree.distance_to(primitive, p).distance
    }

    /// Whether `p` is outside or on the boundary; `hint` is a primitive that may hold it.
    pub fn is_out(&self, p: Point, hint: u32) -> bool {
        !self.tree.any_below(p, -ON_BOUNDARY, hint)
    }

    /// The direction out of a primitive that a triangle of middle `middle` is not proven to be outside of or on; `None`
    /// where it is of all, and so outside the solid or on its boundary.
    ///
    /// The signed distance to a primitive is convex, so at each point it is at least its tangent plane at
    /// the middle, which is least at a corner. That is second order in the triangle's size, where the
    /// distance at the middle alone is first order.
    pub fn exit_of_any(&self, corners: &[Point; 3], middle: Point, hint: u32) -> Option<Point> {
        let from_middle = corners.map(|c| c - middle);
        let far = from_middle.iter().map(|c| c.length_sq());
        let radius = far.fold(0.0, f64::max).sqrt();
        let mut way = None;
        self.tree.all_below(middle, radius, hint, |near| {
            let outward = direction(middle - self.tree.ball(near).center);
            let heights = from_middle.iter().map(|c| c.dot(outward));
            let is_out =
                near.signed.distance + heights.fold(f64::INFINITY, f64::min) >= -ON_BOUNDARY;
            if !is_out {
                way = Some(outward);
            }
            is_out
        });
        way
    }

    /// The point of the nearest ball's surface that is nearest to `p`.
    pub fn towards_boundary(&self, p: Point, near: &NearestPrimitive) -> Point {
        p - direction(p - self.ball(near).center) * near.signed.distance
    }

    /// Whether a point that [`Self::towards_boundary`] gave is on the boundary; from outside it always is.
    pub fn is_on_boundary(&self, moved: Point, near: &NearestPrimitive) -> bool {
        near.signed.distance >= 0.0 || self.is_out(moved, near.primitive)
    }

    /// [`Self::towards_boundary`], if it is on the boundary.
    pub fn onto_boundary(&self, p: Point, near: &NearestPrimitive) -> Option<Point> {
        let moved = self.towards_boundary(p, near);
        self.is_on_boundary(moved, near).then_some(moved)
    }

    /// Length of the way from `p`, inside, along a unit vector to the boundary; infinite where it only grazes it, or is
    /// longer than `most`.
    pub fn exit_distance(&self, p: Point, towards: Point, most: f64, hint: u32) -> f64 {
        let mut way = 0.0;
        // 64 steps end all but grazing ways.
        for _ in 0..64 {
            let depth = -self.nearest(p + towards * way, hint).signed.distance;
            if depth <= ON_BOUNDARY {
                return way;
            }
            way += depth;
            if way > most {
                break;
            }
        }
        f64::INFINITY
    }

    /// The nearest exit from `p`, inside, with a distance that is overstated by at most a `share` of it or
    /// [`WAY_OUT_LENGTH`]; none beyond `way`, or beyond 2. Any exit found within `enough` ends the search. Cubes around
    /// `p` are searched, each [`LARGER`] than the one before, until one holds an exit and the ball up to it. First the
    /// one of size `enough` is searched roughly: where air ends in a wedge, all cells at its tip come first.
    pub fn nearest_exit(&self, p: Point, [way, enough]: [f64; 2], share: f64) -> Exit {
        let most = way.min(MOST_WAY);
        let near = self.nearest(p, 0);
        let room = |way: f64| (share * way).max(WAY_OUT_LENGTH);
        let rough = Cell {
            center: p,
            half_side: enough.min(most),
        };
        let exit = self.exit_within(
            rough,
            [most, enough],
            &|way| room(way).max(ROUGH * enough),
            near.primitive,
        );
        if exit.distance <= enough {
            return exit;
        }
        let mut cells = exit.cells;
        // No exit is nearer than the depth.
        let mut half_side = LARGER * near.signed.distance.abs().max(ON_BOUNDARY);
        loop {
            let last = half_side >= most;
            let cell = Cell {
                center: p,
                half_side: half_side.min(most),
            };
            let exit = self.exit_within(cell, [most, enough], &room, near.primitive);
            cells += exit.cells;
            if last || exit.distance <= half_side {
                return Exit { cells, ..exit };
            }
            half_side *= LARGER;
        }
    }

    /// The nearest exit in a cube around a point as [`Self::nearest_exit`]. Cells that the boundary may cross are
    /// searched, nearest first, down to half of the `room` that a way may be overstated by.
    fn exit_within(
        &self,
        cube: Cell,
        [way, enough]: [f64; 2],
        room: &dyn Fn(f64) -> f64,
        mut hint: u32,
    ) -> Exit {
        let p = cube.center;
        let mut best = Exit {
            distance: way,
            point: None,
            cells: 0,
        };
        let mut waiting = BinaryHeap::from([PendingCell {
            bound: 0.0,
            cell: cube,
        }]);
        while let Some(PendingCell { bound, cell }) = waiting.pop() {
            let room = room(best.distance);
            if best.distance <= enough || bound >= best.distance - room {
                break;
            }
            best.cells += 1;
            let near = self.nearest(cell.center, hint);
            hint = near.primitive;
            if near.signed.distance.abs() > cell.radius() {
                continue;
            }
            if let Some(exit) = self.onto_boundary(cell.center, &near) {
                let distance = (exit - p).length();
                if distance < best.distance {
                    (best.distance, best.point) = (distance, Some(exit));
                }
            }
            if cell.radius() > 0.5 * room {
                waiting.extend(cell.children().map(|cell| PendingCell {
                    bound: cell.distance(p),
                    cell,
                }));
            }
        }
        best
    }
}

/// A way out of a solid.
pub struct Exit {
    /// Length of the way.
    pub distance: f64,
    /// Point where the way ends. `None` if no way is shorter than the limit of the search; `distance` is then that
    /// limit.
    pub point: Option<Point>,
    /// Cells that the search for it looked at.
    pub cells: u64,
}

/// A cell to be searched, and its distance.
struct PendingCell {
    bound: f64,
    cell: Cell,
}

least_first!(PendingCell, bound);

#[cfg(test)]
mod tests {
    use super::Solid;
    use crate::meshing::draft::{Ball, Draft};
    use crate::meshing::geometry::bounds::Point;

    /// Two balls of radius 1 whose surfaces meet in a circle of radius .8.
    fn peanut() -> Draft {
        let ball = |x| Ball {
            center: Point::new(x, 0.0, 0.0),
            radius: 1.0,
        };
        Draft {
            balls: vec![ball(-0.6), ball(0.6)],
            ..Draft::default()
        }
    }

    #[test]
    fn the_nearest_way_out_ends_in_the_groove() {
        let draft = peanut();
        let solid = Solid::new(&draft);
        for (share, height) in [(0.15, 0.3), (0.05, 0.3), (0.15, 0.75), (0.05, 0.79)] {
            let p = Point::new(0.0, height, 0.0);
            let exit = solid.nearest_exit(p, [f64::INFINITY, 0.0], share);
            let true_way = 0.8 - height;
            let way = exit.point.map(|end| (end - p).length());
            assert_eq!(way, Some(exit.distance));
            assert!(
                exit.distance >= true_way - 1e-6,
                "{} at {height}",
                exit.distance
            );
            let most = true_way / (1.0 - share) + 1e-6;
            assert!(exit.distance <= most, "{} at {height}", exit.distance);
        }
    }

    #[test]
    fn a_way_out_that_is_short_enough_ends_the_search() {
        let draft = peanut();
        let solid = Solid::new(&draft);
        let p = Point::new(0.0, 0.3, 0.0);
        let enough = solid.nearest_exit(p, [f64::INFINITY, 1.0], 0.05);
        let nearest = solid.nearest_exit(p, [f64::INFINITY, 0.0], 0.05);
        assert!(enough.distance <= 1.0 && enough.cells < nearest.cells);
        // None is shorter than half of the way.
        let none = solid.nearest_exit(p, [0.25, 0.0], 0.05);
        assert!(none.point.is_none() && none.distance == 0.25);
    }
}
