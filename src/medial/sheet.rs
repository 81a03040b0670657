//! The surfaces that bound medial primitives, each as a grid of triangles: balls (spheres), flanks of cones, planes of
//! slabs. Each is made whole here; the parts of it that lie inside the solid are removed by `envelope`.

use super::exact::tangent_normals;
use super::mesh::MedialMesh;
use crate::math::lane::Vec3;
use crate::math::sphere::Ball;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Length of an icosahedron's edges at circumradius 1.
const ICOSAHEDRON_EDGE: f64 = 1.051_462_224_238_267_2;

/// Fewest columns around a flank (a count): fewer are no longer round at all.
const MIN_COLUMNS: f64 = 6.0;

/// Most steps along one side of a grid (a count), so that counts of triangles fit 64 bits.
const MAX_STEPS: f64 = 1e6;

/// A surface with two parameters, held as a triple: what interpolates between two points of the
/// surface when interpolated linearly.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sheet {
    /// A sphere. Parameter: a direction, of any length.
    Ball(Ball),
    /// The part of a cone's surface between its tangent circles. Parameter: weight along the edge,
    /// angle.
    Flank {
        from: Ball,
        to: Ball,
        /// Unit vector along the edge, and two across it: a right-handed frame.
        frame: [Vec3<f64>; 3],
        /// Sine and cosine of the angle between the normals of the flank and the plane across the edge.
        tilt: [f64; 2],
    },
    /// The triangle in which a plane touches three spheres. Parameter: the second and third
    /// barycentric coordinate.
    Plane {
        corners: [Vec3<f64>; 3],
        normal: Vec3<f64>,
    },
}

/// A point of a sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub point: Vec3<f64>,
    /// Outward, of length 1.
    pub normal: Vec3<f64>,
}

/// Points of a sheet as parameters, and triangles between them, counter-clockwise from outside.
pub(super) struct Grid {
    pub parameters: Vec<Vec3<f64>>,
    pub triangles: Vec<[u32; 3]>,
}

/// All sheets of a mesh with the indices of the spheres they rest on (the last one repeated).
pub(super) fn sheets(mesh: &MedialMesh) -> Vec<(Sheet, [u32; 3])> {
    let ball = |i: u32| {
        let s = mesh.spheres()[i as usize];
        Ball {
            center: Vec3::from_vector(s.center),
            radius: s.radius.into(),
        }
    };
    let mut sheets = Vec::new();
    for i in 0..mesh.spheres().len() as u32 {
        if ball(i).radius > 0.0 {
            sheets.push((Sheet::Ball(ball(i)), [i; 3]));
        }
    }
    for &[i, j] in mesh.edges() {
        if let Some(flank) = flank(ball(i), ball(j)) {
            sheets.push((flank, [i, j, j]));
        }
    }
    for &face in mesh.faces() {
        let balls = face.map(ball);
        for normal in tangent_normals(&balls).into_iter().flatten() {
            let mut corners = balls.map(|b| b.center + normal * b.radius);
            let [a, b, c] = corners;
            if (b - a).cross(c - a).dot(normal) < 0.0 {
                corners.swap(1, 2);
            }
            sheets.push((Sheet::Plane { corners, normal }, face));
        }
    }
    sheets
}

/// The flank of a cone; `None` where one sphere contains the other, and where both are points.
fn flank(from: Ball, to: Ball) -> Option<Sheet> {
    let along = to.center - from.center;
    let length = along.length();
    let sin = (from.radius - to.radius) / length;
    let cos_sq = 1.0 - sin * sin;
    if from.radius.max(to.radius) <= 0.0 || cos_sq.is_nan() || cos_sq <= 0.0 {
        return None;
    }
    let axis = along * (1.0 / length);
    let least = if axis.x.abs() <= axis.y.abs().min(axis.z.abs()) {
        Vec3::new(1.0, 0.0, 0.0)
    } else if axis.y.abs() <= axis.z.abs() {
        Vec3::new(0.0, 1.0, 0.0)
    } else {
        Vec3::new(0.0, 0.0, 1.0)
    };
    let across = axis.cross(least);
    let across = across * (1.0 / across.length());
    Some(Sheet::Flank {
        from,
        to,
        frame: [axis, across, axis.cross(across)],
        tilt: [sin, cos_sq.sqrt()],
    })
}

impl Sheet {
    /// The point at a parameter.
    pub fn spot(&self, q: Vec3<f64>) -> Spot {
        match self {
            Self::Ball(b) => {
                let normal = q * (1.0 / q.length());
                let point = b.center + normal * b.radius;
                Spot { point, normal }
            }
            Self::Flank {
                from,
                to,
                frame,
                tilt,
            } => {
                let [axis, e1, e2] = *frame;
                let (sin, cos) = q.y.sin_cos();
                let normal = axis * tilt[0] + (e1 * cos + e2 * sin) * tilt[1];
                let center = from.center + (to.center - from.center) * q.x;
                let radius = from.radius + (to.radius - from.radius) * q.x;
                let point = center + normal * radius;
                Spot { point, normal }
            }
            Self::Plane { corners, normal } => {
                let [a, b, c] = *corners;
                let point = a + (b - a) * q.x + (c - a) * q.y;
                let normal = *normal;
                Spot { point, normal }
            }
        }
    }

