//! Delaunay tetrahedra of a set of points: incremental insertion (Bowyer 1981, Watson 1981) on
//! exact predicates (Shewchuk 1997, the `robust` crate).
//!
//! # Why the cavity needs no repair
//! A new point `p` removes the tetrahedra whose circumsphere strictly contains it; the cavity's
//! boundary faces joined to `p` fill the hole. That is a triangulation if `p` is strictly in front
//! of each boundary face. Let `p` lie in the plane of a face between a removed tetrahedron and a
//! kept one. Both circumspheres cut that plane in the same circle, so `p`, strictly inside one, is
//! strictly inside the other, and the kept one had to go: a contradiction. This holds for exact
//! predicates, on any input: cocircular and cospherical points stay in the cavity's outside or
//! inside together.
//!
//! # Limits
//! - The points start in one tetrahedron that encloses them all, 64 times their extent away, which is dropped at the
//!   end. Nearly flat tetrahedra on the convex hull, of circumspheres larger than that, may be missing. Balls inside a
//!   surface never are.
//! - The predicates are exact while no product of five coordinate differences underflows: extents
//!   of 1e-50 to 1e50 are safe.

use crate::meshing::axis::insertion_order::insertion_order;
use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::watch::bytes_of;
use robust::{Coord3D, insphere, orient3d};

/// No tetrahedron: beyond a face of the hull.
pub const NONE: u32 = u32::MAX;

/// Distance of the enclosing tetrahedron's corners over the points' extent.
const ENCLOSING: f64 = 64.0;

/// Cells per point, the most that points of a surface have: space for as many is set aside.
const CELLS: usize = 8;

/// Points between two calls of the caller's `tick`: about a millisecond.
const TICK: usize = 256;

/// Tetrahedra whose circumspheres contain no point.
#[derive(Clone, Debug, Default)]
pub struct Delaunay {
    /// Indices of the corners; `orient3d` of them in this order is positive.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Entry `i` of a tetrahedron is the one across the face opposite its corner `i`, or [`NONE`].
    pub neighbors: Vec<[u32; 4]>,
}

impl Delaunay {
    /// Tetrahedra of the given points. Points that are not finite, and repeats of a point, belong
    /// to none; fewer than four points, or points all in one plane, have none.
    pub fn new(points: &[[f64; 3]]) -> Self {
        let points: Vec<Point> = points
            .iter()
            .map(|p| Point::new(p[0], p[1], p[2]))
            .collect();
        let result = Self::with_tick(&points, |_| Ok::<(), std::convert::Infallible>(()));
        match result {
            Ok(delaunay) => delaunay,
        }
    }

    /// Bytes of its arrays, and of those that it takes to make them from so many points.
    pub(crate) fn bytes(&self, points: usize) -> usize {
        let own = bytes_of(&self.tetrahedra) + bytes_of(&self.neighbors);
        own + points * (size_of::<Coord3D<f64>>() + CELLS * (size_of::<Cell>() + 5))
    }

