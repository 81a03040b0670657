//! Constructors of boxes, sharp or rounded, as exact medial meshes.
//!
//! The medial axis of a box of half extents `a ≥ b ≥ c` is made of flat sheets on each of which the
//! distance to the surface is linear: the rectangle `|x| ≤ a − c`, `|y| ≤ b − c` of radius `c` in the
//! middle, and one sheet for each of the box's edges, bisecting its two faces, from radius 0 at the edge
//! to radius `c` at the rectangle. A slab over three points of a sheet is the hull of three balls of the
//! box, so it stays in the box; together the slabs hold all medial balls, which are the box. Rounding
//! adds the border radius to every ball, and to the box by Minkowski's sum: nothing else changes.

use super::mesh::MedialMesh;
use super::solids::{not_negative, positive};
use super::sphere::MedialSphere;
use crate::error::MeshError;
use crate::math::{Real, Vector};

impl MedialMesh {
    /// A box with sharp edges around the origin of the body's frame. It is exact up to the rounding of its
    /// numbers, and takes 22 slabs, or 12 for a cube.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless all half extents are positive and finite.
    ///
    /// ```
    /// use rapier3d_medial::{MedialMesh, math::Vector};
    /// let block = MedialMesh::cuboid(Vector::new(0.5, 0.2, 0.3))?;
    /// assert!((block.volume() - 0.24).abs() < 1e-4);
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    pub fn cuboid(half_extents: Vector) -> Result<Self, MeshError> {
        let [x, y, z] = NAMES;
        positive(x, half_extents.x)?;
        positive(y, half_extents.y)?;
        positive(z, half_extents.z)?;
        round_box(half_extents, 0.0)
    }

    /// All points within `border_radius` of a box around the origin of the body's frame: parry's round
    /// cuboid, as exact as [`Self::cuboid`]. One half extent of 0 gives a rounded plate, two a capsule,
    /// three a ball.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless all half extents are at least 0, `border_radius` is positive, and all
    /// are finite.
    pub fn round_cuboid(half_extents: Vector, border_radius: Real) -> Result<Self, MeshError> {
        let [x, y, z] = NAMES;
        not_negative(x, half_extents.x)?;
        not_negative(y, half_extents.y)?;
        not_negative(z, half_extents.z)?;
        round_box(half_extents, positive("border_radius", border_radius)?)
    }

    /// A plate with a round rim: all points within `radius` of the rectangle `|x| ≤ half_x`,
    /// `|z| ≤ half_z` in the xz-plane of the body's frame. Exact: two slabs.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless all three are positive and finite.
    pub fn round_plate(half_x: Real, half_z: Real, radius: Real) -> Result<Self, MeshError> {
        let half_x = positive("half_x", half_x)?;
        let half_z = positive("half_z", half_z)?;
        let radius = positive("radius", radius)?;
        round_box(Vector::new(half_x, 0.0, half_z), radius)
    }
}

/// Names of the half extents, for errors.
const NAMES: [&str; 3] = ["half_extents.x", "half_extents.y", "half_extents.z"];

fn round_box(half_extents: Vector, border: Real) -> Result<MedialMesh, MeshError> {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&i, &j| half_extents[j].total_cmp(&half_extents[i]));
    let [a, b, c] = axes.map(|i| half_extents[i]);
    let at = |x: Real, y: Real, z: Real, radius: Real| {
        let mut center = Vector::ZERO;
        for (axis, value) in axes.into_iter().zip([x, y, z]) {
            center[axis] = value;
        }
        MedialSphere::new(center, radius + border)
    };
    let corner = |x: Real, y: Real, z: Real| at(x * a, y * b, z * c, 0.0);
    let inner = |x: Real, y: Real| at(x * (a - c), y * (b - c), 0.0, c);
    let mut sheets = Sheets::default();
    sheets.add(&[
        inner(1.0, 1.0),
        inner(-1.0, 1.0),
        inner(-1.0, -1.0),
        inner(1.0, -1.0),
    ]);
    for s in [1.0, -1.0] {
        for t in [1.0, -1.0] {
            sheets.add(&[
                corner(s, 1.0, t),
                corner(s, -1.0, t),
                inner(s, -1.0),
                inner(s, 1.0),
            ]);
            sheets.add(&[
                corner(1.0, s, t),
                corner(-1.0, s, t),
                inner(-1.0, s),
                inner(1.0, s),
            ]);
            sheets.add(&[corner(s, t, 1.0), corner(s, t, -1.0), inner(s, t)]);
        }
    }
    let mesh = MedialMesh::new(sheets.spheres, sheets.edges, sheets.faces)?;
    Ok(mesh.of_convex_pieces(true))
}

/// Spheres, each once, and the polygons over them.
#[derive(Default)]
struct Sheets {
    spheres: Vec<MedialSphere>,
    edges: Vec<[u32; 2]>,
    faces: Vec<[u32; 3]>,
}

impl Sheets {
    /// Adds a convex polygon; corners that coincide count once, and two are an edge.
    fn add(&mut self, polygon: &[MedialSphere]) {
        let mut indices: Vec<u32> = Vec::new();
        for s in polygon {
            let known = self.spheres.iter().position(|t| t.center == s.center);
            let index = known.unwrap_or(self.spheres.len()) as u32;
            if known.is_none() {
                self.spheres.push(*s);
            }
            if !indices.contains(&index) {
                indices.push(index);
            }
        }
        if let [a, b] = indices[..] {
            self.edges.push([a, b]);
        }
        for k in 2..indices.len() {
            self.faces.push([indices[0], indices[k - 1], indices[k]]);
        }
    }
}
