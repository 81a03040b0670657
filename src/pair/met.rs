//! Primitives or faces that met in the first contact of two bodies. With them the contact is computed again where the
//! bodies have moved and turned a little since.

use super::patch::{EXTREMES, FaceCorner};
use super::placement::Placement;
use crate::elementary::distance::nearest_in_test;
use crate::elementary::first_contact::corner_weights;
use crate::elementary::test_list::{ElementaryTest, OwnedFeatures, for_each_test};
use crate::math::lane::Vec3;
use crate::math::nearest::Nearest;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialSphere;

/// The primitives or faces that met first: two primitives, with the radii that counted, or faces of two convex pieces.
/// The contact can be computed again at other poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met(Features);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Features {
    /// The spheres of each, in its body's frame, with the radii that counted ([`super::deepening`]), and how many there
    /// are.
    Primitives([[MedialSphere; 3]; 2], [usize; 2]),
    /// The middle of where faces lie on each other, and how far they do so, in each body's frame, and the normal from
    /// the first to the second in the frame of the body that it is of.
    Faces([FacesOn; 2], Vec3<f64>, usize),
}

/// Where faces of two bodies lie on each other, on one of the bodies, in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FacesOn {
    /// The middle.
    pub(super) middle: Vec3<f64>,
    /// The corners that tell how far they do so ([`Patch`](super::patch::Patch)).
    pub(super) extremes: [Vector; EXTREMES],
}

/// The contact of what met ([`Met`]), computed again at other poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Signed distance, a length.
    pub distance: Real,
    /// Unit normal from the first body to the second, world frame.
    pub normal: Vector,
    /// Middle of the nearest points, world frame.
    pub point: Vector,
    /// Corners of faces that lie on each other, as
    /// [`ToiResult::corners`](super::first_contact::ToiResult::corners) has them.
    pub corners: Option<[FaceCorner; EXTREMES]>,
}

impl Met {
    /// Two primitives: so many spheres of each, in its body's frame.
    pub(super) fn primitives(spheres: [[MedialSphere; 3]; 2], counts: [usize; 2]) -> Self {
        Self(Features::Primitives(spheres, counts))
    }

    /// Faces that lie on each other, on both bodies, and the normal from the first to the second, in the frame of the
    /// body `of`.
    pub(super) fn faces(faces: [FacesOn; 2], normal: Vec3<f64>, of: usize) -> Self {
        Self(Features::Faces(faces, normal, of))
    }

    /// The same contact with the second body as the first.
    pub fn flipped(&self) -> Self {
        Self(match self.0 {
            Features::Primitives([a, b], [m, n]) => Features::Primitives([b, a], [n, m]),
            Features::Faces([p, q], normal, of) => Features::Faces([q, p], -normal, 1 - of),
        })
    }

    /// Contact of the two at two poses; `None` where the nearest two spheres have one centre, which leaves no normal.
    pub fn touch(&self, poses: [&Pose; 2]) -> Option<Touch> {
        let place = Placement::new(&poses[0].inv_mul(poses[1]));
        let (distance, normal, middle) = match &self.0 {
            Features::Primitives(spheres, counts) => of_primitives(*spheres, *counts, &place)?,
            Features::Faces([p, q], normal, of) => {
                let normal = match of {
                    0 => *normal,
                    _ => place.turned(*normal),
                };
                let q = place.placed(q.middle);
                (normal.dot(q - p.middle), normal, (p.middle + q) * 0.5)
            }
        };
        let normal = poses[0].rotation * normal.to_vector();
        let corners = match &self.0 {
            Features::Primitives(..) => None,
            Features::Faces([first, second], ..) => Some([0, 1, 2, 3, 4, 5, 6, 7].map(|k| {
                let [p, q] = [poses[0] * first.extremes[k], poses[1] * second.extremes[k]];
                FaceCorner::of(p, q, normal)
            })),
        };
        Some(Touch {
            distance: distance as Real,
            normal,
            point: poses[0] * middle.to_vector(),
            corners,
        })
    }
}

/// Signed distance of two primitives, normal and middle of the nearest points, in the frame of the first.
fn of_primitives(
    [a, b]: [[MedialSphere; 3]; 2],
    counts: [usize; 2],
    place: &Placement,
) -> Option<(f64, Vec3<f64>, Vec3<f64>)> {
    let a = a.map(|s| (Vec3::from_vector(s.center), f64::from(s.radius)));
    let b = b.map(|s| (place.point(s.center), f64::from(s.radius)));
    let shares = counts.map(OwnedFeatures::whole);
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
    Some((nearest.distance, normal, middle))
}
