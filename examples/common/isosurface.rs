//! Triangle mesh of the surface where a field is zero: surface nets (Gibson 1998), one vertex in
//! each grid cell that the surface visits, one quad across each grid edge that it crosses.
//!
//! Such a surface is manifold exactly when the inner grid points are well-composed (Latecki 1997):
//! no square of the grid has its two inner points on a diagonal, no cube has just two inner or two
//! outer points, opposite each other. Where a slice of the solid is thinner than the grid, points
//! are filled in until that holds; the vertices are then drawn back onto the true surface.

use super::mesh::Mesh;
use rapier3d::prelude::{Real, Vector};

/// Meshes the surface `field = 0` inside the box from `low`, where the field is negative inside
/// the solid. `cells` counts cubes of side `cell` along each axis; the surface must keep one cell
/// away from the box's sides.
pub fn isosurface(
    field: impl Fn(Vector) -> Real,
    low: Vector,
    cells: [usize; 3],
    cell: Real,
) -> Mesh {
    let mut grid = Grid::new(&field, low, cells, cell);
    while grid.fill_critical_points(cells) {}
    let mut mesh = Mesh::default();
    let mut vertex_of_cell = vec![u32::MAX; grid.values.len()];
    for at in grid.points(cells) {
        if let Some(crossing) = grid.mean_crossing(at) {
            vertex_of_cell[grid.index(at)] = mesh.vertices.len() as u32;
            mesh.vertices.push(onto_surface(&field, crossing, cell));
        }
    }
    for at in grid.points(cells) {
        for axis in 0..3 {
            let Some(quad) = grid.cells_around_edge(at, axis) else {
                continue;
            };
            let [a, b, c, d] = quad.map(|cell| vertex_of_cell[cell]);
            let length =
                |i: u32, j: u32| mesh.vertices[i as usize].distance(mesh.vertices[j as usize]);
            mesh.indices.extend(if length(a, c) <= length(b, d) {
                [[a, b, c], [a, c, d]]
            } else {
                [[b, c, d], [b, d, a]]
            });
        }
    }
    mesh
}

/// Corners of a cube, numbered by their bits: x is bit 0, y bit 1, z bit 2.
fn corner(at: [usize; 3], k: usize) -> [usize; 3] {
    [at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2)]
}

/// The faces of a cube and the cube itself, first and last corner opposite each other.
const CORNER_SETS: [&[usize]; 7] = [
    &[0, 1, 2, 3],
    &[4, 5, 6, 7],
    &[0, 1, 4, 5],
    &[2, 3, 6, 7],
    &[0, 2, 4, 6],
    &[1, 3, 5, 7],
    &[0, 1, 2, 3, 4, 5, 6, 7],
];

/// Values of the field at the corners of the cells.
struct Grid {
    low: Vector,
    cell: Real,
    corners: [usize; 3],
    values: Vec<Real>,
}

impl Grid {
    fn new(field: impl Fn(Vector) -> Real, low: Vector, cells: [usize; 3], cell: Real) -> Self {
        let corners = cells.map(|n| n + 1);
        let mut grid = Self {
            low,
            cell,
            corners,
            values: Vec::new(),
        };
        grid.values = grid
            .points(corners)
            .map(|at| field(grid.position(at)))
            .collect();
        grid
    }

    /// All grid points below `counts`, x fastest: the order of `values` for the corners.
    fn points(&self, counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = counts;
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.corners[1] + y) * self.corners[0] + x
    }

    fn position(&self, at: [usize; 3]) -> Vector {
        self.low + Vector::from(at.map(|k| k as Real)) * self.cell
    }

    fn value(&self, at: [usize; 3]) -> Real {
        self.values[self.index(at)]
    }

    /// Makes one outer point of each critical square or cube an inner one; false if there were none.
    fn fill_critical_points(&mut self, cells: [usize; 3]) -> bool {
        let mut filled = false;
        for at in self.points(cells) {
            let critical = CORNER_SETS.iter().find(|set| self.is_critical(at, set));
            if let Some(set) = critical {
                let corners = set.iter().map(|k| self.index(corner(at, *k)));
                let outer = corners.filter(|k| self.values[*k] >= 0.0);
                let nearest = outer.min_by(|i, j| self.values[*i].total_cmp(&self.values[*j]));
                self.values[nearest.expect("an outer point")] = -1.0e-3 * self.cell;
                filled = true;
            }
        }
        filled
    }

    fn is_critical(&self, at: [usize; 3], set: &[usize]) -> bool {
        let inside = |k: &usize| self.value(corner(at, *k)) < 0.0;
        let inner: Vec<usize> = set.iter().copied().filter(inside).collect();
        let outer: Vec<usize> = set.iter().copied().filter(|k| !inside(k)).collect();
        let opposite = set[0] ^ set[set.len() - 1];
        [inner, outer]
            .iter()
            .any(|pair| matches!(pair[..], [i, j] if i ^ j == opposite))
    }

    /// Mean of the points where the surface crosses the twelve edges of a cell.
    fn mean_crossing(&self, at: [usize; 3]) -> Option<Vector> {
        let (mut sum, mut count) = (Vector::ZERO, 0);
        for from in 0..8 {
            for to in [from | 1, from | 2, from | 4] {
                let (p, q) = (self.value(corner(at, from)), self.value(corner(at, to)));
                if from != to && (p < 0.0) != (q < 0.0) {
                    let (a, b) = (
                        self.position(corner(at, from)),
                        self.position(corner(at, to)),
                    );
                    sum += a.lerp(b, p / (p - q));
                    count += 1;
                }
            }
        }
        (count > 0).then(|| sum / count as Real)
    }

    /// The four cells round the edge from `at` along `axis`, counter-clockwise seen from outside,
    /// if the surface crosses that edge.
    fn cells_around_edge(&self, at: [usize; 3], axis: usize) -> Option<[usize; 4]> {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut end = at;
        end[axis] += 1;
        let [inside_at_start, inside_at_end] = [at, end].map(|p| self.value(p) < 0.0);
        if inside_at_start == inside_at_end || at[b] == 0 || at[c] == 0 {
            return None;
        }
        let cell = |db: usize, dc: usize| {
            let mut p = at;
            p[b] -= db;
            p[c] -= dc;
            self.index(p)
        };
        let facing_axis = [cell(1, 1), cell(0, 1), cell(0, 0), cell(1, 0)];
        let [p, q, r, s] = facing_axis;
        Some(if inside_at_start {
            facing_axis
        } else {
            [s, r, q, p]
        })
    }
}

/// Moves a point near the surface onto it, at most half a cell: Newton along the gradient.
fn onto_surface(field: &impl Fn(Vector) -> Real, start: Vector, cell: Real) -> Vector {
    let h = 0.01 * cell;
    let mut point = start;
    for _ in 0..3 {
        let slope = |axis: Vector| (field(point + axis * h) - field(point - axis * h)) / (2.0 * h);
        let gradient = Vector::new(slope(Vector::X), slope(Vector::Y), slope(Vector::Z));
        let step = gradient * field(point) / gradient.length_squared().max(1.0e-6);
        point = start + (point - step - start).clamp_length_max(0.5 * cell);
    }
    point
}
