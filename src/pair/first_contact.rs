//! First contact of two bodies made of primitives, in exact rigid motion: best-first over their
//! trees. The paper (§4.1) tests all pairs; this visits the few that can come first.

use super::search::Search;
use super::volumes::Volumes;
use crate::elementary::first_contact::{motion_is_finite, to_toi};
use crate::elementary::{Paths, Toi, ToiOptions};
use crate::math::Real;
use crate::math::motion::RigidMotion;
use crate::medial::MedialSphere;
use parry3d::query::NonlinearRigidMotion;

/// Work done by one query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Node pairs looked at.
    pub nodes: u32,
    /// Elementary tests whose kernel ran, however often.
    pub tests: u32,
}

/// First contact of two meshes whose bodies move rigidly over `seconds`.
///
/// Motions are in world space, velocities per second; times in the answer are fractions of the
/// step. The guarantee is that of [`crate::elementary`], for the union of all primitives. Computed
/// in double precision.
pub fn first_contact(
    mesh1: &crate::MedialMesh,
    motion1: &NonlinearRigidMotion,
    mesh2: &crate::MedialMesh,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> Toi {
    first_contact_counted(mesh1, motion1, mesh2, motion2, seconds, options).0
}

/// As [`first_contact`] for any two bodies, with the work it took.
pub fn first_contact_counted(
    body1: &impl Volumes,
    motion1: &NonlinearRigidMotion,
    body2: &impl Volumes,
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> (Toi, Counts) {
    let finite = motion_is_finite(motion1) && motion_is_finite(motion2) && seconds.is_finite();
    let bounds_finite = options.tolerance.is_finite()
        && options.time_tolerance.is_finite()
        && options.target_distance.is_finite();
    if !finite || !bounds_finite {
        return (Toi::bad_input(options), Counts::default());
    }
    let mut motions = RigidMotion::<f64>::pair(motion1, motion2, seconds.into());
    if options.paths == Paths::Straight {
        motions = motions.map(|m| m.straightened());
    }
    let mut search = Search::new((body1, body2), motions, options);
    search.run();
    let found = search.earliest.found;
    let pose = |side: usize, i: u8, t: Real| {
        let Some((_, _, primitives)) = found else {
            return MedialSphere::default();
        };
        let spheres = match side {
            0 => body1.primitive(primitives[0]).0,
            _ => body2.primitive(primitives[1]).0,
        };
        let s = spheres[i as usize];
        let at = [motion1, motion2][side].position_at_time(t * seconds);
        MedialSphere::new(at * s.center, s.radius)
    };
    (to_toi(&search.earliest, options, pose), search.counts)
}
