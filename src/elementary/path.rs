//! The motion of an elementary test over the step, on straight paths (paper Eq. 1) or in exact rigid motion. It is
//! known by four *corners*: the vectors from a sphere's centre of the first primitive to one of the second.

use super::test_list::ElementaryTest;
use crate::math::lane::{Lane, Scalar, Vec3};
use crate::math::motion::{PointPath, RigidMotion};

/// State of the four corners at one time: `y`, and its derivatives per step.
#[derive(Clone, Copy, Debug)]
pub struct Corners<L> {
    /// Difference of centres, second minus first.
    pub y: [Vec3<L>; 4],
    /// First derivative.
    pub rate: [Vec3<L>; 4],
    /// Second derivative; zero on straight paths.
    pub acceleration: [Vec3<L>; 4],
}

/// Motion of the corners of one elementary test over the step `[0, 1]`.
pub trait Path<L: Lane> {
    /// Whether corners accelerate at all.
    const CURVED: bool;
    /// State at time `t`.
    fn at(&self, t: L) -> Corners<L>;
    /// Radius sums of the corners, plus the target distance.
    fn radius(&self) -> &[L; 4];
    /// Bound of `|rate|` over all corners and times.
    fn speed(&self) -> L;
    /// Bounds of the lengths of acceleration and jerk of a corner over all times.
    fn curvature(&self, corner: usize) -> (L, L);
    /// Bound of the numbers whose rounding enters a bound of the distance, for the rounding slack.
    fn scale(&self) -> L;
}

/// Straight paths: `y(t) = start + t · rate`.
#[derive(Clone, Copy, Debug)]
pub struct LinearPath<L> {
    /// Corners at the start.
    pub start: [Vec3<L>; 4],
    /// Displacement of the corners over the step, a length.
    pub rate: [Vec3<L>; 4],
    /// Radius sums.
    pub radius: [L; 4],
    /// Size of a number that is in the radius sums and may cancel there: the target distance.
    pub size: L,
}

impl<L: Lane> LinearPath<L> {
    /// `sphere` gives centre, displacement and radius of sphere `i` of the first (`false`) or the second
    /// (`true`) primitive. Centres in world space: each corner is one difference, rounded once to a
    /// number of its own size, however far both are from the origin.
    #[inline]
    pub fn new(
        test: &ElementaryTest,
        target_distance: L,
        sphere: impl Fn(bool, u8) -> (Vec3<L>, Vec3<L>, L),
    ) -> Self {
        let corner = test.corners.map(|(i, j)| {
            let (a, b) = (sphere(false, i), sphere(true, j));
            (b.0 - a.0, b.1 - a.1, a.2 + b.2 + target_distance)
        });
        Self {
            start: corner.map(|c| c.0),
            rate: corner.map(|c| c.1),
            radius: corner.map(|c| c.2),
            size: target_distance.abs(),
        }
    }
}

impl<L: Lane> Path<L> for LinearPath<L> {
    const CURVED: bool = false;

    #[inline(always)]
    fn at(&self, t: L) -> Corners<L> {
        let mut y = self.start;
        for (y, rate) in y.iter_mut().zip(&self.rate) {
            *y = *y + *rate * t;
        }
        Corners {
            y,
            rate: self.rate,
            acceleration: [Vec3::zero(); 4],
        }
    }
    #[inline(always)]
    fn radius(&self) -> &[L; 4] {
        &self.radius
    }
    #[inline(always)]
    fn speed(&self) -> L {
        let mut sq = L::zero();
        for rate in &self.rate {
            sq = sq.max(rate.length_sq());
        }
        sq.sqrt()
    }
    #[inline(always)]
    fn curvature(&self, _corner: usize) -> (L, L) {
        (L::zero(), L::zero())
    }
    #[inline(always)]
    fn scale(&self) -> L {
        let (mut sq, mut radius) = (L::zero(), L::zero());
        for k in 0..4 {
            let end = self.start[k] + self.rate[k];
            sq = sq.max(self.start[k].length_sq()).max(end.length_sq());
            radius = radius.max(self.radius[k].abs());
        }
        sq.sqrt() + radius + self.size
    }
}

/// Rigid motion of both primitives.
#[derive(Clone, Copy, Debug)]
pub struct RigidPath<S> {
    motions: [RigidMotion<S>; 2],
    corners: [[PointPath<S>; 2]; 4],
    radius: [S; 4],
    /// Bound on the size of the numbers, as [`LinearPath::size`].
    size: S,
}

impl<S: Scalar> RigidPath<S> {
    /// `sphere` gives centre (body frame) and radius of sphere `i` of the first (`false`) or the
    /// second (`true`) primitive.
    #[inline]
    pub fn new(
        test: &ElementaryTest,
        motions: &[RigidMotion<S>; 2],
        target_distance: S,
        sphere: impl Fn(bool, u8) -> (Vec3<S>, S),
    ) -> Self {
        let corner = test.corners.map(|(i, j)| {
            let (a, b) = (sphere(false, i), sphere(true, j));
            (
                [motions[0].point(a.0), motions[1].point(b.0)],
                a.1 + b.1 + target_distance,
            )
        });
        Self {
            motions: *motions,
            corners: corner.map(|c| c.0),
            radius: corner.map(|c| c.1),
            size: target_distance.abs(),
        }
    }
}

impl<S: Scalar> Path<S> for RigidPath<S> {
    const CURVED: bool = true;

    #[inline]
    fn at(&self, t: S) -> Corners<S> {
        let turned = [self.motions[0].sin_cos(t), self.motions[1].sin_cos(t)];
        let state = self
            .corners
            .map(|[a, b]| (a.at(t, turned[0]), b.at(t, turned[1])));
        Corners {
            y: state.map(|(a, b)| b.position - a.position),
            rate: state.map(|(a, b)| b.velocity - a.velocity),
            acceleration: state.map(|(a, b)| b.acceleration - a.acceleration),
        }
    }
    #[inline(always)]
    fn radius(&self) -> &[S; 4] {
        &self.radius
    }
    fn speed(&self) -> S {
        self.corners
            .iter()
            .map(|[a, b]| a.speed_with(b))
            .fold(S::zero(), S::max)
    }
    #[inline(always)]
    fn curvature(&self, corner: usize) -> (S, S) {
        let [a, b] = &self.corners[corner];
        (a.acceleration + b.acceleration, a.jerk + b.jerk)
    }
    /// Positions are sums of what [`PointPath::terms`] counts and of the displacement, each rounded a few
    /// times; where a body is far from its own origin they cancel, and their rounding is left.
    fn scale(&self) -> S {
        let radius = self.radius.iter().map(|r| r.abs()).fold(S::zero(), S::max);
        let terms = self.corners.iter().map(|[a, b]| a.terms() + b.terms());
        terms.fold(S::zero(), S::max) + self.speed() + radius + self.size
    }
}
