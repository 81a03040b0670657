//! The certified bracket of the first contact of one elementary test: a time `lower` before which there is no
//! contact, and a time `upper` at which there is one. Source: paper §4.2–4.3 for the two half steps; the
//! certificate is our own.
//!
//! # Loop, at `lower`
//! 1. Nearest spheres at `lower` (paper §4.2, fixed `t`). `S ≤ tolerance`, rounding included:
//!    contact.
//! 2. `upper` falls to the first root of that fixed pair (paper Eq. 4, root `t⁽¹⁾`): a proven
//!    contact, since the pair is on both bodies.
//! 3. `lower` rises by the largest of the proven steps: fixed direction, turning direction, on curved
//!    paths the bound of the fixed direction over the largest speed (`certificate.rs`); a little
//!    less than proven, for rounding. Never by the distance of the pair found: that is above the
//!    least distance by as much as the pair is not the nearest one.
//! 4. `upper − lower ≤ time_tolerance`: contact. `lower` at the end of the step without a root: separated. No
//!    proven step at all: unresolved, since the next round would be the same.
//!
//! # Changes versus the paper
//! - The paper starts at the end of the step and walks back, which can end in a later interval of contact. Here the
//!   search starts at the beginning and never steps over a contact.
//! - The paper's Condition 3 takes a local minimum of the distance for proof of a miss, and loses 2–8 % of hard
//!   hits. Here a miss is proven for all sphere pairs.
//! - The paper's Conditions 1 and 2 (touching at `t0` or `t1`) need no special case.

use super::certificate::{ActiveFace, first_step, fixed_step, lower_bound, turning_step};
use super::path::Path;
use super::test_list::Domain;
use super::{cone_cone, sphere_slab};
use crate::math::approach::first_touch;
use crate::math::lane::{Lane, Mask, Scalar, Vec3};
use crate::math::nearest::{Family, Nearest};
use crate::math::tolerance::{NEVER, SLACK_ULPS, STEP_ULPS, TOLERANCE_PER_SLACK};

/// How far and how exact a bracket is followed.
#[derive(Clone, Copy, Debug)]
pub struct Limits<L> {
    /// Contact distance, a length.
    pub tolerance: L,
    /// Width at which the bracket stops.
    pub time_tolerance: L,
    /// Time at which the search begins.
    pub start: L,
    /// Contacts after this time are of no interest.
    pub horizon: L,
    /// Cap of the iterations.
    pub max_iterations: u32,
}

/// Time bracket of the first contact in one elementary test, as far as it is known.
#[derive(Clone, Copy, Debug)]
pub struct Bracket<L: Lane> {
    /// Time before which there is no contact.
    pub lower: L,
    /// Contact here where `contact`, else the horizon.
    pub upper: L,
    /// Distance within the tolerance at `upper`.
    pub contact: L::Mask,
    /// Proven free up to the horizon.
    pub separated: L::Mask,
    /// Contact distance used: as asked, or twice the slack.
    pub tolerance: L,
    /// Rounding slack.
    pub slack: L,
    /// Signed distance where the nearest spheres were first looked for: at the start of the search,
    /// or later when a first certificate proved it free until then.
    pub start_distance: L,
    /// Nearest spheres at `lower`.
    pub nearest: Nearest<L>,
    /// Certified direction there, from the first body to the second.
    pub normal: Vec3<L>,
    /// Iterations, of the slowest lane.
    pub iterations: u32,
}

impl<S: Scalar> Bracket<S> {
    /// The bracket of a test that something else has proven free until the horizon; it has no nearest spheres.
    pub(crate) fn free(limits: &Limits<S>) -> Self {
        let zero = S::zero();
        Self {
            lower: limits.horizon,
            upper: limits.horizon,
            contact: S::Mask::splat(false),
            separated: S::Mask::splat(true),
            tolerance: limits.tolerance,
            slack: zero,
            start_distance: zero,
            nearest: Nearest {
                alpha: zero,
                beta: zero,
                distance: zero,
                y: Vec3::zero(),
                length: zero,
            },
            normal: Vec3::zero(),
            iterations: 0,
        }
    }

