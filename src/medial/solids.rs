//! Solids whose medial mesh is known: ball, capsule, torus.

use super::mesh::MedialMesh;
use super::primitive::MedialSphere;
use crate::error::MeshError;
use crate::math::{Real, Vector};

/// Most cones a torus is made of (a count): beyond this its polygon is within rounding of the
/// circle, and memory is all that grows.
const MAX_SEGMENTS: usize = 4096;

impl MedialMesh {
    /// A ball about the origin: one sphere. `radius` is a length, in the body's frame.
    ///
    /// Fails unless `radius` is positive and finite.
    pub fn ball(radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        Self::new(
            vec![MedialSphere::new(Vector::ZERO, radius)],
            vec![],
            vec![],
        )
    }

    /// A capsule: all points within `radius` of the segment from `a` to `b` (lengths, body's
    /// frame). `a == b` gives a ball.
    ///
    /// Fails unless `radius` is positive and finite, and on end points that are not finite.
    pub fn capsule(a: Vector, b: Vector, radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        if a == b {
            return Self::new(vec![MedialSphere::new(a, radius)], vec![], vec![]);
        }
        let spheres = vec![MedialSphere::new(a, radius), MedialSphere::new(b, radius)];
        Self::new(spheres, vec![[0, 1]], vec![])
    }

    /// A torus about the y-axis (the axis of parry's cylinder and cone), its centre circle in the
    /// xz-plane: `segments` cones around a regular polygon inscribed in the circle of
    /// `major_radius`, each a tube of `minor_radius` (lengths). The polygon leaves the circle by at
    /// most `major_radius · (1 − cos(π/segments))`.
    ///
    /// Fails unless both radii are positive and finite and `segments` is in 3..=4096.
    ///
    /// ```
    /// use rapier3d_medial::MedialMesh;
    /// let ring = MedialMesh::torus(1.0, 0.2, 32)?;
    /// assert_eq!(ring.primitive_count(), 32);
    /// assert!((ring.volume() - 0.79).abs() < 0.01);
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    pub fn torus(
        major_radius: Real,
        minor_radius: Real,
        segments: usize,
    ) -> Result<Self, MeshError> {
        let major_radius = positive("major_radius", major_radius)?;
        let minor_radius = positive("minor_radius", minor_radius)?;
        if !(3..=MAX_SEGMENTS).contains(&segments) {
            return Err(MeshError::Parameter {
                what: "segments",
                value: segments as f64,
                must: "from 3 to 4096",
            });
        }
        let spheres = (0..segments)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / segments as f64).sin_cos();
                let r = f64::from(major_radius);
                let center = Vector::new((r * cos) as Real, 0.0, (r * sin) as Real);
                MedialSphere::new(center, minor_radius)
            })
            .collect();
        let count = segments as u32;
        let edges = (0..count).map(|i| [i, (i + 1) % count]).collect();
        Self::new(spheres, edges, vec![])
    }
}

fn positive(what: &'static str, value: Real) -> Result<Real, MeshError> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(MeshError::Parameter {
        what,
        value: value.into(),
        must: "positive and finite",
    })
}