    /// Lowest and highest coordinates.
    pub fn bounds(&self) -> [Vec3<f64>; 2] {
        let (points, reach) = match self {
            Self::Ball(b) => (vec![b.center], b.radius),
            Self::Flank { from, to, .. } => {
                (vec![from.center, to.center], from.radius.max(to.radius))
            }
            Self::Plane { corners, .. } => (corners.to_vec(), 0.0),
        };
        let [mut lo, mut hi] = [points[0]; 2];
        for p in points {
            lo = Vec3::new(lo.x.min(p.x), lo.y.min(p.y), lo.z.min(p.z));
            hi = Vec3::new(hi.x.max(p.x), hi.y.max(p.y), hi.z.max(p.z));
        }
        let reach = Vec3::new(reach, reach, reach);
        [lo - reach, hi + reach]
    }

    /// Steps of its grid: along both directions of a flank, along a side of each face otherwise.
    fn steps(&self, spacing: f64) -> [u32; 2] {
        let count =
            |length: f64, least: f64| (length / spacing).ceil().clamp(least, MAX_STEPS) as u32;
        match self {
            Self::Ball(b) => [count(ICOSAHEDRON_EDGE * b.radius, 1.0); 2],
            Self::Flank { from, to, tilt, .. } => {
                let slant = (to.center - from.center).length() * tilt[1];
                let around = TAU * from.radius.max(to.radius) * tilt[1];
                [count(slant, 1.0), count(around, MIN_COLUMNS)]
            }
            Self::Plane {
                corners: [a, b, c], ..
            } => {
                let [a, b, c] = [*b - *a, *c - *b, *a - *c].map(|e| e.length());
                [count(a.max(b).max(c), 1.0); 2]
            }
        }
    }

    /// Number of triangles of its grid.
    pub fn size(&self, spacing: f64) -> u64 {
        let [n, m] = self.steps(spacing).map(u64::from);
        match self {
            Self::Ball(_) => 20 * n * n,
            Self::Flank { .. } => 2 * n * m,
            Self::Plane { .. } => n * n,
        }
    }

    /// The grid of the sheet, neighbouring points about `spacing` apart.
    pub fn grid(&self, spacing: f64) -> Grid {
        let [n, m] = self.steps(spacing);
        let mut grid = Grid {
            parameters: Vec::new(),
            triangles: Vec::new(),
        };
        match self {
            Self::Ball(_) => {
                let (vertices, faces) = icosahedron();
                let mut known = HashMap::new();
                for face in faces {
                    grid.add_triangle(face.map(|v| vertices[v]), n, &mut known);
                }
            }
            Self::Plane { .. } => {
                let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
                let corners = corners.map(|[x, y]| Vec3::new(x, y, 0.0));
                grid.add_triangle(corners, n, &mut HashMap::new());
            }
            Self::Flank { .. } => {
                for row in 0..=n {
                    for column in 0..m {
                        let weight = f64::from(row) / f64::from(n);
                        let angle = TAU * f64::from(column) / f64::from(m);
                        grid.parameters.push(Vec3::new(weight, angle, 0.0));
                    }
                }
                // The seam has its points twice, as an angle interpolates one way only.
                for row in 0..=n {
                    let weight = f64::from(row) / f64::from(n);
                    grid.parameters.push(Vec3::new(weight, TAU, 0.0));
                }
                let at = |row: u32, column: u32| {
                    if column < m {
                        row * m + column
                    } else {
                        (n + 1) * m + row
                    }
                };
                for row in 0..n {
                    for column in 0..m {
                        let [a, b] = [at(row, column), at(row, column + 1)];
                        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
                        grid.triangles.extend([[a, b, d], [a, d, c]]);
                    }
                }
            }
        }
        grid
    }
}

impl Grid {
    /// Adds a triangle of parameters, each side in `n` steps. `known` finds points that a
    /// neighbouring triangle added: they have the same bits, as at most two terms of the sum
    /// below are not 0 on a side.
    fn add_triangle(
        &mut self,
        [a, b, c]: [Vec3<f64>; 3],
        n: u32,
        known: &mut HashMap<[u64; 3], u32>,
    ) {
        let mut at = |i: u32, j: u32| {
            let weight = |k: u32| f64::from(k) / f64::from(n);
            let q = a * weight(n - i - j) + b * weight(i) + c * weight(j);
            // Adding 0 makes −0 equal to 0.
            let key = [q.x, q.y, q.z].map(|c| (c + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                self.parameters.push(q);
                self.parameters.len() as u32 - 1
            })
        };
        for i in 0..n {
            for j in 0..n - i {
                let [p, q, r] = [at(i, j), at(i + 1, j), at(i, j + 1)];
                self.triangles.push([p, q, r]);
                if i + j + 2 <= n {
                    self.triangles.push([q, at(i + 1, j + 1), r]);
                }
            }
        }
    }
}

/// Corners and faces, counter-clockwise from outside.
fn icosahedron() -> ([Vec3<f64>; 12], [[usize; 3]; 20]) {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let corners = [
        [-1.0, golden, 0.0],
        [1.0, golden, 0.0],
        [-1.0, -golden, 0.0],
        [1.0, -golden, 0.0],
        [0.0, -1.0, golden],
        [0.0, 1.0, golden],
        [0.0, -1.0, -golden],
        [0.0, 1.0, -golden],
        [golden, 0.0, -1.0],
        [golden, 0.0, 1.0],
        [-golden, 0.0, -1.0],
        [-golden, 0.0, 1.0],
    ];
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (corners.map(|[x, y, z]| Vec3::new(x, y, z)), faces)
}
