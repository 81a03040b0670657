//! The paper's own method for the first contact of two primitives (§4.2–4.4), kept to compare the certified bracket
//! with. Its answers are not certified: the example `hard_cases` measures how many contacts it misses.
//!
//! Fix `t` and find the nearest sphere pair; fix the pair and find the time it touches (Eq. 4:
//! `t⁽¹⁾`, `t⁽²⁾`, roots of the parabola, or `t⁽³⁾`, its axis); repeat, starting at the end of the
//! step (§4.3, Figure 3). Eq. (3), the square `f` of the distance `S` of Eq. (2), is least where `S ≥ 0` is, and is not
//! formed. One reading of §4.4, where the text leaves a choice:
//! - Condition 1 (touching at `t0`, separating): `t⁽²⁾` or `t⁽³⁾` equals `t0` → no collision.
//! - Condition 2 (leaving contact at `t1`): `t⁽²⁾ = t1` and `t⁽¹⁾ < t1` → go on from `t⁽¹⁾`.
//! - Condition 3 (`t` no longer changes while the distance is positive) → no collision.
//! - The degenerate parabola `P1 = P2 = 0` (relative velocity zero) → decided by the distance.

use super::first_contact::Mover;
use super::path::{LinearPath, Path};
use super::test_list::{Domain, OwnedFeatures, for_each_test};
use super::{AlternatingStart, MovingSphere, Toi, ToiOptions, ToiStatus, cone_cone, sphere_slab};
use crate::math::lane::{Scalar, Vec3};
use crate::math::nearest::Nearest;

/// Roots of Eq. (4) for a fixed sphere pair.
enum Roots<S> {
    /// Case 1: `t⁽¹⁾ < t⁽²⁾`, and the axis `t⁽³⁾`.
    Contacts(S, S, S),
    /// Case 2: nearest at `t⁽³⁾`, never in contact.
    Nearest(S),
    /// `P1 = P2 = 0`: the distance never changes.
    Constant,
}

/// First contact of two primitives by the paper's iteration over all their elementary tests, on straight paths, in
/// `f32`. `lower` and `upper` are both the contact time that it finds, or 1 if it finds none. It may miss contacts.
pub fn alternating(a: &[MovingSphere], b: &[MovingSphere], options: &ToiOptions) -> Toi {
    let good = |s: &[MovingSphere]| (1..=3).contains(&s.len());
    if !good(a) || !good(b) {
        return Toi::bad_input(options);
    }
    let mover = |s: &MovingSphere| -> Mover<f32> {
        let center = Vec3::<f32>::from_vector(s.center - a[0].center);
        (center, Vec3::from_vector(s.displacement), s.radius)
    };
    let sides = [a, b].map(|side| side.iter().map(mover).collect::<Vec<_>>());
    let limits = AlternatingLimits {
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        start: options.alternating_start,
    };
    let (time, iterations) = search(&sides[0], &sides[1], &limits);
    let mut toi = Toi::separated(options);
    toi.iterations = iterations;
    if let Some(t) = time {
        toi.status = ToiStatus::Contact;
        toi.lower = t;
        toi.upper = t;
    }
    toi
}

/// Limits of the iteration, and its start.
#[derive(Clone, Copy, Debug)]
pub struct AlternatingLimits<S> {
    /// Distance at which a sphere pair counts as in contact, a length.
    pub tolerance: S,
    /// Cap of the iterations of one elementary test.
    pub max_iterations: u32,
    /// Time of the first nearest pair.
    pub start: AlternatingStart,
}

/// Earliest contact time by the paper's iteration, and the iterations spent.
pub(crate) fn search<S: Scalar>(
    a: &[Mover<S>],
    b: &[Mover<S>],
    limits: &AlternatingLimits<S>,
) -> (Option<S>, u32) {
    let (mut first, mut iterations) = (None, 0);
    for_each_test(
        OwnedFeatures::whole(a.len()),
        OwnedFeatures::whole(b.len()),
        |test| {
            let path = LinearPath::new(&test, S::zero(), |second, i| {
                if second { b[i as usize] } else { a[i as usize] }
            });
            let (time, count) = iterate(&path, test.domain, limits);
            iterations += count;
            if let Some(t) = time {
                first = Some(first.map_or(t, |f: S| f.min(t)));
            }
            true
        },
    );
    (first, iterations)
}

