//! Medial meshes scaled by one factor along all axes, mirrored axes included, with their mass properties.

use super::mesh::MedialMesh;
use super::sphere::MedialSphere;
use crate::math::{Real, Rotation, Vector};
use parry3d::mass_properties::MassProperties;

/// Relative difference of scale factors that still counts as uniform: rounding of a product.
const UNIFORM: Real = 4.0 * Real::EPSILON;

/// The factor of a uniform scaling (mirrored axes included); `None` if it is not uniform.
pub fn uniform_factor(scale: Vector) -> Option<Real> {
    let s = scale.abs();
    let factor = s.x;
    let near = |other: Real| (other - factor).abs() <= UNIFORM * factor;
    (factor.is_finite() && factor > 0.0 && near(s.y) && near(s.z)).then_some(factor)
}

impl MedialMesh {
    /// The mesh scaled about the origin by the same factor along all axes; an axis may also be mirrored (a negative
    /// number). If it has the mass properties of a triangle mesh, they are scaled too; if `f32` cannot hold them, the
    /// result has those of its spheres, cones and slabs. `None` for all other scalings, which would turn spheres into
    /// ellipsoids, and for a result that [`MedialMesh::new`] refuses.
    ///
    /// ```
    /// use rapier3d::math::Vector;
    /// use rapier3d_medial::MedialMesh;
    /// let ring = MedialMesh::torus(0.5, 0.1, 16)?;
    /// let large = ring.scaled(Vector::splat(2.0)).ok_or("a uniform scaling")?;
    /// assert!((large.volume() / ring.volume() - 8.0).abs() < 1.0e-3);
    /// assert!(ring.scaled(Vector::new(1.0, 2.0, 1.0)).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scaled(&self, scale: Vector) -> Option<Self> {
        let factor = uniform_factor(scale)?;
        let sphere = |s: &MedialSphere| MedialSphere::new(s.center * scale, s.radius * factor);
        let spheres = self.spheres().iter().map(sphere).collect();
        let mesh = Self::new(spheres, self.edges().to_vec(), self.faces().to_vec()).ok()?;
        let mesh = mesh.of_convex_pieces(self.parts().is_of_convex_pieces);
        let source = self.parts().source_mass.as_ref();
        Some(
            match source.and_then(|mass| scaled_mass(mass, scale, factor)) {
                Some(mass) => mesh.with_mass_properties(mass),
                None => mesh,
            },
        )
    }
}

/// Mass properties at the same density: masses grow by the third power of the factor, inertia by the fifth. Mirroring
/// all three axes changes no inertia, so one that is mirrored alone is a half turn about it. `None` where `f32` cannot
/// hold them.
fn scaled_mass(mass: &MassProperties, scale: Vector, factor: Real) -> Option<MassProperties> {
    let power = |n: i32| f64::from(factor).powi(n);
    let divided = |x: Real, by: f64| (f64::from(x) / by) as Real;
    let signs = scale.signum();
    let even = signs * signs.element_product();
    let turn = match even.to_array().map(|s| s > 0.0) {
        [true, false, false] => Rotation::from_xyzw(1.0, 0.0, 0.0, 0.0),
        [false, true, false] => Rotation::from_xyzw(0.0, 1.0, 0.0, 0.0),
        [false, false, true] => Rotation::from_xyzw(0.0, 0.0, 1.0, 0.0),
        _ => Rotation::IDENTITY,
    };
    let scaled = MassProperties {
        local_com: mass.local_com * scale,
        inv_mass: divided(mass.inv_mass, power(3)),
        inv_principal_inertia: mass.inv_principal_inertia.map(|x| divided(x, power(5))),
        principal_inertia_local_frame: turn * mass.principal_inertia_local_frame,
    };
    let numbers = |m: &MassProperties| m.inv_principal_inertia.extend(m.inv_mass).to_array();
    let held = |(old, new): (Real, Real)| new.is_normal() || old == 0.0;
    let all_held = numbers(mass).into_iter().zip(numbers(&scaled)).all(held);
    all_held.then_some(scaled)
}
