//! Constructors of round solids whose medial mesh is known and needs no build: ball, capsule, torus, tubes,
//! and frames of round bars.

use super::mesh::MedialMesh;
use super::sphere::MedialSphere;
use crate::error::MeshError;
use crate::math::{Real, Vector};

/// Most cones a torus is made of (a count): beyond this its polygon is within rounding of the
/// circle, and memory is all that grows.
const MAX_SEGMENTS: usize = 4096;

impl MedialMesh {
    /// A ball around the origin of the body's frame: one sphere.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless `radius` is positive and finite.
    pub fn ball(radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        Self::new(
            vec![MedialSphere::new(Vector::ZERO, radius)],
            vec![],
            vec![],
        )
    }

    /// A capsule: all points within `radius` of the segment from `a` to `b`, in the body's frame. One
    /// cone, or a ball if `a == b`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless `radius` is positive and finite, [`MeshError::NotFinite`] if an end
    /// point is not finite.
    pub fn capsule(a: Vector, b: Vector, radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        if a == b {
            return Self::new(vec![MedialSphere::new(a, radius)], vec![], vec![]);
        }
        let spheres = vec![MedialSphere::new(a, radius), MedialSphere::new(b, radius)];
        Self::new(spheres, vec![[0, 1]], vec![])
    }

    /// A ring around the y-axis (the axis of parry's cylinder and cone): a tube of `minor_radius` whose
    /// middle line is a circle of `major_radius` in the xz-plane. The circle is replaced by a regular polygon
    /// of `segments` corners on it, each side of which is one cone; between corners the polygon is off the
    /// circle by at most `major_radius · (1 − cos(π/segments))`.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless both radii are positive and finite and `segments` is from 3 to 4096.
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

    /// A tube through a list of spheres, in the body's frame: a cone from each sphere to the next, and from the
    /// last to the first if the tube is `closed`. Its bends are round. A radius of 0 makes a pointed
    /// tip.
    ///
    /// # Errors
    /// [`MeshError`] if the list is empty, if a closed tube has fewer than three spheres, and for bad spheres as
    /// [`MedialMesh::new`].
    ///
    /// ```
    /// use rapier3d_medial::{MedialMesh, MedialSphere, math::Vector};
    /// let at = |x, y, r| MedialSphere::new(Vector::new(x, y, 0.0), r);
    /// let hook = MedialMesh::tube(&[at(0.0, 1.0, 0.1), at(0.0, 0.0, 0.1), at(0.4, 0.0, 0.02)], false)?;
    /// assert_eq!(hook.primitive_count(), 2);
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    pub fn tube(spheres: &[MedialSphere], closed: bool) -> Result<Self, MeshError> {
        if closed && spheres.len() < 3 {
            return Err(MeshError::Parameter {
                what: "the number of spheres of a closed tube",
                value: spheres.len() as f64,
                must: "at least 3",
            });
        }
        let count = spheres.len() as u32;
        let open = (1..count).map(|i| [i - 1, i]);
        let edges = open.chain(closed.then(|| [count - 1, 0])).collect();
        Self::new(spheres.to_vec(), edges, vec![])
    }

    /// A rectangular frame, like that of a picture, with its hole along the y-axis: all points within
    /// `radius` of the outline of the rectangle `|x| ≤ half_x`, `|z| ≤ half_z` in the xz-plane, in the body's
    /// frame. Four cones; the corners are round.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless all three are positive and finite, and `radius` is less than both half
    /// lengths (else there would be no hole).
    pub fn rectangle_frame(half_x: Real, half_z: Real, radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        let half_x = wider("half_x", half_x, radius)?;
        let half_z = wider("half_z", half_z, radius)?;
        let at = |x: Real, z: Real| MedialSphere::new(Vector::new(x, 0.0, z), radius);
        let corners = [
            at(-half_x, -half_z),
            at(half_x, -half_z),
            at(half_x, half_z),
            at(-half_x, half_z),
        ];
        Self::tube(&corners, true)
    }

    /// The frame of a box, like that of a crate or a cage: all points within `radius` of an edge of the box of
    /// `half_extents` around the origin of the body's frame. Twelve cones.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless all numbers are positive and finite, and `radius` is less than all half
    /// extents.
    pub fn box_frame(half_extents: Vector, radius: Real) -> Result<Self, MeshError> {
        let radius = positive("radius", radius)?;
        let h = Vector::new(
            wider("half_extents.x", half_extents.x, radius)?,
            wider("half_extents.y", half_extents.y, radius)?,
            wider("half_extents.z", half_extents.z, radius)?,
        );
        // Bit `k` of a corner is its side along axis `k`; an edge flips one bit.
        let side = |i: u32, bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let corner =
            |i| MedialSphere::new(h * Vector::new(side(i, 0), side(i, 1), side(i, 2)), radius);
        let edges = (0..8).flat_map(|i| (0..3).map(move |bit| [i, i | 1 << bit]));
        Self::new(
            (0..8).map(corner).collect(),
            edges.filter(|[i, j]| i != j).collect(),
            vec![],
        )
    }
}

pub(super) fn positive(what: &'static str, value: Real) -> Result<Real, MeshError> {
    checked(what, value, value > 0.0, "positive and finite")
}

pub(super) fn not_negative(what: &'static str, value: Real) -> Result<Real, MeshError> {
    checked(what, value, value >= 0.0, "at least 0 and finite")
}

fn wider(what: &'static str, value: Real, radius: Real) -> Result<Real, MeshError> {
    checked(what, value, value > radius, "above the radius and finite")
}

fn checked(
    what: &'static str,
    value: Real,
    good: bool,
    must: &'static str,
) -> Result<Real, MeshError> {
    if good && value.is_finite() {
        return Ok(value);
    }
    let value = value.into();
    Err(MeshError::Parameter { what, value, must })
}
