//! A first contact as parry's answer to a shape cast.

use crate::elementary::{Toi, ToiStatus};
use crate::math::{Real, Vector};
use parry3d::query::{NonlinearRigidMotion, ShapeCastHit, ShapeCastStatus};

/// Length of normals of hits beyond 1: four ulps. rapier turns them into the world's frame, which took up to two off
/// those of floors turned by a quarter (`scenes characters`). A normal that is shorter than 1 and straight up makes of
/// a flat floor one that rapier's character controller slips on: it then drops the whole move (docs/host.md).
const NORMAL_EXCESS: Real = 4.0 * Real::EPSILON;

/// The hit of an answer. `start`: seconds at which the motions begin; `time`: seconds from there to the contact.
pub(super) fn hit(
    toi: &Toi,
    motions: [&NonlinearRigidMotion; 2],
    [start, time]: [Real; 2],
) -> ShapeCastHit {
    let [pose1, pose2] = motions.map(|m| m.position_at_time(time));
    let long = |n: Vector| n.normalize_or_zero() * (1.0 + NORMAL_EXCESS);
    ShapeCastHit {
        time_of_impact: start + time,
        witness1: pose1.inverse_transform_point(toi.points[0]),
        witness2: pose2.inverse_transform_point(toi.points[1]),
        normal1: long(pose1.rotation.inverse() * toi.normal),
        normal2: long(pose2.rotation.inverse() * -toi.normal),
        status: status(toi),
        subshape1: toi.primitives[0],
        subshape2: toi.primitives[1],
    }
}

fn status(toi: &Toi) -> ShapeCastStatus {
    match toi.status {
        ToiStatus::Overlapping => ShapeCastStatus::PenetratingOrWithinTargetDist,
        ToiStatus::Contact if toi.upper <= 0.0 => ShapeCastStatus::PenetratingOrWithinTargetDist,
        ToiStatus::Unresolved => ShapeCastStatus::OutOfIterations,
        ToiStatus::Contact | ToiStatus::Separated => ShapeCastStatus::Converged,
    }
}

/// A contact told for a time `lower`, a fraction of `seconds`, with its points where two straight motions have them
/// then.
pub(super) fn moved_to(
    lower: Real,
    mut toi: Toi,
    motions: [&NonlinearRigidMotion; 2],
    seconds: Real,
) -> Toi {
    let early = (toi.lower - lower) * seconds;
    for (point, motion) in toi.points.iter_mut().zip(motions) {
        *point -= motion.linvel * early;
    }
    toi.lower = lower;
    toi
}