    /// Does the same as [`Self::new`]; `tick` is told how many points are in, and its error ends the work.
    pub(crate) fn with_tick<E>(
        points: &[Point],
        mut tick: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Self, E> {
        let bounds = Bounds::of(points.iter().copied().filter(|p| p.is_finite()));
        let side = bounds.longest_side();
        if !(side > 0.0 && side.is_finite()) {
            return Ok(Self::default());
        }
        let mut work = Triangulation::new(points, &bounds);
        for (done, index) in insertion_order(points, &bounds).into_iter().enumerate() {
            if done % TICK == 0 {
                tick(done)?;
            }
            if points[index as usize].is_finite() {
                work.insert(index);
            }
        }
        Ok(work.finish(points.len()))
    }
}

#[derive(Clone, Copy)]
struct Cell {
    corners: [u32; 4],
    neighbors: [u32; 4],
}

/// A face of the cavity's boundary.
struct Face {
    /// The removed cell behind it.
    cell: u32,
    /// Which of the cell's corners it is opposite to.
    opposite: usize,
}

/// The triangulation while points are inserted.
struct Triangulation {
    points: Vec<Coord3D<f64>>,
    cells: Vec<Cell>,
    alive: Vec<bool>,
    /// Insertion in which a cell was last in the cavity.
    in_cavity: Vec<u32>,
    /// Number of points inserted so far.
    insertion: u32,
    free: Vec<u32>,
    /// A live cell near the last point.
    last: u32,
    cavity: Vec<u32>,
    boundary: Vec<Face>,
}

impl Triangulation {
    fn new(points: &[Point], bounds: &Bounds) -> Self {
        let reach = ENCLOSING * bounds.longest_side();
        let low = bounds.center() - Point::new(reach, reach, reach);
        let edge = 4.0 * reach;
        let corners = [
            low,
            low + Point::new(edge, 0.0, 0.0),
            low + Point::new(0.0, edge, 0.0),
            low + Point::new(0.0, 0.0, edge),
        ];
        let coordinates = |p: &Point| Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        };
        let n = points.len() as u32;
        let mut work = Self {
            points: points.iter().chain(&corners).map(coordinates).collect(),
            cells: Vec::with_capacity(CELLS * points.len()),
            alive: Vec::with_capacity(CELLS * points.len()),
            in_cavity: Vec::with_capacity(CELLS * points.len()),
            insertion: 0,
            free: Vec::new(),
            last: 0,
            cavity: Vec::new(),
            boundary: Vec::new(),
        };
        // Swapped so that the orientation is positive.
        work.add([n + 1, n, n + 2, n + 3], [NONE; 4]);
        work
    }

    fn add(&mut self, corners: [u32; 4], neighbors: [u32; 4]) -> u32 {
        let cell = Cell { corners, neighbors };
        if let Some(index) = self.free.pop() {
            self.cells[index as usize] = cell;
            self.alive[index as usize] = true;
            return index;
        }
        self.cells.push(cell);
        self.alive.push(true);
        self.in_cavity.push(0);
        self.cells.len() as u32 - 1
    }

    fn orientation(&self, corners: [u32; 4]) -> f64 {
        let [a, b, c, d] = corners.map(|v| self.points[v as usize]);
        orient3d(a, b, c, d)
    }

    /// Whether `point` is strictly inside the circumsphere of a cell.
    fn conflicts(&self, cell: u32, point: u32) -> bool {
        let [a, b, c, d] = self.cells[cell as usize]
            .corners
            .map(|v| self.points[v as usize]);
        insphere(a, b, c, d, self.points[point as usize]) > 0.0
    }

    fn insert(&mut self, point: u32) {
        let start = self.locate(point);
        let p = self.points[point as usize];
        let repeated = self.cells[start as usize]
            .corners
            .iter()
            .any(|&v| self.points[v as usize] == p);
        if repeated {
            return;
        }
        self.collect_cavity(start, point);
        self.fill_cavity(point);
    }

