//! Distance of a medial primitive to a cylinder or cone, plain or rounded: which of its interpolated spheres is
//! nearest, and a lower bound that holds for all of them.
//!
//! Such a body `K` is symmetric about an axis, so the problem is two-dimensional: its profile in the
//! half plane of the height `y` along the axis and the radius `ρ` around it is a rectangle or a
//! triangle. The border radius of a rounded one is added to the spheres instead. With `d(c)` the distance of a
//! point to `K` (0 inside), the signed distance of a primitive is, as in paper Eq. (2),
//! ```text
//! D = min over (α, β) of  d(c(α, β)) − r(α, β)
//! ```
//! a convex function (distance to a convex set, minus an affine one), minimised by nested searches
//! for the zero of a monotone slope.
//!
//! # The bound
//! `d(c) = max over |m| ≤ 1 of m·c − h(m)` with `h` the support function of `K`. So for *any* `m` in
//! the unit ball, however it was found,
//! ```text
//! D ≥ min over the corners i of (m·cᵢ − rᵢ) − h(m)
//! ```
//! since the right side is affine in `(α, β)`. At the minimum the gradient of `d` gives equality;
//! at a kink, where the axis enters `K`, a mean of the two gradients beside it does. The search only
//! decides how sharp the bound is, never whether it holds.

use crate::math::lane::Vec3;
use crate::math::sphere::Ball;
use crate::math::{Pose, Real, Vector};
use parry3d::shape::{Shape, TypedShape};

/// Rounds of one search for a zero. Three in four interpolate, the fourth halves, so that 48 are
/// never fewer than 12 halvings; half of the searches need 9 or fewer. Fewer blunt the bound.
const ROUNDS: u32 = 48;

/// Slope, and width of the bracket, that count as 0: in units of the length of the edge searched,
/// and of the edge. 4 ulps of `f64`.
const FLAT: f64 = 1.0e-15;

/// Difference of a distance and its bound that counts as 0, in units of the lengths in play. Few ulps of `f64`, and an
/// eighth of the slack that [`crate::parry::queries::conservative_advancement`] allows for.
const SHARP: f64 = 8.0 * f64::EPSILON;

/// A cylinder or cone, about an axis through its centre.
#[derive(Clone, Copy, Debug)]
pub struct Axisymmetric {
    /// Centre in the collider's frame.
    pub center: Vector,
    /// Unit axis there; a cone's tip is on its positive side.
    pub axis: Vector,
    half_height: f64,
    radius: f64,
    pointed: bool,
    /// Radius of the rounding.
    pub border: Real,
}

/// Placement of an [`Axisymmetric`] body: centre and axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisFrame {
    /// Centre; points are given relative to it.
    pub origin: Vec3<f64>,
    /// Unit axis.
    pub axis: Vec3<f64>,
}

/// Difference of two balls: of their centres, and of their radii.
type BallDifference = (Vec3<f64>, f64);

/// An interpolated sphere near the body.
#[derive(Clone, Copy, Debug)]
pub struct NearBall {
    /// The sphere, with its centre relative to [`AxisFrame::origin`].
    pub ball: Ball,
    /// Distance of its centre to the body, 0 inside.
    pub apart: f64,
    /// Direction from the body to the centre, of length 1 at most: the `m` of the bound.
    pub direction: Vec3<f64>,
}

impl NearBall {
    /// Signed distance of the sphere.
    pub fn distance(&self) -> f64 {
        self.apart - self.ball.radius
    }

    /// Change of the signed distance along an edge: `edge` of the centre, `grow` of the radius.
    fn slope(&self, (edge, grow): BallDifference) -> f64 {
        self.direction.dot(edge) - grow
    }
}

impl Axisymmetric {
    /// The shape at `pose`, if it is a cylinder or a cone, plain or rounded.
    pub fn new(shape: &dyn Shape, pose: &Pose) -> Option<Self> {
        let (half_height, radius, pointed, border) = match shape.as_typed_shape() {
            TypedShape::Cylinder(s) => (s.half_height, s.radius, false, 0.0),
            TypedShape::Cone(s) => (s.half_height, s.radius, true, 0.0),
            TypedShape::RoundCylinder(s) => {
                let i = &s.inner_shape;
                (i.half_height, i.radius, false, s.border_radius)
            }
            TypedShape::RoundCone(s) => {
                let i = &s.inner_shape;
                (i.half_height, i.radius, true, s.border_radius)
            }
            _ => return None,
        };
        Some(Self {
            center: pose.translation,
            axis: pose.rotation * Vector::Y,
            half_height: half_height.max(0.0).into(),
            radius: radius.max(0.0).into(),
            pointed,
            border: border.max(0.0),
        })
    }

