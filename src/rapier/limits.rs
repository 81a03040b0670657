//! Limits of joints: how far a joint is along an axis that it limits, and where it has to stop.
//!
//! An angle is a component of the scaled axis of a turn: of that from the middle of the range, for joints between two
//! bodies, and for those of multibodies of that since rapier's step, which goes on from the angles that rapier sums.

use super::motion::{Body, shortest};
use crate::math::{Pose, Real, Rotation, Vector};
use rapier3d::dynamics::{GenericJoint, MultibodyLink};
use std::f32::consts::{PI, TAU};

/// Difference of angles, in radians, that is not made up for by whole turns: what rounding makes.
const NO_TURN: Real = 1.0e-4;

/// Limited axes of a joint that are not locked: one of the six, or the linear ones together whose distance a rope or a
/// spring limits.
#[derive(Clone, Copy, PartialEq)]
pub struct Limit {
    /// Bits of the axes, linear ones first.
    axes: u8,
    /// Least and greatest place, a length or an angle.
    range: [Real; 2],
    /// The turn of the second frame against the first that counts as the angle 0.
    zero: Rotation,
}

/// How far a link of a multibody has turned: rapier sums the angles about the three axes of its joint, with all whole
/// turns, beside the rotation that they made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turned {
    /// Of the link against its parent.
    pub rotation: Rotation,
    /// Sums about the axes of the joint, in radians.
    pub angles: Vector,
}

impl Turned {
    /// What rapier has now.
    pub fn of(link: &MultibodyLink) -> Self {
        let coordinates = link.joint.coords();
        Self {
            rotation: link.joint.joint_rot(),
            angles: Vector::new(coordinates[3], coordinates[4], coordinates[5]),
        }
    }

    /// As far as a body has turned where it goes on from: at the end of rapier's step, or at its start, if that was taken
    /// back.
    pub fn at(link: &MultibodyLink, body: &Body) -> Self {
        match body.turned_before {
            Some(before) if body.is_taken_back => before,
            _ => Self::of(link),
        }
    }

    /// Displacements that take a link from what rapier has, `of`, to a rotation, of which the last is the shortest turn
    /// there, and the others whole turns: so its angles go on from these. `free`: the axis of a hinge.
    pub fn goes_on(&self, of: &Self, rotation: Rotation, hinge: Option<usize>) -> [Vector; 3] {
        let turn = |from: Rotation| shortest(rotation * from.inverse()).to_scaled_axis();
        let last = turn(of.rotation);
        let left = self.angles + turn(self.rotation) - of.angles - last;
        if let Some(axis) = hinge {
            let whole = Vector::AXES[axis] * (left[axis] / TAU).round() * TAU;
            return [whole, Vector::ZERO, last];
        }
        let half = 0.5 * left;
        if half.length() < NO_TURN || !half.is_finite() {
            return [Vector::ZERO, Vector::ZERO, last];
        }
        let whole = (half.length() / TAU).ceil() * TAU;
        let length = (whole * whole - half.length_squared()).max(0.0).sqrt();
        let aside = half.normalize().any_orthonormal_vector() * length;
        [half + aside, half - aside, last]
    }
}

/// Where a joint is along a limited axis.
pub struct Place {
    /// A length or an angle.
    pub at: Real,
    /// Unit vector along which, or about which, the second body moves away from 0, world frame.
    pub axis: Vector,
    /// Whether it is an angle.
    pub is_angle: bool,
}

impl Limit {
    /// Those of a joint of two bodies. rapier's coupled angles, of which it limits the sum, are left out.
    pub fn of_joint(joint: &GenericJoint) -> Vec<Self> {
        let (limited, coupled) = (free_limits(joint), joint.coupled_axes.bits());
        let single = (0..6u8).filter(|i| limited & !coupled & (1 << i) != 0);
        let mut limits: Vec<Self> = single.filter_map(|i| Self::single(joint, i)).collect();
        let linear = coupled & 0b111 & !joint.locked_axes.bits();
        if linear != 0 && limited & 1 << linear.trailing_zeros() != 0 {
            let of = &joint.limits[linear.trailing_zeros() as usize];
            limits.push(Self {
                axes: linear,
                range: [of.min, of.max],
                zero: Rotation::IDENTITY,
            });
        }
        limits
    }

    fn single(joint: &GenericJoint, axis: u8) -> Option<Self> {
        let i = usize::from(axis);
        let [min, max] = [joint.limits[i].min, joint.limits[i].max];
        let (middle, half) = (0.5 * (min + max), 0.5 * (max - min));
        let limit = |range, zero| Self {
            axes: 1 << axis,
            range,
            zero,
        };
        if axis < 3 {
            return Some(limit([min, max], Rotation::IDENTITY));
        }
        let zero = Rotation::from_scaled_axis(Vector::AXES[i - 3] * middle);
        // A full turn, or what is no number, is no limit.
        (half < PI).then(|| limit([-half, half], zero))
    }

    /// Those of a link of a multibody, whose turns so far are given.
    pub fn of_link(link: &MultibodyLink, turned: &Turned) -> Vec<Self> {
        let joint = &link.joint.data;
        let limited = (0..6u8).filter(|i| free_limits(joint) & (1 << i) != 0);
        let limit = |axis: u8| {
            let i = usize::from(axis);
            let from = if axis < 3 { 0.0 } else { turned.angles[i - 3] };
            Self {
                axes: 1 << axis,
                range: [joint.limits[i].min - from, joint.limits[i].max - from],
                zero: turned.rotation,
            }
        };
        limited.map(limit).collect()
    }

    /// Where a joint is whose two frames these are.
    pub fn place(&self, frames: [Pose; 2]) -> Place {
        let axis = |i: usize| frames[0].rotation * Vector::AXES[i];
        let first = self.axes.trailing_zeros() as usize;
        if first >= 3 {
            let between = frames[0].rotation.inverse() * frames[1].rotation;
            let turn = shortest(between * self.zero.inverse()).to_scaled_axis();
            return Place {
                at: turn[first - 3],
                axis: axis(first - 3),
                is_angle: true,
            };
        }
        let way = frames[1].translation - frames[0].translation;
        let (at, axis) = if self.axes.count_ones() == 1 {
            (way.dot(axis(first)), axis(first))
        } else {
            let limited = (0..3).filter(|i| self.axes & (1 << i) != 0);
            let way: Vector = limited.map(|i| axis(i) * way.dot(axis(i))).sum();
            (way.length(), way.normalize_or_zero())
        };
        Place {
            at,
            axis,
            is_angle: false,
        }
    }

    /// Where a joint that is `at` and moves by `rate` a second has to stop within some seconds, if it has to: at its
    /// limit, or where it is if that is beyond already.
    pub fn stop(&self, at: Real, rate: Real, seconds: Real) -> Option<Real> {
        let [min, max] = self.range;
        let next = at + rate * seconds;
        if rate > 0.0 && next > max {
            Some(at.max(max))
        } else if rate < 0.0 && next < min {
            Some(at.min(min))
        } else {
            None
        }
    }
}

fn free_limits(joint: &GenericJoint) -> u8 {
    joint.limit_axes.bits() & !joint.locked_axes.bits()
}
