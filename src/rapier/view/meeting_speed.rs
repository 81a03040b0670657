//! How fast two colliders move against each other where they may meet: what decides whether rapier's solver gets them.
//! Parts of medial meshes are looked at one by one in [`crate::rapier::impacts::fast_parts`].

use crate::math::{Real, Vector};
use crate::rapier::view::step_view::StepView;
use parry3d::bounding_volume::BoundingVolume;

impl StepView {
    /// Bound on how fast the surfaces of two colliders move against each other, a length per second, in all places where
    /// they may come within `margin` from `time` to `end`; 0 if they do not.
    ///
    /// While two rigid bodies overlap, their penetration depth grows no faster than they move against each other in any
    /// point of the line between their nearest spheres, of which one lies in both bodies, so in the boxes that both sweep.
    /// The relative velocity `v1 + ω1 × (x − c1) − v2 − ω2 × (x − c2)` is affine in the place `x` and the time, as the
    /// centres `c` move straight, so it is largest in a corner of the common box, at the first or the last moment.
    pub fn meeting_speed(&self, pair: [usize; 2], [time, end]: [Real; 2], margin: Real) -> Real {
        let swept = |k: usize| {
            let aabb = self.swept_aabb(k, time, end);
            aabb.loosened(margin + self.parts[k].skin)
        };
        let Some(common) = swept(pair[0]).intersection(&swept(pair[1])) else {
            return 0.0;
        };
        let motions = pair.map(|k| self.motion(k, time));
        let moments = [0.0, end - time].map(|seconds| {
            motions.each_ref().map(|m| {
                let center = m.start * m.local_center + m.linvel * seconds;
                (center, m.linvel, m.angvel)
            })
        });
        let corners = common.vertices();
        let speeds = corners.iter().flat_map(|x| {
            let at = |(center, linvel, angvel): (Vector, Vector, Vector)| {
                linvel + angvel.cross(*x - center)
            };
            moments.map(|[a, b]| (at(a) - at(b)).length())
        });
        // Rounding: a few ulps.
        speeds.fold(0.0, Real::max) * (1.0 + 16.0 * Real::EPSILON)
    }
}
