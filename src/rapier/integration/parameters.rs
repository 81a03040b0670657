//! The settings of rapier that scenes of small bodies need, in one call.

use crate::error::MeshError;
use crate::math::Real;
use rapier3d::dynamics::IntegrationParameters;

/// Adds [`MedialIntegrationParameters::for_detail`] to rapier's [`IntegrationParameters`].
pub trait MedialIntegrationParameters: Sized {
    /// rapier's default parameters for a world in which `detail`, in your unit of length, is the least size that
    /// matters: the pitch of a thread, the thickness of a wall, or a few times the play between two parts that fit into
    /// each other. `detail` becomes rapier's length unit, which scales the distance from which contacts press (0.02 of
    /// it), the overlap that the solver tolerates (0.005), and the gaps at which this crate counts bodies as in
    /// contact. rapier's limit on speed stays at 400 of your units per second; if you set the length unit alone, it is
    /// 400 times `detail` per second. `contact_clustering` is off: rapier would solve contacts whose normals are up to
    /// 5° apart under one of these normals, and a thread rises by less than that. Heaps take more time for it.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless `detail` is positive and finite.
    ///
    /// ```
    /// use rapier3d::prelude::*;
    /// use rapier3d_medial::prelude::*;
    /// let mut world = PhysicsWorld::new();
    /// // Metres, and threads of millimetres.
    /// world.integration_parameters = IntegrationParameters::for_detail(0.001)?;
    /// world.integration_parameters.dt = 1.0 / 120.0;
    /// # Ok::<(), MeshError>(())
    /// ```
    fn for_detail(detail: Real) -> Result<Self, MeshError>;
}

impl MedialIntegrationParameters for IntegrationParameters {
    fn for_detail(detail: Real) -> Result<Self, MeshError> {
        if !(detail.is_finite() && detail > 0.0) {
            return Err(MeshError::Parameter {
                what: "detail",
                value: detail.into(),
                must: "positive and finite",
            });
        }
        let default = Self::default();
        let fastest = default.max_linear_velocity();
        // A cap that overflows is none.
        let normalized_max_linear_velocity = (fastest / detail).min(Real::MAX);
        Ok(Self {
            length_unit: detail,
            normalized_max_linear_velocity,
            contact_clustering: false,
            ..default
        })
    }
}
