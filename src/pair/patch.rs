//! Where flat faces of two bodies lie on each other: one polygon for each pair of pieces, of which a plane of several
//! triangles, or a body of several blocks, has many. An impact there acts on all of them together, so that a plate that
//! falls flat on one of two triangles and half on the other is struck as on one.

use crate::math::lane::Vec3;
use crate::math::{Real, Vector};

/// Number of points that tell how far a patch reaches.
pub const EXTREMES: usize = 8;

/// Directions in the plane of a patch, in units of two axes there, in which it is known how far it reaches.
const DIRECTIONS: [[f64; 2]; EXTREMES] = [
    [5.0, 2.0],
    [2.0, 5.0],
    [-2.0, 5.0],
    [-5.0, 2.0],
    [-5.0, -2.0],
    [-2.0, -5.0],
    [2.0, -5.0],
    [5.0, -2.0],
];

/// How much less far a corner counts to lie, in units of how far apart the faces are there: more than faces differ that
/// are as little tilted as those that lie on each other may be. Else a corner would be hidden by one right above it.
const STEEPNESS: f64 = 5.0;

/// A corner of faces that lie on each other, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceCorner {
    /// Middle of where it is on both bodies.
    pub point: Vector,
    /// Distance of the faces there, a length.
    pub distance: Real,
}

impl FaceCorner {
    /// A corner on both bodies; the normal is from the first to the second.
    pub(super) fn of(on_first: Vector, on_second: Vector, normal: Vector) -> Self {
        Self {
            point: (on_first + on_second) * 0.5,
            distance: (on_second - on_first).dot(normal),
        }
    }
}

/// Corners of faces that lie on each other, each once, with the speed of approach that is left to it where a step takes
/// `dt` seconds: those above the lowest may come down to where it is.
pub fn with_room(corners: &[FaceCorner], dt: Real) -> Vec<(FaceCorner, Real)> {
    let mut once: Vec<FaceCorner> = Vec::new();
    for corner in corners {
        if !once.contains(corner) {
            once.push(*corner);
        }
    }
    let lowest = once.iter().map(|c| c.distance).fold(Real::MAX, Real::min);
    let room = |c: FaceCorner| (c, (c.distance - lowest) / dt);
    once.into_iter().map(room).collect()
}

/// Polygons, edges and corners that lie on each other, with their moments.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    normal: Vec3<f64>,
    /// Two unit vectors across its normal and each other.
    axes: [Vec3<f64>; 2],
    /// The corners that lie farthest in [`DIRECTIONS`], each on both bodies.
    extremes: [[Vec3<f64>; 2]; EXTREMES],
    /// Middle of the first polygon, or of the edge or the corner that it is.
    pub(super) middle: Vec3<f64>,
}

impl Patch {
    /// One polygon across a unit normal, each corner of it on both bodies; two corners are an edge, one is itself.
    /// `None` where there are none.
    pub(super) fn of(pairs: &[[Vec3<f64>; 2]], normal: Vec3<f64>) -> Option<Self> {
        let lone = Self {
            normal,
            axes: across(normal),
            extremes: [*pairs.first()?; EXTREMES],
            middle: middle_of(pairs)?,
        };
        let all = pairs.iter();
        Some(all.fold(lone, |patch, p| patch.reaching(&[*p; EXTREMES])))
    }

    /// The patch, if it reaches as far as these corners in [`DIRECTIONS`].
    fn reaching(mut self, corners: &[[Vec3<f64>; 2]; EXTREMES]) -> Self {
        for ((farthest, corner), [x, y]) in self.extremes.iter_mut().zip(corners).zip(DIRECTIONS) {
            let direction = self.axes[0] * x + self.axes[1] * y;
            let lower = self.normal * (STEEPNESS * direction.length());
            let reach =
                |[p, q]: &[Vec3<f64>; 2]| middle(&[*p, *q]).dot(direction) - (*q - *p).dot(lower);
            if reach(corner) > reach(farthest) {
                *farthest = *corner;
            }
        }
        self
    }

    /// The two patches as one. Both are across the same normal.
    pub(super) fn and(self, other: &Self) -> Self {
        self.reaching(&other.extremes)
    }

    /// Corners, each on both bodies, of which the hull is about that of the patch; some of them more than once.
    pub(super) fn extremes(&self) -> [[Vec3<f64>; 2]; EXTREMES] {
        self.extremes
    }
}

/// Middle of a polygon, or of the edge or the corner that it is.
fn middle_of(pairs: &[[Vec3<f64>; 2]]) -> Option<Vec3<f64>> {
    let corners: Vec<Vec3<f64>> = pairs.iter().map(middle).collect();
    let first = *corners.first()?;
    // Number of corners, length of edges, and area, and the integral of the position over each.
    let mut measures = [(0.0, Vec3::zero()); 3];
    let mut add = |k: usize, measure: f64, middle: Vec3<f64>| {
        measures[k].0 += measure;
        measures[k].1 = measures[k].1 + middle * measure;
    };
    for (k, p) in corners.iter().enumerate() {
        let next = corners[(k + 1) % corners.len()];
        add(0, 1.0, *p);
        add(1, (next - *p).length(), (*p + next) * 0.5);
        let area = 0.5 * (*p - first).cross(next - first).length();
        add(2, area, (first + *p + next) * (1.0 / 3.0));
    }
    let (measure, moment) = measures
        .into_iter()
        .rev()
        .find(|(measure, _)| *measure > 0.0)?;
    Some(moment * (1.0 / measure))
}

/// Two unit vectors across a unit vector and each other.
fn across(n: Vec3<f64>) -> [Vec3<f64>; 2] {
    let (u, v) = n.to_vector().any_orthonormal_pair();
    [u, v].map(Vec3::from_vector)
}

fn middle([p, q]: &[Vec3<f64>; 2]) -> Vec3<f64> {
    (*p + *q) * 0.5
}
