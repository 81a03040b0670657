//! Primitives that met in the first contact of two bodies. With them the contact is computed again where the bodies
//! have moved and turned a little since.

use super::placement::Placement;
use crate::elementary::distance::nearest_in_test;
use crate::elementary::first_contact::corner_weights;
use crate::elementary::test_list::{ElementaryTest, OwnedFeatures, for_each_test};
use crate::math::lane::Vec3;
use crate::math::nearest::Nearest;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialSphere;

/// The two primitives that met first, with the radii that counted, so that their contact can be computed at other
/// poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// The spheres of each, in its body's frame, with the radii that counted ([`super::deepening`]).
    pub(super) spheres: [[MedialSphere; 3]; 2],
    /// Numbers of spheres.
    pub(super) counts: [usize; 2],
}

/// The contact of two primitives that met ([`Met`]), computed again at other poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Signed distance, a length.
    pub distance: Real,
    /// Unit normal from the first body to the second, world frame.
    pub normal: Vector,
    /// Middle of the nearest points, world frame.
    pub point: Vector,
}

impl Met {
    /// The primitives with the second body as the first.
    pub fn flipped(&self) -> Self {
        let ([a, b], [m, n]) = (self.spheres, self.counts);
        Self {
            spheres: [b, a],
            counts: [n, m],
        }
    }

    /// Contact of the two at two poses; `None` where the nearest two have one centre, which leaves no normal.
    pub fn touch(&self, poses: [&Pose; 2]) -> Option<Touch> {
        let place = Placement::new(&poses[0].inv_mul(poses[1]));
        let [a, b] = &self.spheres;
        let a = a.map(|s| (Vec3::from_vector(s.center), f64::from(s.radius)));
        let b = b.map(|s| (place.point(s.center), f64::from(s.radius)));
        let shares = self.counts.map(OwnedFeatures::whole);
        let mut found: Option<(ElementaryTest, Nearest<f64>)> = None;
        for_each_test(shares[0], shares[1], |test| {
            let (_, nearest) = nearest_in_test(&test, &a, &b);
            if found.is_none_or(|(_, least)| nearest.distance < least.distance) {
                found = Some((test, nearest));
            }
            true
        });
        let (test, nearest) = found.filter(|(_, n)| n.length > 0.0 && n.length.is_finite())?;
        let weights = corner_weights(test.domain, &nearest);
        let of_first = test.corners.iter().zip(weights);
        let (center, radius) = of_first.fold((Vec3::zero(), 0.0), |sum, ((i, _), weight)| {
            let (center, radius) = a[usize::from(*i)];
            (sum.0 + center * weight, sum.1 + radius * weight)
        });
        let normal = nearest.y * (1.0 / nearest.length);
        let middle = center + normal * (radius + 0.5 * nearest.distance);
        Some(Touch {
            distance: nearest.distance as Real,
            normal: poses[0].rotation * normal.to_vector(),
            point: poses[0] * middle.to_vector(),
        })
    }
}
