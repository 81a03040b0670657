//! First contact of one pair of primitives: the earliest over its elementary tests, on straight
//! paths (paper Eqs. 1 to 3) or in exact rigid motion.

use super::bracket::Limits;
use super::distance::Ball;
use super::distance::thinnest;
pub use super::earliest::Earliest;
use super::path::{LinearPath, RigidPath};
use super::test_list::{Domain, ElementaryTest, OwnedFeatures, for_each_test};
use super::{MovingSphere, Toi, ToiOptions};
use crate::math::Real;
use crate::math::lane::{Scalar, Vec3};
use crate::math::motion::RigidMotion;
use crate::math::nearest::Nearest;
use crate::medial::MedialSphere;
use parry3d::query::NonlinearRigidMotion;

/// A sphere of a test, in a common frame: centre, displacement over the step, radius.
pub(crate) type Mover<S> = (Vec3<S>, Vec3<S>, S);

/// Two primitives on straight paths, in the precision of `S`.
pub(super) struct Straight<S> {
    movers: [Vec<Mover<S>>; 2],
    start: [Vec<Ball<S>>; 2],
    /// Distance that counts as contact, a length: the one asked for, or raised to what the primitives' thinnest places
    /// allow.
    target_distance: S,
}

impl<S: Scalar> Straight<S> {
    pub(super) fn new(movers: [Vec<Mover<S>>; 2], target_distance: S) -> Self {
        let rest = |side: &Vec<Mover<S>>| side.iter().map(|m| (m.0, m.2)).collect::<Vec<_>>();
        let start = movers.each_ref().map(rest);
        let target_distance = target_distance.max(-thinnest(&start[0], &start[1]));
        Self {
            movers,
            start,
            target_distance,
        }
    }

    pub(super) fn path(&self, test: &ElementaryTest) -> LinearPath<S> {
        LinearPath::new(test, self.target_distance, |second, i| {
            self.movers[usize::from(second)][usize::from(i)]
        })
    }

    /// Calls `visit` with every test of the two, until it returns `false`.
    pub(super) fn for_each_test(&self, visit: impl FnMut(ElementaryTest) -> bool) {
        let [a, b] = self
            .movers
            .each_ref()
            .map(|side| OwnedFeatures::whole(side.len()));
        for_each_test(a, b, visit);
    }

    pub(super) fn conclude(&self, earliest: &mut Earliest<S>) {
        let [a, b] = &self.start;
        earliest.conclude(a, b, self.target_distance, |test| self.path(test));
    }
}

/// First contact of two primitives on straight paths, in the precision of `S`.
pub(crate) fn linear<S: Scalar>(
    movers: [Vec<Mover<S>>; 2],
    target_distance: S,
    limits: Limits<S>,
) -> Earliest<S> {
    let pair = Straight::new(movers, target_distance);
    let mut earliest = Earliest::new(limits);
    pair.for_each_test(|test| earliest.test(test, &pair.path(&test), [0, 0]));
    pair.conclude(&mut earliest);
    earliest
}

/// First contact of two primitives in exact rigid motion, in the precision of `S`.
pub(crate) fn rigid<S: Scalar>(
    a: &[Ball<S>],
    b: &[Ball<S>],
    motions: &[RigidMotion<S>; 2],
    target_distance: S,
    limits: Limits<S>,
) -> Earliest<S> {
    let start = |side: usize, s: &[Ball<S>]| -> Vec<Ball<S>> {
        let turned = motions[side].sin_cos(S::zero());
        s.iter()
            .map(|s| (motions[side].point(s.0).at(S::zero(), turned).position, s.1))
            .collect()
    };
    let (start_a, start_b) = (start(0, a), start(1, b));
    let target_distance = target_distance.max(-thinnest(&start_a, &start_b));
    let path = |test: &ElementaryTest| {
        RigidPath::new(test, motions, target_distance, |second, i| {
            if second { b[i as usize] } else { a[i as usize] }
        })
    };
    let mut earliest = Earliest::new(limits);
    for_each_test(
        OwnedFeatures::whole(a.len()),
        OwnedFeatures::whole(b.len()),
        |test| earliest.test(test, &path(&test), [0, 0]),
    );
    earliest.conclude(&start_a, &start_b, target_distance, path);
    earliest
}

pub(crate) fn options_limits<S: Scalar>(options: &ToiOptions) -> Limits<S> {
    Limits {
        tolerance: S::from_real(options.tolerance.max(0.0)),
        time_tolerance: S::from_real(options.time_tolerance).max(S::splat(4.0 * S::EPSILON)),
        start: S::zero(),
        horizon: S::one(),
        max_iterations: options.max_iterations,
    }
}

fn valid(
    sizes: [usize; 2],
    options: &ToiOptions,
    spheres: impl Iterator<Item = (bool, Real)>,
) -> bool {
    let options_finite = options.tolerance.is_finite()
        && options.time_tolerance.is_finite()
        && options.target_distance.is_finite();
    let mut spheres = spheres;
    sizes.iter().all(|n| (1..=3).contains(n))
        && options_finite
        && spheres.all(|(finite, radius)| finite && radius.is_finite() && radius >= 0.0)
}

