//! Limits of joints: how far a joint is along an axis that it limits, and where it has to stop.
//!
//! Angles are rapier's. Of a joint between two bodies, with `q` the turn from the middle of the range, that about axis
//! `i` is `2 atan2(q_i, q_w)`. Those of a link of a multibody rapier sums from step to step; they go on by the
//! components of the turn's scaled axis `θ`. With the other body's turning velocity `ω` in the frame of the first,
//! `d/dt 2 atan2(q_i, q_w) = ω · (q_w² e_i + q_w q × e_i + q_i q) / (q_w² + q_i²)`, and `dθ_i/dt = ω · (e_i + θ × e_i /
//! 2 + c θ × (θ × e_i))` with `c = (1 − (θ/2) cot(θ/2)) / θ²`.

use crate::math::{Pose, Real, Rotation, Vector};
use crate::rapier::view::link_angles::{LinkAngles, shortest};
use rapier3d::dynamics::{GenericJoint, MultibodyLink};
use std::f32::consts::PI;

/// How near its limit a joint stands at it, in units of rapier's length unit or in radians: what rounding and closing
/// joints leave.
const AT_LIMIT: Real = 1.0e-3;

/// A limited axis of a joint that is not locked, or the linear ones together whose distance a rope limits.
#[derive(Clone, Copy, PartialEq)]
pub struct Limit {
    /// Bits of the six axes, linear ones first.
    axes: u8,
    /// Least and greatest place, a length or an angle.
    range: [Real; 2],
    /// The turn of the second frame against the first that counts as the angle 0.
    zero: Rotation,
    /// Whether angles are sums, as those of multibodies.
    is_sum: bool,
}

/// Position of a joint along a limited axis.
pub struct AxisPosition {
    /// A length or an angle.
    pub at: Real,
    /// Axis by which it changes with the velocity of the second body along it, or by its turning velocity, world frame.
    pub axis: Vector,
    /// Whether it is an angle.
    pub is_angle: bool,
}

impl Limit {
    /// The limits of a joint of two bodies. rapier's coupled angles, of which it limits the sum, are left out.
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
                is_sum: false,
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
            is_sum: false,
        };
        if axis < 3 {
            return Some(limit([min, max], Rotation::IDENTITY));
        }
        let zero = Rotation::from_scaled_axis(Vector::AXES[i - 3] * middle);
        // A full turn, or what is no number, is no limit.
        (half < PI).then(|| limit([-half, half], zero))
    }

    /// The limits of a link of a multibody, whose turns so far are given.
    pub fn of_link(link: &MultibodyLink, turned: &LinkAngles) -> Vec<Self> {
        let joint = &link.joint.data;
        let limited = (0..6u8).filter(|i| free_limits(joint) & (1 << i) != 0);
        let limit = |axis: u8| {
            let i = usize::from(axis);
            let from = if axis < 3 { 0.0 } else { turned.angles[i - 3] };
            Self {
                axes: 1 << axis,
                range: [joint.limits[i].min - from, joint.limits[i].max - from],
                zero: turned.rotation,
                is_sum: true,
            }
        };
        limited.map(limit).collect()
    }

    /// Position of a joint whose two frames these are.
    pub fn place(&self, frames: [Pose; 2]) -> AxisPosition {
        let axis = |i: usize| frames[0].rotation * Vector::AXES[i];
        let i = self.axes.trailing_zeros() as usize;
        if i < 3 {
            let way = frames[1].translation - frames[0].translation;
            let (at, axis) = if self.axes.count_ones() == 1 {
                (way.dot(axis(i)), axis(i))
            } else {
                let limited = (0..3).filter(|i| self.axes & (1 << i) != 0);
                let way: Vector = limited.map(|i| axis(i) * way.dot(axis(i))).sum();
                (way.length(), way.normalize_or_zero())
            };
            return AxisPosition {
                at,
                axis,
                is_angle: false,
            };
        }
        let turn = frames[0].rotation.inverse() * frames[1].rotation * self.zero.inverse();
        let (at, axis) = if self.is_sum {
            scaled_axis(shortest(turn), i - 3)
        } else {
            twist(shortest(turn), i - 3)
        };
        AxisPosition {
            at,
            axis: frames[0].rotation * axis,
            is_angle: true,
        }
    }

    /// How near this limit a joint stands at it, a length or an angle, where rapier's length unit is `unit`.
    fn near(&self, unit: Real) -> Real {
        let is_angle = self.axes.trailing_zeros() >= 3;
        if is_angle { AT_LIMIT } else { AT_LIMIT * unit }
    }

    /// Whether a joint that is `at` stands at a limit. `unit`: rapier's length unit.
    pub fn is_reached(&self, at: Real, unit: Real) -> bool {
        let ([min, max], near) = (self.range, self.near(unit));
        at >= max - near || at <= min + near
    }

    /// Whether a joint that is `at` stands at a limit, does not leave it at a rate (per second), and is pushed on
    /// there.
    pub fn holds(&self, at: Real, rate: Real, push: Real, unit: Real) -> bool {
        let ([min, max], near) = (self.range, self.near(unit));
        let at_max = at >= max - near && rate >= -near && push > 0.0;
        at_max || (at <= min + near && rate <= near && push < 0.0)
    }

    /// Position at which a joint that is `at`, and would be `next`, has to stop, if it has to: at its limit, or where
    /// it is if that is beyond already.
    pub fn stop(&self, at: Real, next: Real) -> Option<Real> {
        let [min, max] = self.range;
        if next > at && next > max {
            Some(at.max(max))
        } else if next < at && next < min {
            Some(at.min(min))
        } else {
            None
        }
    }
}

fn free_limits(joint: &GenericJoint) -> u8 {
    joint.limit_axes.bits() & !joint.locked_axes.bits()
}

/// A component of the scaled axis of a turn, and its change by the turning velocity.
fn scaled_axis(turn: Rotation, i: usize) -> (Real, Vector) {
    let (theta, e) = (turn.to_scaled_axis(), Vector::AXES[i]);
    let angle = theta.length();
    let half = 0.5 * angle;
    let c = if angle < 1.0e-2 {
        1.0 / 12.0
    } else {
        (1.0 - half / half.tan()) / (angle * angle)
    };
    let across = theta.cross(e);
    (theta[i], e + across * 0.5 + theta.cross(across) * c)
}

/// The angle of a turn about an axis, and its change by the turning velocity.
fn twist(turn: Rotation, i: usize) -> (Real, Vector) {
    let (v, w, e) = (Vector::new(turn.x, turn.y, turn.z), turn.w, Vector::AXES[i]);
    let square = w * w + v[i] * v[i];
    if square < 1.0e-6 {
        return (0.0, Vector::ZERO);
    }
    let change = e * (w * w) + v.cross(e) * w + v * v[i];
    (2.0 * v[i].atan2(w), change / square)
}
