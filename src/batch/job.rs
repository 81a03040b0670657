//! What a batch is asked and what it answers, whatever computes it.

use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use crate::pair::SpherePair;
use crate::pair::first_contact::Counts;

/// Asks for the sphere pairs of two meshes at fixed poses.
#[derive(Clone, Debug)]
pub struct PairJob {
    /// First mesh.
    pub mesh1: MedialMesh,
    /// Second mesh.
    pub mesh2: MedialMesh,
    /// Pose of the second in the first's frame.
    pub pos12: Pose,
    /// Sphere pairs up to this distance are wanted, a length.
    pub prediction: Real,
}

/// Answer to a [`PairJob`].
#[derive(Clone, Debug, Default)]
pub struct PairResult {
    /// Sphere pairs within the prediction.
    pub contacts: Vec<SpherePair>,
    /// Work it took.
    pub counts: Counts,
}
