//! Constructors of flat shapes with a round rim: triangles and polygons thickened by one radius, as exact medial
//! meshes.
//!
//! The polygon is cut into triangles by ear clipping (Meisters, "Polygons have ears", 1975), each a slab:
//! the union of all balls of one radius about its points. Orientations are computed in `f64` from `f32`
//! coordinates.

use super::mesh::MedialMesh;
use super::solids::positive;
use super::sphere::MedialSphere;
use crate::error::MeshError;
use crate::math::{Real, Vector};

/// Most corners of a polygon (a count): clipping takes up to its cube; a comb of 4,096 is cut in 0.1 s.
/// An outline of more wants [`MedialMesh::from_trimesh`].
const MAX_CORNERS: usize = 4096;

type Point = [f64; 2];

impl MedialMesh {
    /// All points within `radius` of a triangle, in the body's frame: parry's round triangle. Exact: one slab.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless `radius` is positive and finite, [`MeshError::NotFinite`] if a corner is
    /// not finite.
    pub fn round_triangle(
        a: Vector,
        b: Vector,
        c: Vector,
        radius: Real,
    ) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        let spheres = [a, b, c].map(|p| MedialSphere::new(p, radius)).to_vec();
        Self::new(spheres, vec![], vec![[0, 1, 2]])
    }

    /// All points within `radius` of a polygon in the xz-plane of the body's frame, which may be concave. Its
    /// corners `[x, z]` are listed in order, clockwise or not. Exact: `n − 2` slabs for `n` corners.
    ///
    /// # Errors
    /// - [`MeshError::Parameter`] unless `radius` is positive and finite and there are 3 to 4096 corners.
    /// - [`MeshError::NotFinite`] if a corner is not finite.
    /// - [`MeshError::PolygonEdgesMeet`] if two edges cross or touch, or one folds back onto its neighbour.
    pub fn round_polygon(corners: &[[Real; 2]], radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        if !(3..=MAX_CORNERS).contains(&corners.len()) {
            return Err(MeshError::Parameter {
                what: "the number of corners",
                value: corners.len() as f64,
                must: "from 3 to 4096",
            });
        }
        let sphere = |&[x, z]: &[Real; 2]| MedialSphere::new(Vector::new(x, 0.0, z), radius);
        let spheres: Vec<_> = corners.iter().map(sphere).collect();
        if let Some(index) = spheres.iter().position(|s| !s.center.is_finite()) {
            return Err(MeshError::NotFinite {
                index,
                center: spheres[index].center.into(),
                radius,
            });
        }
        let points: Vec<Point> = corners.iter().map(|c| c.map(f64::from)).collect();
        if let Some([edge, other]) = meeting_edges(&points) {
            return Err(MeshError::PolygonEdgesMeet { edge, other });
        }
        Self::new(spheres, vec![], ears(&points))
    }
}

/// Twice the signed area of a triangle.
fn turn([a, b, c]: [Point; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Two edges (by their first corner) that share more than they should.
fn meeting_edges(points: &[Point]) -> Option<[usize; 2]> {
    let n = points.len();
    let edge = |i: usize| [points[i], points[(i + 1) % n]];
    let folds = |&i: &usize| {
        let ([a, b], [_, c]) = (edge(i), edge((i + 1) % n));
        let ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        a == b || (turn([a, b, c]) == 0.0 && ahead < 0.0)
    };
    if let Some(i) = (0..n).find(folds) {
        return Some([i, (i + 1) % n]);
    }
    (0..n).find_map(|i| {
        // Neighbours share a corner; the last edge is the first one's.
        let last = if i == 0 { n - 1 } else { n };
        let other = (i + 2..last).find(|&j| touch(edge(i), edge(j)));
        other.map(|j| [i, j])
    })
}

/// Whether two segments have a point in common.
fn touch([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let sides = |p: Point, q: Point, r: Point, s: Point| {
        let (x, y) = (turn([p, q, r]), turn([p, q, s]));
        (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0)
    };
    let apart = (0..2).any(|k| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]));
    !apart && !sides(a, b, c, d) && !sides(c, d, a, b)
}

/// Triangles of a simple polygon.
fn ears(points: &[Point]) -> Vec<[u32; 3]> {
    let area: f64 = (0..points.len())
        .map(|i| turn([points[0], points[i], points[(i + 1) % points.len()]]))
        .sum();
    let mut left: Vec<usize> = (0..points.len()).collect();
    if area < 0.0 {
        left.reverse();
    }
    let mut faces = Vec::with_capacity(points.len() - 2);
    while left.len() > 3 {
        let n = left.len();
        let corner = |k: usize| [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
        let is_ear = |k: &usize| {
            let ear = corner(*k);
            let triangle = ear.map(|i| points[i]);
            let [a, b, c] = triangle;
            let inside = |p: Point| {
                turn([a, b, p]) >= 0.0 && turn([b, c, p]) >= 0.0 && turn([c, a, p]) >= 0.0
            };
            turn(triangle) > 0.0 && !left.iter().any(|i| !ear.contains(i) && inside(points[*i]))
        };
        // A simple polygon has an ear. Where rounding hides it, the largest triangle serves.
        let size = |k: &usize| turn(corner(*k).map(|i| points[i]));
        let largest = || (0..n).max_by(|j, k| size(j).total_cmp(&size(k)));
        let ear = (0..n).find(is_ear).or_else(largest).unwrap_or(0);
        faces.push(corner(ear).map(|i| i as u32));
        left.remove(ear);
    }
    faces.push([left[0], left[1], left[2]].map(|i| i as u32));
    faces
}
