//! Where a shape cast may take a medial mesh: a box, so that of a large shape only what is near is searched.

use crate::math::tolerance::REAL_ROUNDING;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::PrimitiveTree;
use parry3d::bounding_volume::Aabb;
use parry3d::query::NonlinearRigidMotion;

/// The motion with its clock set to `time`.
pub fn started(motion: &NonlinearRigidMotion, time: Real) -> NonlinearRigidMotion {
    if time == 0.0 {
        return *motion;
    }
    NonlinearRigidMotion {
        start: motion.position_at_time(time),
        ..*motion
    }
}

/// Box in the other's frame that holds all the mesh can reach, seen from the other.
pub fn swept_region(
    mesh: &MedialMesh,
    motion1: &NonlinearRigidMotion,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    target: Real,
) -> Aabb {
    let (root_center, root_radius) = mesh.bound(0);
    let to_local = motion2.start.inverse();
    let at = motion1.start * root_center;
    let from = to_local * at;
    let slide = (motion1.linvel - motion2.linvel) * seconds;
    let to = from + to_local.rotation * slide;
    // Turning moves the root's centre by at most twice its lever arm, and the angle times it.
    let swing = |angle: Real, arm: Real| angle.min(2.0) * arm;
    let angle1 = motion1.angvel.length() * seconds;
    let own = swing(angle1, (root_center - motion1.local_center).length());
    // The other's turning moves the mesh around it by the largest distance it has on the way.
    let angle2 = motion2.angvel.length() * seconds;
    let arm2 = (from - motion2.local_center).length() + slide.length() + own;
    let reach = root_radius + target.max(0.0) + own + swing(angle2, arm2 + root_radius);
    // A margin for rounding: the numbers in play are the box's own coordinates, and those that it comes from.
    let sizes = [
        [from, to, at],
        [root_center, motion1.local_center, motion1.start.translation],
        [
            to_local.translation,
            motion2.local_center,
            motion2.start.translation,
        ],
    ];
    let sizes = sizes.as_flattened().iter().map(|p| p.abs().max_element());
    let size = reach + sizes.sum::<Real>();
    let reach = Vector::splat(reach + REAL_ROUNDING * size);
    Aabb::new(from.min(to) - reach, from.max(to) + reach)
}