/// First contact of two primitives on straight paths (paper Eqs. 1 to 3), in `f32`. A primitive is given by its 1, 2 or
/// 3 spheres. Positions are in world space, in the user's unit; times are fractions of the step. It takes 1 to 15
/// elementary tests of typically 2 iterations each.
///
/// The guarantee is that of [`crate::elementary`]. A wrong number of spheres, values that are not finite and negative
/// radii give [`super::ToiStatus::Unresolved`] with `lower = 0`.
pub fn first_contact(a: &[MovingSphere], b: &[MovingSphere], options: &ToiOptions) -> Toi {
    let Some(movers) = movers(a, b, options) else {
        return Toi::bad_input(options);
    };
    let earliest = linear(movers, options.target_distance, options_limits(options));
    straight_toi(&earliest, [a, b], options)
}

/// Checks and converts both primitives; `None` if they or the options are refused.
pub(super) fn movers(
    a: &[MovingSphere],
    b: &[MovingSphere],
    options: &ToiOptions,
) -> Option<[Vec<Mover<f32>>; 2]> {
    let checks = a.iter().chain(b).map(|s| {
        let finite = s.center.is_finite() && s.displacement.is_finite();
        (finite, s.radius)
    });
    if !valid([a.len(), b.len()], options, checks) {
        return None;
    }
    let mover = |s: &MovingSphere| -> Mover<f32> {
        let center = Vec3::from_vector(s.center);
        (center, Vec3::from_vector(s.displacement), s.radius)
    };
    Some([a, b].map(|side| side.iter().map(mover).collect()))
}

/// Reports a result on straight paths in world space.
pub(super) fn straight_toi(
    earliest: &Earliest<f32>,
    sides: [&[MovingSphere]; 2],
    options: &ToiOptions,
) -> Toi {
    to_toi(earliest, options, |side, i, t| {
        let s = sides[side][usize::from(i)];
        MedialSphere::new(s.center + s.displacement * t, s.radius)
    })
}

/// First contact of two primitives in exact rigid motion for `seconds`, in `f32`. Spheres are in the frame of their
/// body, motions in world space with velocities per second; rotations may be by any angle. Times in the answer are
/// fractions of `seconds`. Guarantee and bad input are as in [`first_contact`]; it takes about 1.6 times as long.
pub fn first_contact_rigid(
    a: &[MedialSphere],
    motion_a: &NonlinearRigidMotion,
    b: &[MedialSphere],
    motion_b: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> Toi {
    let checks = a.iter().chain(b).map(|s| (s.center.is_finite(), s.radius));
    let finite = motion_is_finite(motion_a) && motion_is_finite(motion_b) && seconds.is_finite();
    if !finite || !valid([a.len(), b.len()], options, checks) {
        return Toi::bad_input(options);
    }
    let local = |s: &MedialSphere| (Vec3::<f32>::from_vector(s.center), s.radius);
    let sides = [a, b].map(|side| side.iter().map(local).collect::<Vec<_>>());
    let motions = RigidMotion::pair(motion_a, motion_b, seconds);
    let limits = options_limits::<f32>(options);
    let earliest = rigid(
        &sides[0],
        &sides[1],
        &motions,
        options.target_distance,
        limits,
    );
    let pose = |side: usize, i: u8, t: f32| {
        let s = [a, b][side][i as usize];
        let at = [motion_a, motion_b][side].position_at_time(t * seconds);
        MedialSphere::new(at * s.center, s.radius)
    };
    to_toi(&earliest, options, pose)
}

/// Whether all numbers of a motion are finite and its rotation can be normalised.
pub(crate) fn motion_is_finite(m: &NonlinearRigidMotion) -> bool {
    m.start.translation.is_finite()
        && m.start.rotation.is_finite()
        && m.start.rotation.length_squared() > 0.5
        && m.local_center.is_finite()
        && m.linvel.is_finite()
        && m.angvel.is_finite()
}

/// A lower bound that keeps its promise.
pub(crate) fn rounded_down(exact: f64) -> Real {
    let bound = exact as Real;
    if f64::from(bound) > exact {
        return bound.next_down();
    }
    bound
}

/// Reports a result in world space; `pose` gives sphere `i` of a side at a time.
pub(crate) fn to_toi<S: Scalar>(
    earliest: &Earliest<S>,
    options: &ToiOptions,
    pose: impl Fn(usize, u8, Real) -> MedialSphere,
) -> Toi {
    let mut toi = Toi {
        status: earliest.status,
        lower: rounded_down(earliest.lower.to_f64()),
        upper: earliest.upper.to_f64() as Real,
        tolerance: earliest.tolerance.to_f64() as Real,
        iterations: earliest.iterations,
        ..Toi::separated(options)
    };
    if let Some((test, b, primitives)) = &earliest.found {
        let t = b.lower.to_f64() as Real;
        let weights = corner_weights(test.domain, &b.nearest).map(|w| w as Real);
        let mut spheres = [MedialSphere::default(); 2];
        for ((i, j), w) in test.corners.iter().zip(weights) {
            for (side, k) in [(0, *i), (1, *j)] {
                let s = pose(side, k, t);
                spheres[side].center += s.center * w;
                spheres[side].radius += s.radius * w;
            }
        }
        toi.normal = b.normal.to_vector();
        toi.spheres = spheres;
        toi.points = [
            spheres[0].center + toi.normal * spheres[0].radius,
            spheres[1].center - toi.normal * spheres[1].radius,
        ];
        toi.primitives = *primitives;
    }
    toi
}

/// Weights of the corners at the nearest pair; the fourth only counts in the box.
pub(crate) fn corner_weights<S: Scalar>(domain: Domain, s: &Nearest<S>) -> [f64; 4] {
    let (x, y) = (s.alpha.to_f64(), s.beta.to_f64());
    match domain {
        Domain::Box => [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y],
        Domain::Triangle => [1.0 - x - y, x, y, 0.0],
    }
}
