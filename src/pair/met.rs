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
use std::sync::Arc;

/// The primitives or faces that met first: two primitives, with the radii that counted, or faces of two convex pieces.
/// The contact can be computed again at other poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Met(Features);

#[derive(Clone, Debug, PartialEq)]
enum Features {
    /// The spheres of each, in its body's frame, with the radii that counted ([`super::deepening`]), and how many there
    /// are.
    Primitives([[MedialSphere; 3]; 2], [usize; 2]),
    Faces(Arc<FacesMet>),
}

/// Faces of two bodies that lie on each other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FacesMet {
    /// Their corners ([`Patch`](super::patch::Patch)) on both bodies, in the frames of these.
    pub(super) corners: [[Vector; EXTREMES]; 2],
    /// Unit normal from the first to the second, in the frame of the body that it is of.
    pub(super) normal: Vec3<f64>,
    /// That body, 0 or 1.
    pub(super) of: usize,
}

/// The contact of what met ([`Met`]), computed again at other poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Signed distance, a length: of faces where they are nearest.
    pub distance: Real,
    /// Unit normal from the first body to the second, world frame.
    pub normal: Vector,
    /// Middle of the nearest points, world frame.
    pub point: Vector,
    /// Corners of faces that lie on each other, those farthest in eight directions, some more than once. An impact acts
    /// in their hull, which may be off both bodies, as between the legs of a table.
    pub corners: Option<[FaceCorner; EXTREMES]>,
}

impl Met {
    /// Two primitives: so many spheres of each, in its body's frame.
    pub(super) fn primitives(spheres: [[MedialSphere; 3]; 2], counts: [usize; 2]) -> Self {
        Self(Features::Primitives(spheres, counts))
    }

    /// Faces that lie on each other.
    pub(super) fn faces(faces: FacesMet) -> Self {
        Self(Features::Faces(Arc::new(faces)))
    }

    /// Whether faces lie on each other.
    pub fn is_of_faces(&self) -> bool {
        matches!(self.0, Features::Faces(..))
    }

    /// The same contact with the second body as the first.
    pub fn flipped(&self) -> Self {
        match &self.0 {
            Features::Primitives([a, b], [m, n]) => Self::primitives([*b, *a], [*n, *m]),
            Features::Faces(faces) => {
                let [first, second] = faces.corners;
                Self::faces(FacesMet {
                    corners: [second, first],
                    normal: -faces.normal,
                    of: 1 - faces.of,
                })
            }
        }
    }

    /// Contact of the two at two poses; `None` where the nearest two spheres have one centre, which leaves no normal.
    pub fn touch(&self, poses: [&Pose; 2]) -> Option<Touch> {
        let place = Placement::new(&poses[0].inv_mul(poses[1]));
        let turn = |normal: Vec3<f64>| poses[0].rotation * normal.to_vector();
        match &self.0 {
            Features::Primitives(spheres, counts) => {
                let (distance, normal, middle) = of_primitives(*spheres, *counts, &place)?;
                Some(Touch {
                    distance: distance as Real,
                    normal: turn(normal),
                    point: poses[0] * middle.to_vector(),
                    corners: None,
                })
            }
            Features::Faces(faces) => {
                let normal = turn(match faces.of {
                    0 => faces.normal,
                    _ => place.turned(faces.normal),
                });
                let [first, second] = &faces.corners;
                let corner =
                    |k: usize| FaceCorner::of(poses[0] * first[k], poses[1] * second[k], normal);
                let corners = std::array::from_fn::<_, EXTREMES, _>(corner);
                let lowest = corners
                    .iter()
                    .min_by(|a, b| a.distance.total_cmp(&b.distance))?;
                Some(Touch {
                    distance: lowest.distance,
                    normal,
                    point: lowest.point,
                    corners: Some(corners),
                })
            }
        }
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