/// One elementary test: its contact time, if it finds one, and the iterations.
pub fn iterate<S: Scalar>(
    path: &LinearPath<S>,
    domain: Domain,
    limits: &AlternatingLimits<S>,
) -> (Option<S>, u32) {
    let &AlternatingLimits {
        tolerance,
        max_iterations,
        start,
    } = limits;
    let (zero, one) = (S::zero(), S::one());
    let same_time = S::splat(16.0 * S::EPSILON);
    let solve = |t: S| {
        let f = cone_cone::family(&path.at(t).y, path.radius());
        match domain {
            Domain::Box => cone_cone::nearest_spheres(&f),
            Domain::Triangle => sphere_slab::nearest_spheres(&f),
        }
    };
    let mut t = match start {
        AlternatingStart::Start => zero,
        AlternatingStart::End => one,
    };
    let mut pair = solve(t);
    for iteration in 1..=max_iterations {
        let touches = pair.distance <= tolerance;
        let next = match roots(path, &pair) {
            Roots::Constant => return (touches.then_some(zero), iteration),
            Roots::Nearest(axis) => axis.clamp01(),
            Roots::Contacts(t1, _, _) => t1.clamp01(),
        };
        let next_pair = solve(next);
        if next_pair.distance.abs() <= tolerance {
            match roots(path, &next_pair) {
                // Condition 1.
                Roots::Contacts(_, t2, t3)
                    if next <= same_time && (t2.abs() <= same_time || t3.abs() <= same_time) =>
                {
                    return (None, iteration);
                }
                Roots::Nearest(t3) if next <= same_time && t3.abs() <= same_time => {
                    return (None, iteration);
                }
                // Condition 2.
                Roots::Contacts(t1, t2, _)
                    if (t2 - one).abs() <= same_time
                        && one - same_time <= next
                        && t1 < one - same_time =>
                {
                    (t, pair) = (next, next_pair);
                    continue;
                }
                _ => return (Some(next), iteration),
            }
        }
        let overlapping = next_pair.distance < zero;
        let settled = (next - t).abs() <= same_time;
        if overlapping && (next <= zero || settled && iteration > 1) {
            return (Some(next), iteration);
        }
        // Condition 3; at the first iteration t1 itself may be the answer's start.
        if settled && !overlapping {
            return (None, iteration);
        }
        (t, pair) = (next, next_pair);
    }
    ((pair.distance <= tolerance).then_some(t), max_iterations)
}

/// Solves Eq. (4) for a fixed pair: `P1 t² + P2 t + P3 = R²`.
fn roots<S: Scalar>(path: &LinearPath<S>, pair: &Nearest<S>) -> Roots<S> {
    let along = |v: &[Vec3<S>; 4]| v[0] + (v[1] - v[0]) * pair.alpha + (v[2] - v[0]) * pair.beta;
    let r = path.radius;
    let radius = r[0] + (r[1] - r[0]) * pair.alpha + (r[2] - r[0]) * pair.beta;
    let (y, rate) = (along(&path.start), along(&path.rate));
    let two = S::splat(2.0);
    let (p1, p2, p3) = (
        rate.length_sq(),
        two * y.dot(rate),
        y.length_sq() - radius * radius,
    );
    if p1 <= S::splat(S::TINY) {
        return Roots::Constant;
    }
    let axis = -(p2 / (two * p1));
    let discriminant = p2 * p2 - S::splat(4.0) * p1 * p3;
    if discriminant < S::zero() {
        return Roots::Nearest(axis);
    }
    let root = discriminant.sqrt();
    let q = S::select(p2 < S::zero(), root - p2, -(p2 + root)) * S::splat(0.5);
    let other = S::select(
        q == S::zero(),
        S::zero(),
        p3 / S::select(q == S::zero(), S::one(), q),
    );
    let (x, z) = (q / p1, other);
    Roots::Contacts(x.min(z), x.max(z), axis)
}