    /// The bracket of a contact that something else has found at a time, at this distance beyond the target.
    pub(crate) fn met(limits: &Limits<S>, time: S, distance: S) -> Self {
        let free = Self::free(limits);
        Self {
            lower: time,
            upper: time,
            contact: S::Mask::splat(true),
            separated: S::Mask::splat(false),
            nearest: Nearest {
                distance,
                ..free.nearest
            },
            ..free
        }
    }
}

#[inline(always)]
fn nearest_spheres<L: Lane>(domain: Domain, f: &Family<L>) -> Nearest<L> {
    match domain {
        Domain::Box => cone_cone::nearest_spheres(f),
        Domain::Triangle => sphere_slab::nearest_spheres(f),
    }
}

/// First time after `s` at which the fixed sphere pair is in contact, moving with `y_rate` (and no
/// acceleration): root `t⁽¹⁾` of paper Eq. (4). [`NEVER`] if there is none, or if the pair is not within
/// `reach` there: a root is a proof of contact.
#[inline(always)]
fn fixed_pair_root<L: Lane>(s: &Nearest<L>, y_rate: Vec3<L>, reach: L) -> L {
    let radius = s.length - s.distance;
    let (root, exists) = first_touch(s.y, y_rate, radius);
    let distance = (s.y + y_rate * root).length() - radius;
    let exists = exists & L::zero().le(root) & distance.le(reach);
    L::select(exists, root, L::splat(NEVER))
}

/// Times that a certified step proves, shortened a little for rounding.
struct Proven<L> {
    /// Free until here.
    end: L,
    /// The next `lower`.
    lower: L,
}

impl<L: Lane> Proven<L> {
    #[inline(always)]
    fn new(lower: L, step: L) -> Self {
        let end = lower + step * L::splat(1.0 - STEP_ULPS * L::EPSILON);
        let next = end * L::splat(1.0 - 0.5 * STEP_ULPS * L::EPSILON);
        Self {
            end,
            lower: next.max(lower),
        }
    }
}

/// A bracket on its way, in every lane.
#[derive(Clone, Copy, Debug)]
pub struct Running<L: Lane> {
    /// Bracket found so far.
    pub bracket: Bracket<L>,
    /// Lanes that are not finished.
    pub active: L::Mask,
    pub(super) fresh: L::Mask,
    pub(super) rooted: L::Mask,
    /// Bound of the corners' speeds; of use on curved paths only.
    speed: L,
}

impl<L: Lane> Running<L> {
    /// A search at its start. On straight paths `first_step` finishes some lanes at once and lets the others begin
    /// later.
    #[inline(always)]
    pub fn new<P: Path<L>>(path: &P, domain: Domain, limits: &Limits<L>) -> Self {
        let slack = path.scale() * L::splat(SLACK_ULPS * L::EPSILON) + L::splat(L::TINY).sqrt();
        let mut running = Self::at(limits, slack);
        if P::CURVED {
            running.speed = path.speed().max(L::splat(L::TINY));
        } else {
            let c = path.at(limits.start);
            let remaining = limits.horizon - limits.start;
            let step = first_step(path, domain, &c, slack, remaining);
            let proven = Proven::new(limits.start, step);
            // Without any step nothing is known of the start, which may be the horizon too.
            let free = L::zero().lt(step) & limits.horizon.le(proven.end);
            running.bracket.separated = free;
            running.bracket.lower = L::select(free, limits.horizon, proven.lower);
            running.active = !free;
        }
        running
    }

    /// The state at the start, when nothing is known yet.
    #[inline(always)]
    pub(super) fn at(limits: &Limits<L>, slack: L) -> Self {
        let none = L::Mask::splat(false);
        let zero = L::zero();
        Self {
            bracket: Bracket {
                lower: limits.start,
                upper: limits.horizon,
                contact: none,
                separated: none,
                tolerance: limits.tolerance.max(slack * L::splat(TOLERANCE_PER_SLACK)),
                slack,
                start_distance: zero,
                nearest: Nearest {
                    alpha: zero,
                    beta: zero,
                    distance: zero,
                    y: Vec3::zero(),
                    length: zero,
                },
                normal: Vec3::zero(),
                iterations: 0,
            },
            active: L::Mask::splat(true),
            fresh: L::Mask::splat(true),
            rooted: none,
            speed: L::one(),
        }
    }

