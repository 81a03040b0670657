//! Closed triangle meshes of what is turned on a lathe, more or less.

use rapier3d::prelude::{Real, Vector};
use std::f64::consts::TAU;

/// Vertices and triangles.
pub struct Mesh {
    pub vertices: Vec<Vector>,
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// What lies between an outer and an inner radius, which depend on angle and height, or within the outer one.
    pub fn lathe(
        heights: &[f64],
        around: usize,
        outer: impl Fn(f64, f64) -> f64,
        inner: Option<impl Fn(f64, f64) -> f64>,
    ) -> Self {
        let mut mesh = Self {
            vertices: Vec::new(),
            indices: Vec::new(),
        };
        let top = heights.len() - 1;
        mesh.wall(heights, around, outer, false);
        let walls = mesh.vertices.len();
        let ring = |row: usize, k: usize| (row * around + k % around) as u32;
        match inner {
            Some(inner) => {
                mesh.wall(heights, around, inner, true);
                let inside = |row: usize, k: usize| walls as u32 + ring(row, k);
                for k in 0..around {
                    let [a, b, c, d] = [ring(0, k), ring(0, k + 1), inside(0, k), inside(0, k + 1)];
                    mesh.indices.extend([[a, c, b], [b, c, d]]);
                    let [a, b] = [ring(top, k), ring(top, k + 1)];
                    let [c, d] = [inside(top, k), inside(top, k + 1)];
                    mesh.indices.extend([[a, b, c], [b, d, c]]);
                }
            }
            None => {
                for y in [heights[0], heights[top]] {
                    mesh.vertices.push(Vector::Y * y as Real);
                }
                let middle = walls as u32;
                for k in 0..around {
                    let [a, b] = [ring(0, k), ring(0, k + 1)];
                    mesh.indices.push([a, middle, b]);
                    let [a, b] = [ring(top, k), ring(top, k + 1)];
                    mesh.indices.push([a, b, middle + 1]);
                }
            }
        }
        mesh
    }

    fn wall(
        &mut self,
        heights: &[f64],
        around: usize,
        radius: impl Fn(f64, f64) -> f64,
        inward: bool,
    ) {
        let first = self.vertices.len();
        for &y in heights {
            for k in 0..around {
                let angle = TAU * k as f64 / around as f64;
                let (r, (sin, cos)) = (radius(angle, y), angle.sin_cos());
                let point = [r * cos, y, -r * sin].map(|c| c as Real);
                self.vertices.push(Vector::from_array(point));
            }
        }
        let at = |row: usize, k: usize| (first + row * around + k % around) as u32;
        for row in 1..heights.len() {
            for k in 0..around {
                let [a, b] = [at(row - 1, k), at(row - 1, k + 1)];
                let [c, d] = [at(row, k), at(row, k + 1)];
                let both = [[a, b, c], [b, d, c]];
                let turned = both.map(|[a, b, c]| [a, c, b]);
                self.indices.extend(if inward { turned } else { both });
            }
        }
    }
}
