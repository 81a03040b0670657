//! First contact of one pair of primitives: the earliest over its elementary tests, on straight
//! paths (paper Eqs. 1 to 3) or in exact rigid motion.

use super::bracket::{Bracket, Limits, bracket, witness};
use super::distance::{crossing, thinnest};
use super::path::{LinearPath, Path, RigidPath};
use super::test_list::{Domain, ElementaryTest, Share, for_each_test};
use super::{MovingSphere, Toi, ToiOptions, ToiStatus};
use crate::math::Real;
use crate::math::lane::{Scalar, Vec3};
use crate::math::motion::RigidMotion;
use crate::math::nearest::Nearest;
use crate::medial::MedialSphere;
use parry3d::query::NonlinearRigidMotion;

/// A sphere of a test, in a common frame: centre, displacement over the step, radius.
pub(crate) type Mover<S> = (Vec3<S>, Vec3<S>, S);

/// The earliest contact over many elementary tests.
#[derive(Clone, Copy, Debug)]
pub struct Earliest<S: Scalar> {
    /// How far and how exact each test is followed.
    pub limits: Limits<S>,
    /// What is known so far.
    pub status: ToiStatus,
    /// No contact before, over all tests so far.
    pub lower: S,
    /// Contact here; the horizon when none was found.
    pub upper: S,
    /// Largest contact distance that any test used.
    pub tolerance: S,
    /// The test that bounds `upper` (or that stayed unresolved), its bracket, and the primitives.
    pub found: Option<(ElementaryTest, Bracket<S>, [u32; 2])>,
    /// Elementary tests executed.
    pub tests: u32,
    /// Iterations over all tests.
    pub iterations: u32,
}

impl<S: Scalar> Earliest<S> {
    /// Nothing tested yet.
    pub fn new(limits: Limits<S>) -> Self {
        Self {
            limits,
            status: ToiStatus::Separated,
            lower: limits.horizon,
            upper: limits.horizon,
            tolerance: limits.tolerance,
            found: None,
            tests: 0,
            iterations: 0,
        }
    }

    /// Runs one more test, up to the earliest contact known. Returns whether another test may
    /// still change the answer.
    pub fn test<P: Path<S>>(
        &mut self,
        test: ElementaryTest,
        path: &P,
        primitives: [u32; 2],
    ) -> bool {
        let limits = Limits {
            horizon: self.upper.min(self.limits.horizon),
            ..self.limits
        };
        let b = bracket(path, test.domain, &limits);
        self.tests += 1;
        self.take(test, b, limits.start, primitives)
    }

    /// Takes over what the bracket of a test found from `start` on. Returns whether another test may
    /// still change the answer.
    pub fn take(
        &mut self,
        test: ElementaryTest,
        mut b: Bracket<S>,
        start: S,
        primitives: [u32; 2],
    ) -> bool {
        self.iterations += b.iterations;
        self.tolerance = self.tolerance.max(b.tolerance);
        if !b.slack.is_finite() {
            // Sizes whose squares overflow: nothing can be certified.
            b.lower = start;
            b.contact = false;
            b.separated = false;
        }
        if b.separated {
            return true;
        }
        self.lower = self.lower.min(b.lower);
        if b.contact {
            let deeper = self.found.is_none_or(|(_, f, _)| {
                b.upper < self.upper || b.nearest.distance < f.nearest.distance
            });
            if deeper {
                self.found = Some((test, b, primitives));
            }
            self.upper = b.upper;
            if self.status != ToiStatus::Unresolved {
                self.status = ToiStatus::Contact;
            }
            if start == S::zero() && b.start_distance < -b.slack {
                self.overlap_at_start();
            }
        } else {
            self.status = ToiStatus::Unresolved;
            self.found = self.found.or(Some((test, b, primitives)));
        }
        // After a contact at the start another test may still find that the bodies overlap.
        self.status != ToiStatus::Overlapping
    }

    /// Takes the nearest of all sphere pairs of the reported primitives at `lower` for the witness. A
    /// test that is proven free until then may still be nearer than the one that was found.
    pub fn settle<P: Path<S>>(&mut self, spheres: [usize; 2], path: impl Fn(&ElementaryTest) -> P) {
        let Some((_, bracket, primitives)) = self.found else {
            return;
        };
        let mut best: Option<(ElementaryTest, Bracket<S>)> = None;
        let [a, b] = spheres.map(Share::whole);
        for_each_test(a, b, |test| {
            let (nearest, normal) = witness(&path(&test), test.domain, self.lower);
            if best.is_none_or(|(_, old)| nearest.distance < old.nearest.distance) {
                let mut settled: Bracket<S> = bracket;
                settled.lower = self.lower;
                settled.nearest = nearest;
                settled.normal = normal;
                best = Some((test, settled));
            }
            true
        });
        self.found = best.map(|(test, bracket)| (test, bracket, primitives));
    }

    /// Notes that the bodies overlap at the start.
    pub fn overlap_at_start(&mut self) {
        self.status = ToiStatus::Overlapping;
        self.lower = S::zero();
        self.upper = S::zero();
    }
}

