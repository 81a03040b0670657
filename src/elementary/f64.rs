//! The elementary queries in double precision: the same code as in `f32`, with `f64` lanes.
//!
//! Queries of meshes and the pipeline compute with these. The guarantee is that of [`crate::elementary`].

use super::bracket::Limits;
use super::first_contact::{Earliest, Mover, linear, motion_is_finite, rigid};
use super::{AlternatingStart, ToiStatus, alternating as baseline};
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::math::tolerance;
use parry3d::query::NonlinearRigidMotion;

/// A sphere on a straight path over the step: [`super::MovingSphere`] in double precision.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct MovingSphere {
    /// Centre at the start.
    pub center: [f64; 3],
    /// Radius, ≥ 0.
    pub radius: f64,
    /// Change of the centre over the whole step.
    pub displacement: [f64; 3],
}

/// Options of a query: [`super::ToiOptions`] in double precision, without
/// what is only for meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToiOptions {
    /// Distance at which bodies count as in contact.
    pub tolerance: f64,
    /// Width at which the bracket of the contact time may stop.
    pub time_tolerance: f64,
    /// Cap of the iterations of one elementary test.
    pub max_iterations: u32,
    /// Signed distance at which bodies count as in contact.
    pub target_distance: f64,
    /// Start of the paper's iteration. Only for [`alternating`].
    pub alternating_start: AlternatingStart,
}

impl Default for ToiOptions {
    fn default() -> Self {
        Self {
            tolerance: tolerance::TOLERANCE.into(),
            time_tolerance: tolerance::TIME_TOLERANCE.into(),
            max_iterations: tolerance::MAX_ITERATIONS,
            target_distance: 0.0,
            alternating_start: AlternatingStart::End,
        }
    }
}

/// First contact of two primitives: [`super::Toi`] in double precision, without spheres and points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toi {
    /// The outcome, which says what the other fields mean.
    pub status: ToiStatus,
    /// Time before which there is no contact.
    pub lower: f64,
    /// Contact, within the tolerance, at this time.
    pub upper: f64,
    /// The contact distance used.
    pub tolerance: f64,
    /// Iterations over all elementary tests.
    pub iterations: u32,
    /// Unit normal from the first body to the second at `lower`; zero when separated.
    pub normal: [f64; 3],
}

impl Toi {
    fn bad_input(options: &ToiOptions) -> Self {
        Self {
            status: ToiStatus::Unresolved,
            lower: 0.0,
            upper: 1.0,
            tolerance: options.tolerance,
            iterations: 0,
            normal: [0.0; 3],
        }
    }

    fn from_earliest(e: &Earliest<f64>) -> Self {
        let n = e.found.map_or(Vec3::zero(), |(_, b, _)| b.normal);
        Self {
            status: e.status,
            lower: e.lower,
            upper: e.upper,
            tolerance: e.tolerance,
            iterations: e.iterations,
            normal: [n.x, n.y, n.z],
        }
    }
}

fn vec3([x, y, z]: [f64; 3]) -> Vec3<f64> {
    Vec3::new(x, y, z)
}

fn limits(options: &ToiOptions) -> Option<Limits<f64>> {
    let finite = options.tolerance.is_finite()
        && options.time_tolerance.is_finite()
        && options.target_distance.is_finite();
    finite.then_some(Limits {
        tolerance: options.tolerance.max(0.0),
        time_tolerance: options.time_tolerance.max(4.0 * f64::EPSILON),
        start: 0.0,
        horizon: 1.0,
        max_iterations: options.max_iterations,
    })
}

fn movers(s: &[MovingSphere]) -> Option<Vec<Mover<f64>>> {
    let good = |s: &MovingSphere| {
        vec3(s.center).is_finite()
            && vec3(s.displacement).is_finite()
            && s.radius.is_finite()
            && s.radius >= 0.0
    };
    ((1..=3).contains(&s.len()) && s.iter().all(good)).then(|| {
        s.iter()
            .map(|s| (vec3(s.center), vec3(s.displacement), s.radius))
            .collect()
    })
}

/// First contact of two primitives on straight paths: [`super::first_contact()`] in double precision.
pub fn first_contact(a: &[MovingSphere], b: &[MovingSphere], options: &ToiOptions) -> Toi {
    match (movers(a), movers(b), limits(options)) {
        (Some(a), Some(b), Some(limits)) => {
            Toi::from_earliest(&linear([a, b], options.target_distance, limits))
        }
        _ => Toi::bad_input(options),
    }
}

/// First contact of two primitives in exact rigid motion: [`super::first_contact_rigid`] computed in double
/// precision, from rapier's numbers in single precision.
pub fn first_contact_rigid(
    a: &[crate::MedialSphere],
    motion_a: &NonlinearRigidMotion,
    b: &[crate::MedialSphere],
    motion_b: &NonlinearRigidMotion,
    seconds: f64,
    options: &ToiOptions,
) -> Toi {
    let good = |s: &[crate::MedialSphere]| {
        (1..=3).contains(&s.len())
            && s.iter()
                .all(|s| s.center.is_finite() && s.radius.is_finite() && s.radius >= 0.0)
    };
    let finite = motion_is_finite(motion_a) && motion_is_finite(motion_b) && seconds.is_finite();
    let Some(limits) = limits(options).filter(|_| finite && good(a) && good(b)) else {
        return Toi::bad_input(options);
    };
    let local = |s: &[crate::MedialSphere]| -> Vec<_> {
        s.iter()
            .map(|s| (Vec3::from_vector(s.center), f64::from(s.radius)))
            .collect()
    };
    let motions = RigidMotion::pair(motion_a, motion_b, seconds);
    let earliest = rigid(
        &local(a),
        &local(b),
        &motions,
        options.target_distance,
        limits,
    );
    Toi::from_earliest(&earliest)
}

/// The paper's iteration: [`super::alternating()`] in double precision.
pub fn alternating(a: &[MovingSphere], b: &[MovingSphere], options: &ToiOptions) -> Toi {
    let (Some(a), Some(b)) = (movers(a), movers(b)) else {
        return Toi::bad_input(options);
    };
    let limits = baseline::AlternatingLimits {
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        start: options.alternating_start,
    };
    let (time, iterations) = baseline::search(&a, &b, &limits);
    Toi {
        status: time.map_or(ToiStatus::Separated, |_| ToiStatus::Contact),
        lower: time.unwrap_or(1.0),
        upper: time.unwrap_or(1.0),
        iterations,
        ..Toi::bad_input(options)
    }
}