    /// Largest distance of its points from its centre, without the border.
    pub fn reach(&self) -> f64 {
        hypot(self.half_height, self.radius)
    }

    /// Support function in the direction `m`, of any length, about the centre.
    pub fn support(&self, place: &AxisFrame, m: Vec3<f64>) -> f64 {
        let along = m.dot(place.axis);
        let across = (m - place.axis * along).length() * self.radius;
        if self.pointed {
            (self.half_height * along).max(across - self.half_height * along)
        } else {
            self.half_height * along.abs() + across
        }
    }

    /// Nearest point of the profile, both as (height, radius).
    fn profile(&self, y: f64, rho: f64) -> (f64, f64) {
        let (h, r) = (self.half_height, self.radius);
        if !self.pointed {
            return (y.clamp(-h, h), rho.min(r));
        }
        if y.abs() <= h && rho <= r && 2.0 * h * rho <= r * (h - y) {
            return (y, rho);
        }
        let base = (-h, rho.min(r));
        // Flank from the rim (−h, r) to the tip (h, 0).
        let length_sq = 4.0 * h * h + r * r;
        let share = if length_sq > 0.0 {
            ((2.0 * h * (y + h) - r * (rho - r)) / length_sq).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let flank = (-h + 2.0 * h * share, r * (1.0 - share));
        let off = |p: (f64, f64)| hypot(y - p.0, rho - p.1);
        if off(base) <= off(flank) { base } else { flank }
    }

    /// The shortest way from a point inside to the surface: unit direction and length.
    pub fn min_translation(&self, place: &AxisFrame, point: Vec3<f64>) -> (Vec3<f64>, f64) {
        let (h, r) = (self.half_height, self.radius);
        let y = point.dot(place.axis);
        let across = point - place.axis * y;
        let rho = across.length();
        let outwards = if rho > 0.0 {
            across * (1.0 / rho)
        } else {
            unit(any_across(place.axis))
        };
        let down = (-place.axis, y + h);
        let others = if self.pointed {
            // The flank's normal in the profile is (r, 2h), its offset r h.
            let length = hypot(2.0 * h, r).max(f64::MIN_POSITIVE);
            let flank = (place.axis * r + outwards * (2.0 * h)) * (1.0 / length);
            [(flank, (r * (h - y) - 2.0 * h * rho) / length), down]
        } else {
            [(outwards, r - rho), (place.axis, h - y)]
        };
        let nearest = others.into_iter().chain([down]);
        nearest
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or((place.axis, 0.0), |(n, way)| (n, way.max(0.0)))
    }

    fn at(&self, place: &AxisFrame, ball: Ball) -> NearBall {
        let y = ball.center.dot(place.axis);
        let across = ball.center - place.axis * y;
        let rho = across.length();
        let foot = self.profile(y, rho);
        let (dy, d_rho) = (y - foot.0, rho - foot.1);
        let apart = hypot(dy, d_rho);
        let direction = if apart > 0.0 {
            let outwards = if rho > 0.0 { d_rho / rho } else { 0.0 };
            (place.axis * dy + across * outwards) * (1.0 / apart)
        } else {
            Vec3::zero()
        };
        NearBall {
            ball,
            apart,
            direction,
        }
    }

    /// The interpolated sphere of 1 to 3 that is nearest; of none, a sphere at the origin.
    pub fn nearest(&self, place: &AxisFrame, balls: &[Ball]) -> NearBall {
        let far = balls
            .iter()
            .map(|ball| ball.center.length() + ball.radius.abs());
        let sharp = SHARP * (self.reach() + far.fold(0.0, f64::max));
        match *balls {
            [] => self.at(place, Ball::new(Vec3::zero(), 0.0)),
            [a] => self.at(place, a),
            [a, b] => self.along(place, a, edge(a, b), 1.0, sharp),
            [a, b, c, ..] => {
                let (u, v) = (edge(a, b), edge(a, c));
                let is_sharp = |near: &NearBall| self.is_sharp(place, near, &[a, b, c], sharp);
                minimise(1.0, u.0.length(), is_sharp, |x| {
                    let near = self.along(place, moved(a, u, x), v, 1.0 - x, sharp);
                    // Where the far side of the triangle stops the inner search, moving along `u`
                    // takes back as much of `v`.
                    (near, near.slope(u) - near.slope(v).min(0.0))
                })
            }
        }
    }

    fn along(
        &self,
        place: &AxisFrame,
        from: Ball,
        edge: BallDifference,
        until: f64,
        sharp: f64,
    ) -> NearBall {
        let ends = [from, moved(from, edge, until)];
        let is_sharp = |near: &NearBall| self.is_sharp(place, near, &ends, sharp);
        minimise(until, edge.0.length(), is_sharp, |x| {
            let near = self.at(place, moved(from, edge, x));
            (near, near.slope(edge))
        })
    }

    /// Whether the bound of these corners along its direction is as large as the distance of a sphere, but for `sharp`.
    fn is_sharp(&self, place: &AxisFrame, near: &NearBall, corners: &[Ball], sharp: f64) -> bool {
        let m = near.direction;
        let ends = corners.iter().map(|ball| m.dot(ball.center) - ball.radius);
        let bound = ends.fold(f64::INFINITY, f64::min) - self.support(place, m);
        near.distance() - bound <= sharp
    }
}

fn edge(a: Ball, b: Ball) -> BallDifference {
    (b.center - a.center, b.radius - a.radius)
}

fn moved(from: Ball, edge: BallDifference, share: f64) -> Ball {
    Ball::new(from.center + edge.0 * share, from.radius + edge.1 * share)
}

/// Least member over `[0, until]` of a convex family, given with its slope; `size` is the length of
/// the edge. Ends as soon as the best one, with the direction along which the family is flat, is sharp.
fn minimise(
    until: f64,
    size: f64,
    is_sharp: impl Fn(&NearBall) -> bool,
    eval: impl Fn(f64) -> (NearBall, f64),
) -> NearBall {
    let (mut near_lo, mut slope_lo) = eval(0.0);
    if slope_lo >= 0.0 || until <= 0.0 {
        return near_lo;
    }
    let (mut near_hi, mut slope_hi) = eval(until);
    if slope_hi <= 0.0 {
        return near_hi;
    }
    let (mut lo, mut hi) = (0.0, until);
    for round in 1..=ROUNDS {
        let width = hi - lo;
        if width <= FLAT {
            break;
        }
        let (rise, slopes) = (near_hi.distance() - near_lo.distance(), slope_hi - slope_lo);
        let share = match round % 4 {
            0 => 0.5,
            // Where both tangents cross: near the least of a kink, or of a valley narrower than the bracket.
            1 => (slope_hi * width - rise) / (slopes * width),
            // The least of the cubic with the distances and slopes of both ends.
            _ => {
                let bend = slope_lo + slope_hi - 3.0 * rise / width;
                let root = (bend * bend - slope_lo * slope_hi).sqrt();
                1.0 - (slope_hi + root - bend) / (slopes + 2.0 * root)
            }
        };
        // Slopes that overflow leave nothing to interpolate.
        let share = if share.is_nan() { 0.5 } else { share };
        let x = (lo + share * width).clamp(lo, hi);
        let (near, slope) = eval(x);
        if slope.abs() <= FLAT * size {
            return near;
        }
        if slope < 0.0 {
            (lo, near_lo, slope_lo) = (x, near, slope);
        } else if slope > 0.0 {
            (hi, near_hi, slope_hi) = (x, near, slope);
        } else {
            return near;
        }
        let best = flattest([near_lo, near_hi], [slope_lo, slope_hi]);
        if is_sharp(&best) {
            return best;
        }
    }
    flattest([near_lo, near_hi], [slope_lo, slope_hi])
}

/// The nearer of two spheres on both sides of the least, with the mean direction along which the family is flat.
fn flattest([lo, hi]: [NearBall; 2], slopes: [f64; 2]) -> NearBall {
    let share = slopes[0] / (slopes[0] - slopes[1]);
    let direction = lo.direction * (1.0 - share) + hi.direction * share;
    let best = if lo.distance() <= hi.distance() {
        lo
    } else {
        hi
    };
    NearBall { direction, ..best }
}

/// Length of the hypotenuse. Lengths in single precision have squares in double precision.
fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Some direction across a unit vector.
fn any_across(v: Vec3<f64>) -> Vec3<f64> {
    let axis = |x, y| v.cross(Vec3::new(x, y, 0.0));
    let (a, b) = (axis(1.0, 0.0), axis(0.0, 1.0));
    if a.length_sq() < b.length_sq() { b } else { a }
}

/// The vector at length 1; 0 stays 0.
pub fn unit(v: Vec3<f64>) -> Vec3<f64> {
    let length = v.length();
    if length > 0.0 { v * (1.0 / length) } else { v }
}
