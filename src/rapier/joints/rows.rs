//! Rows of the Jacobian `G` of joints ([`crate::rapier::joints::tied_system`]): one for each locked axis, and for each
//! limit at which a joint stops.

use crate::math::{Pose, Real, Rotation, Vector};
use crate::rapier::joints::limits::{AxisPosition, Limit};

/// Linear and angular velocity, or force and torque, at a body's centre of mass.
pub type Twist = [Vector; 2];

/// A joint between two bodies of a [`StepView`](crate::rapier::view::step_view::StepView).
pub struct Joint {
    /// Indices in the view.
    pub bodies: [usize; 2],
    /// Frames of the joint, in the frame of each body.
    pub frames: [Pose; 2],
    /// Which of the six axes of the first frame are locked, linear ones first.
    pub locked: u8,
    /// Limits of the others.
    pub limits: Vec<Limit>,
}

/// The opening of a joint along or about an axis, and its change by the twists of both bodies.
pub struct JointRow {
    /// Places of the bodies in what is tied together.
    pub bodies: [usize; 2],
    /// Rows for each body.
    pub jacobian: [Twist; 2],
    /// A length or an angle.
    pub opening: Real,
    /// Whether it is an angle.
    pub is_angle: bool,
}

impl JointRow {
    /// Change of the opening in a second.
    pub fn along(&self, twists: &[Twist]) -> f64 {
        let of = |k: usize| dot(self.jacobian[k], twists[self.bodies[k]]);
        of(0) + of(1)
    }
}

/// Ends of a joint, world frame.
#[derive(Clone, Copy)]
pub struct JointEnds {
    /// Places of the bodies in what is tied together.
    pub bodies: [usize; 2],
    /// Frames of the joint.
    pub frames: [Pose; 2],
    /// Centres of mass.
    pub centers: [Vector; 2],
}

impl JointEnds {
    /// Rows of the locked ones of six axes.
    pub fn locked(self, axes: u8) -> impl Iterator<Item = JointRow> {
        let [first, second] = self.frames;
        let way = second.translation - first.translation;
        let turned = match axes >> 3 {
            0 => Vector::ZERO,
            angular => turned([first.rotation, second.rotation], angular),
        };
        let locked = (0..6).filter(move |i: &u8| axes & (1 << i) != 0);
        locked.map(move |i| {
            let axis = first.rotation * Vector::AXES[usize::from(i % 3)];
            match i {
                0..3 => self.slide(axis, way.dot(axis)),
                _ => self.turn(axis, turned.dot(axis)),
            }
        })
    }

    /// The row of a limit.
    pub fn limited(&self, limit: &Limit) -> JointRow {
        let AxisPosition { at, axis, is_angle } = limit.place(self.frames);
        if is_angle {
            self.turn(axis, at)
        } else {
            self.slide(axis, at)
        }
    }

    /// Moves the second body along an axis, against the first.
    fn slide(&self, n: Vector, opening: Real) -> JointRow {
        let arms = self.centers.map(|c| self.frames[1].translation - c);
        JointRow {
            bodies: self.bodies,
            jacobian: [[-n, -arms[0].cross(n)], [n, arms[1].cross(n)]],
            opening,
            is_angle: false,
        }
    }

    /// Turns the second body about an axis, against the first.
    fn turn(&self, n: Vector, opening: Real) -> JointRow {
        JointRow {
            bodies: self.bodies,
            jacobian: [[Vector::ZERO, -n], [Vector::ZERO, n]],
            opening,
            is_angle: true,
        }
    }
}

/// Power of a wrench at a twist.
pub fn dot(a: Twist, b: Twist) -> f64 {
    f64::from(a[0].dot(b[0]) + a[1].dot(b[1]))
}

/// Angles by which the second frame is turned against the first round the locked axes, world frame, for small turns.
fn turned(rotations: [Rotation; 2], locked: u8) -> Vector {
    let [first, second] = rotations;
    if (locked & 7).count_ones() == 2 {
        let free = (0..3).find(|i| locked & (1 << i) == 0).unwrap_or(0);
        let axis = Vector::AXES[free];
        return (first * axis).cross(second * axis);
    }
    let between = first.inverse() * second;
    let sign = if between.w < 0.0 { -2.0 } else { 2.0 };
    first * (Vector::new(between.x, between.y, between.z) * sign)
}
