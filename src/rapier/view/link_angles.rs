//! How far a link of a multibody has turned about the axes of its joint, in the form in which rapier sums it.

use crate::math::{Real, Rotation, Vector};
use rapier3d::dynamics::MultibodyLink;
use std::f32::consts::TAU;

/// Difference of angles, in radians, that is not made up for by whole turns: what rounding makes.
const NO_TURN: Real = 1.0e-4;

/// Turn in a step, in radians, from which a link's angles are lost: rapier's step left all bounds. It made up to 1e16,
/// of which single precision tells no rotation.
const LOST: Real = 1.0e4;

/// How far a link of a multibody has turned: rapier sums the angles about the three axes of its joint, with all whole
/// turns, beside the rotation that they made.
#[derive(Clone, Copy, Debug, Default)]
pub struct LinkAngles {
    /// Rotation of the link against its parent.
    pub rotation: Rotation,
    /// Sums about the axes of the joint, in radians.
    pub angles: Vector,
}

impl LinkAngles {
    /// Angles of a link as rapier has them now.
    pub fn of(link: &MultibodyLink) -> Self {
        let coordinates = link.joint.coords();
        Self {
            rotation: link.joint.joint_rot(),
            angles: Vector::new(coordinates[3], coordinates[4], coordinates[5]),
        }
    }

    /// Displacements that take a link from what rapier has, `of`, to a rotation, of which the last is the shortest turn
    /// there, and the others whole turns: so its angles go on from these. Angles that are lost are set to zero first;
    /// then those of a hinge, whose axis is `hinge`, are the sum they should be, others those of the shortest turn.
    pub fn displacements_to(
        &self,
        of: &Self,
        rotation: Rotation,
        hinge: Option<usize>,
    ) -> [Vector; 3] {
        let turn = |from: Rotation| shortest(rotation * from.inverse()).to_scaled_axis();
        let made = (of.angles - self.angles).abs().max_element();
        if made.is_finite() && made > LOST {
            let back = -of.angles;
            let last = match hinge {
                Some(axis) => Vector::AXES[axis] * (self.angles + turn(self.rotation))[axis],
                None => turn(Rotation::from_scaled_axis(back) * of.rotation),
            };
            return [back, Vector::ZERO, last];
        }
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

/// The same rotation, by no more than half a turn.
pub fn shortest(q: Rotation) -> Rotation {
    if q.w < 0.0 { -q } else { q }
}

/// Turn in a step, in radians, from which the end rotation alone may hide whole turns.
const MAY_WRAP: Real = 2.5;

/// The turn `turn` plus whole turns, as rapier's integration of `expected` in `n` pieces made it.
pub fn unwrapped(turn: Vector, expected: Vector, n: Real) -> Vector {
    let asked = expected.length();
    if asked <= MAY_WRAP {
        return turn;
    }
    let made = expected * (n * 2.0 * (asked / (2.0 * n)).atan() / asked);
    let axis = turn.normalize_or_zero();
    if axis == Vector::ZERO {
        // Whole turns only: about the axis expected.
        return made.normalize() * (made.length() / TAU).round() * TAU;
    }
    turn + axis * (((made.dot(axis) - turn.length()) / TAU).round() * TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// rapier's `MultibodyJoint::apply_displacement` of a joint with three free angles.
    fn turned_by_rapier(rotation: Rotation, displacements: [Vector; 3]) -> Rotation {
        let turn = |rotation, by| Rotation::from_scaled_axis(by) * rotation;
        displacements.into_iter().fold(rotation, turn)
    }

    #[test]
    fn a_link_gets_to_its_rotation_however_far_rapier_turned_it() {
        let target = Rotation::from_scaled_axis(Vector::new(0.3, -1.1, 0.7));
        for size in [1.0, 40.0, 3.0e3, 1.0e6, 1.0e12, 3.0e16] {
            let before = LinkAngles {
                rotation: Rotation::from_scaled_axis(Vector::new(-0.2, 0.4, 2.9)),
                angles: Vector::new(6.1, 0.4, 9.2),
            };
            let now = LinkAngles {
                rotation: Rotation::from_scaled_axis(Vector::new(2.0, 0.1, -0.9)),
                angles: Vector::new(0.13, -0.41, 1.0) * size,
            };
            let displacements = before.displacements_to(&now, target, None);
            let end = turned_by_rapier(now.rotation, displacements);
            let off = shortest(end * target.inverse()).to_scaled_axis().length();
            assert!(off < 1.0e-3, "{off} rad off from angles of {size} rad");
        }
    }

    #[test]
    fn a_hinge_keeps_its_whole_turns_however_far_rapier_turned_it() {
        let hinge = |angle: Real| LinkAngles {
            rotation: Rotation::from_rotation_x(angle),
            angles: Vector::X * angle,
        };
        for (from, to) in [(6.1, 6.4), (31.0, 29.5), (2.0e4, 2.0e4 + 0.25)] {
            for now in [from + 1.0, from - 9.0, 3.0e6, -1.0e12, 3.0e16].map(hinge) {
                let turns = hinge(from).displacements_to(&now, hinge(to).rotation, Some(0));
                let end = turns.iter().fold(now.angles.x, |sum, turn| sum + turn.x);
                assert!(
                    (end - to).abs() < 0.01,
                    "{end} rad for {to}, from {}",
                    now.angles.x
                );
            }
        }
    }
}