    /// The cell that contains `point`, by walking across any face that it is behind. In a Delaunay
    /// triangulation such a walk never returns to a cell (Edelsbrunner 1990).
    fn locate(&self, point: u32) -> u32 {
        let (mut cell, mut from) = (self.last, NONE);
        'walk: loop {
            let Cell { corners, neighbors } = self.cells[cell as usize];
            for k in 0..4 {
                if neighbors[k] == NONE || neighbors[k] == from {
                    continue;
                }
                let mut replaced = corners;
                replaced[k] = point;
                if self.orientation(replaced) < 0.0 {
                    from = cell;
                    cell = neighbors[k];
                    continue 'walk;
                }
            }
            return cell;
        }
    }

    /// Collects the cells in conflict, which are connected, and the faces around them.
    fn collect_cavity(&mut self, start: u32, point: u32) {
        self.insertion += 1;
        self.cavity.clear();
        self.boundary.clear();
        self.cavity.push(start);
        self.in_cavity[start as usize] = self.insertion;
        let mut next = 0;
        while next < self.cavity.len() {
            let cell = self.cavity[next];
            next += 1;
            for opposite in 0..4 {
                let other = self.cells[cell as usize].neighbors[opposite];
                if other != NONE && self.in_cavity[other as usize] == self.insertion {
                    continue;
                }
                if other != NONE && self.conflicts(other, point) {
                    self.in_cavity[other as usize] = self.insertion;
                    self.cavity.push(other);
                } else {
                    self.boundary.push(Face { cell, opposite });
                }
            }
        }
    }

    /// Joins `point` to each boundary face, then links the new cells to each other.
    fn fill_cavity(&mut self, point: u32) {
        for i in 0..self.boundary.len() {
            let Face { cell, opposite } = self.boundary[i];
            let Cell {
                mut corners,
                neighbors,
            } = self.cells[cell as usize];
            corners[opposite] = point;
            let outside = neighbors[opposite];
            let mut links = [NONE; 4];
            links[opposite] = outside;
            let new = self.add(corners, links);
            self.in_cavity[new as usize] = 0;
            if outside != NONE {
                let back = &mut self.cells[outside as usize].neighbors;
                if let Some(k) = back.iter().position(|&n| n == cell) {
                    back[k] = new;
                }
            }
            // From here on the removed cell leads to the new one: see `turn`.
            self.cells[cell as usize].neighbors[opposite] = new;
        }
        for i in 0..self.boundary.len() {
            let Face { cell, opposite } = self.boundary[i];
            let new = self.cells[cell as usize].neighbors[opposite];
            for k in (0..4).filter(|&k| k != opposite) {
                self.cells[new as usize].neighbors[k] = self.turn(cell, opposite, k);
            }
            self.last = new;
        }
        for &cell in &self.cavity {
            self.alive[cell as usize] = false;
        }
        self.free.append(&mut self.cavity);
    }

    /// The new cell across the boundary edge that faces `opposite` and `across` of `cell` share:
    /// turns about that edge through the cavity until the boundary.
    fn turn(&self, mut cell: u32, opposite: usize, mut across: usize) -> u32 {
        let mut pivot = self.cells[cell as usize].corners[opposite];
        loop {
            let Cell { corners, neighbors } = self.cells[cell as usize];
            let next = neighbors[across];
            if self.in_cavity[next as usize] != self.insertion {
                return next;
            }
            // The next cell shares the edge and the pivot; the corner it adds is the next pivot.
            let entered = self.cells[next as usize].corners;
            let left_behind = pivot;
            across = index_of(&entered, left_behind);
            pivot = entered
                .into_iter()
                .find(|v| !corners.contains(v))
                .unwrap_or(left_behind);
            cell = next;
        }
    }

    /// Drops cells that touch the enclosing tetrahedron and closes the gaps in the numbering.
    fn finish(self, points: usize) -> Delaunay {
        let kept = |i: usize| {
            self.alive[i] && self.cells[i].corners.iter().all(|&v| (v as usize) < points)
        };
        let mut index = vec![NONE; self.cells.len()];
        let mut count = 0;
        for (i, index) in index.iter_mut().enumerate() {
            if kept(i) {
                *index = count;
                count += 1;
            }
        }
        let cells = self.cells.iter().zip(&index).filter(|c| *c.1 != NONE);
        let renumber = |n: u32| index.get(n as usize).copied().unwrap_or(NONE);
        Delaunay {
            tetrahedra: cells.clone().map(|c| c.0.corners).collect(),
            neighbors: cells.map(|c| c.0.neighbors.map(renumber)).collect(),
        }
    }
}

fn index_of(corners: &[u32; 4], vertex: u32) -> usize {
    corners.iter().position(|&v| v == vertex).unwrap_or(0)
}