    /// One round of the loop, in the active lanes.
    #[inline(always)]
    pub fn advance<P: Path<L>>(&mut self, path: &P, domain: Domain, limits: &Limits<L>) {
        let zero = L::zero();
        let mut active = self.active;
        let b = &mut self.bracket;
        let (lower, slack) = (b.lower, b.slack);
        let c = path.at(lower);
        let f = cone_cone::family(&c.y, path.radius());
        let s = nearest_spheres(domain, &f);
        b.start_distance = L::select(self.fresh, s.distance, b.start_distance);
        self.fresh = L::Mask::splat(false);
        b.iterations += 1;
        b.nearest = select_nearest(active, s, b.nearest);
        let reach = b.tolerance - slack * L::splat(0.5);
        let touching = active & s.distance.le(reach);
        b.contact = b.contact | touching;
        b.upper = L::select(touching, lower, b.upper);
        let face = ActiveFace::new(domain, &f, &s, &c.rate);
        let n = face.direction(domain, &f);
        b.normal = Vec3::select(active, n, b.normal);
        active = active & !touching;
        self.active = active;
        if !active.any() {
            return;
        }

        let (u_rate, v_rate) = (c.rate[1] - c.rate[0], c.rate[2] - c.rate[0]);
        let y_rate = c.rate[0] + u_rate * s.alpha + v_rate * s.beta;
        if !P::CURVED {
            let root = lower + fixed_pair_root(&s, y_rate, reach);
            let sooner = active & root.le(b.upper);
            b.upper = L::select(sooner, root, b.upper);
            self.rooted = self.rooted | sooner;
        }

        let remaining = b.upper - lower;
        let mut step = fixed_step(path, domain, &c, n, slack, remaining);
        if P::CURVED {
            // On straight paths the fixed direction's step is never shorter.
            let bound = lower_bound(domain, &f, n) - slack;
            step = step.max(bound.max(zero) / self.speed);
        }
        if (active & (lower + step).lt(b.upper)).any() {
            let m = face.turning_rate(&s, n, y_rate);
            step = step.max(turning_step(path, domain, &c, n, m, slack, remaining));
        }
        let proven = Proven::new(lower, step);
        let free = active & !self.rooted & limits.horizon.le(proven.end);
        b.separated = b.separated | free;
        b.lower = L::select(active, proven.lower.min(b.upper), lower);
        b.lower = L::select(free, limits.horizon, b.lower);
        active = active & !free;
        let closed = active & self.rooted & (b.upper - b.lower).le(limits.time_tolerance);
        b.contact = b.contact | closed;
        self.active = active & !closed & lower.lt(b.lower);
    }
}

/// Nearest spheres and certified direction at one time.
#[inline(always)]
pub fn witness<L: Lane, P: Path<L>>(path: &P, domain: Domain, t: L) -> (Nearest<L>, Vec3<L>) {
    let c = path.at(t);
    let f = cone_cone::family(&c.y, path.radius());
    let s = nearest_spheres(domain, &f);
    let normal = ActiveFace::new(domain, &f, &s, &c.rate).direction(domain, &f);
    (s, normal)
}

/// The certified bracket of one elementary test, in every lane.
#[inline(always)]
pub fn bracket<L: Lane, P: Path<L>>(path: &P, domain: Domain, limits: &Limits<L>) -> Bracket<L> {
    // Compiled once for each domain: loops over corners then have a known length.
    match domain {
        Domain::Box => follow(path, Domain::Box, limits),
        Domain::Triangle => follow(path, Domain::Triangle, limits),
    }
}

#[inline(always)]
fn follow<L: Lane, P: Path<L>>(path: &P, domain: Domain, limits: &Limits<L>) -> Bracket<L> {
    let mut running = Running::new(path, domain, limits);
    while running.bracket.iterations < limits.max_iterations && running.active.any() {
        running.advance(path, domain, limits);
    }
    running.bracket
}

#[inline(always)]
fn select_nearest<L: Lane>(mask: L::Mask, yes: Nearest<L>, no: Nearest<L>) -> Nearest<L> {
    Nearest {
        alpha: L::select(mask, yes.alpha, no.alpha),
        beta: L::select(mask, yes.beta, no.beta),
        distance: L::select(mask, yes.distance, no.distance),
        y: Vec3::select(mask, yes.y, no.y),
        length: L::select(mask, yes.length, no.length),
    }
}