/// First contact of two primitives whose spheres are in a common frame at the start. `path` gives
/// the motion of a test's corners.
fn primitives_first_contact<S: Scalar, P: Path<S>>(
    a: &[(Vec3<S>, S)],
    b: &[(Vec3<S>, S)],
    target_distance: S,
    limits: Limits<S>,
    path: impl Fn(&ElementaryTest, S) -> P,
) -> Earliest<S> {
    let target_distance = target_distance.max(-thinnest(a, b));
    let path = |test: &ElementaryTest| path(test, target_distance);
    let mut earliest = Earliest::new(limits);
    for_each_test(Share::whole(a.len()), Share::whole(b.len()), |test| {
        earliest.test(test, &path(&test), [0, 0])
    });
    let crossings = [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)];
    if crossings
        .iter()
        .flatten()
        .any(|c| -c.radius <= target_distance)
    {
        earliest.overlap_at_start();
    }
    earliest.settle([a.len(), b.len()], path);
    earliest
}

/// First contact of two primitives on straight paths, in the precision of `S`.
pub(crate) fn linear<S: Scalar>(
    a: &[Mover<S>],
    b: &[Mover<S>],
    target_distance: S,
    limits: Limits<S>,
) -> Earliest<S> {
    let rest = |m: &[Mover<S>]| -> Vec<_> { m.iter().map(|m| (m.0, m.2)).collect() };
    primitives_first_contact(
        &rest(a),
        &rest(b),
        target_distance,
        limits,
        |test, target| {
            LinearPath::new(test, target, |second, i| {
                if second { b[i as usize] } else { a[i as usize] }
            })
        },
    )
}

/// First contact of two primitives in exact rigid motion, in the precision of `S`.
pub(crate) fn rigid<S: Scalar>(
    a: &[(Vec3<S>, S)],
    b: &[(Vec3<S>, S)],
    motions: &[RigidMotion<S>; 2],
    target_distance: S,
    limits: Limits<S>,
) -> Earliest<S> {
    let start = |side: usize, s: &[(Vec3<S>, S)]| -> Vec<_> {
        let turned = motions[side].sin_cos(S::zero());
        s.iter()
            .map(|s| (motions[side].point(s.0).at(S::zero(), turned).position, s.1))
            .collect()
    };
    primitives_first_contact(
        &start(0, a),
        &start(1, b),
        target_distance,
        limits,
        |test, target| {
            RigidPath::new(test, motions, target, |second, i| {
                if second { b[i as usize] } else { a[i as usize] }
            })
        },
    )
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

/// First contact of two primitives of 1, 2 or 3 interpolated spheres each, on straight paths
/// (paper Eqs. 1 to 3), in `f32`. Positions in world space, in the user's unit; times as fractions
/// of the step. Cost: 1 to 15 elementary tests of 2 iterations each, typically.
///
/// The guarantee is the module's ([`crate::elementary`]). Wrong counts, values that are not finite
/// or negative radii give [`ToiStatus::Unresolved`] with `lower = 0`.
pub fn first_contact(a: &[MovingSphere], b: &[MovingSphere], options: &ToiOptions) -> Toi {
    let checks = a.iter().chain(b).map(|s| {
        let finite = s.center.is_finite() && s.displacement.is_finite();
        (finite, s.radius)
    });
    if !valid([a.len(), b.len()], options, checks) {
        return Toi::bad_input(options);
    }
    // Positions relative to the first sphere: large coordinates then cost no digits.
    let origin = Vec3::<f32>::from_vector(a[0].center);
    let mover = |s: &MovingSphere| -> Mover<f32> {
        (
            Vec3::from_vector(s.center) - origin,
            Vec3::from_vector(s.displacement),
            s.radius,
        )
    };
    let movers = [a, b].map(|side| side.iter().map(mover).collect::<Vec<_>>());
    let limits = options_limits::<f32>(options);
    let earliest = linear(&movers[0], &movers[1], options.target_distance, limits);
    let pose = |side: usize, i: u8, t: f32| {
        let s = [a, b][side][i as usize];
        MedialSphere::new(s.center + s.displacement * t, s.radius)
    };
    to_toi(&earliest, options, pose)
}

/// First contact of two primitives in exact rigid motion over `seconds`, in `f32`: spheres in their
/// body's frame, motions in world space (velocities per second), rotations of any angle.
/// Guarantee, bad input and units as in [`first_contact`]; about 1.6 times its cost.
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

/// Reports a result in world space; `pose` gives sphere `i` of a side at a time.
pub(crate) fn to_toi<S: Scalar>(
    earliest: &Earliest<S>,
    options: &ToiOptions,
    pose: impl Fn(usize, u8, Real) -> MedialSphere,
) -> Toi {
    // Down for the lower bound, so that rounding to f32 keeps the promise.
    let exact = earliest.lower.to_f64();
    let mut lower = exact as Real;
    if lower as f64 > exact {
        lower = lower.next_down();
    }
    let mut toi = Toi {
        status: earliest.status,
        lower,
        upper: earliest.upper.to_f64() as Real,
        tolerance: earliest.tolerance.to_f64() as Real,
        iterations: earliest.iterations,
        ..Toi::separated(options)
    };
    if let Some((test, b, primitives)) = &earliest.found {
        let t = b.lower.to_f64() as Real;
        let weights = corner_weights(test.domain, &b.nearest);
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
fn corner_weights<S: Scalar>(domain: Domain, s: &Nearest<S>) -> [Real; 4] {
    let (x, y) = (s.alpha.to_f64(), s.beta.to_f64());
    let w = match domain {
        Domain::Box => [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y],
        Domain::Triangle => [1.0 - x - y, x, y, 0.0],
    };
    w.map(|w| w as Real)
}
