//! The earliest contact over many elementary tests, and what the tests themselves do not find: medial surfaces that
//! cross at the start, and the spheres and points that touch.

use super::ToiStatus;
use super::bracket::{Bracket, Limits, bracket, witness};
use super::certificate::lower_bound;
use super::cone_cone::family;
use super::distance::Ball;
use super::distance::crossing;
use super::path::Path;
use super::test_list::{ElementaryTest, OwnedFeatures, for_each_test};
use crate::math::lane::Scalar;

/// The earliest contact over many elementary tests.
#[derive(Clone, Copy, Debug)]
pub struct Earliest<S: Scalar> {
    /// How far and how exact each test is followed.
    pub limits: Limits<S>,
    /// Status found so far.
    pub status: ToiStatus,
    /// Time before which there is no contact in any test so far.
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
    /// The state before the first test.
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
    /// still change the answer. Brackets that were followed beyond the earliest contact come in any
    /// order, but those without a contact last: they count only if they end before it.
    pub fn take(
        &mut self,
        test: ElementaryTest,
        mut b: Bracket<S>,
        start: S,
        primitives: [u32; 2],
    ) -> bool {
        if self.status == ToiStatus::Overlapping {
            return false;
        }
        self.iterations += b.iterations;
        self.tolerance = self.tolerance.max(b.tolerance);
        if !b.slack.is_finite() {
            // Sizes whose squares overflow: nothing can be certified.
            b.lower = start;
            b.contact = false;
            b.separated = false;
        }
        if b.separated || b.lower > self.upper {
            return true;
        }
        self.lower = self.lower.min(b.lower);
        if b.contact {
            let deeper = self.found.is_none_or(|(_, f, _)| {
                b.upper < self.upper
                    || (b.upper == self.upper && b.nearest.distance < f.nearest.distance)
            });
            if deeper {
                self.found = Some((test, b, primitives));
            }
            self.upper = self.upper.min(b.upper);
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
        let Some((test, bracket, primitives)) = self.found else {
            return;
        };
        let first = path(&test);
        let mut best = (test, witness(&first, test.domain, self.lower));
        let [a, b] = spheres.map(OwnedFeatures::whole);
        for_each_test(a, b, |test| {
            let path = path(&test);
            let (old, normal) = &best.1;
            let corners = path.at(self.lower).y;
            let family = family(&corners, path.radius());
            // No sphere pair of this test is nearer than its corners along any one direction.
            if lower_bound(test.domain, &family, *normal) < old.distance {
                let new = witness(&path, test.domain, self.lower);
                if new.0.distance < old.distance {
                    best = (test, new);
                }
            }
            true
        });
        let (test, (nearest, normal)) = best;
        let settled = Bracket {
            lower: self.lower,
            nearest,
            normal,
            ..bracket
        };
        self.found = Some((test, settled, primitives));
    }

    /// Finishes the tests of two primitives: decides whether they cross at the start, and finds the witness. Both
    /// primitives at the start, with the target distance of their paths.
    pub(super) fn conclude<P: Path<S>>(
        &mut self,
        a: &[Ball<S>],
        b: &[Ball<S>],
        target_distance: S,
        path: impl Fn(&ElementaryTest) -> P,
    ) {
        let crossings = [crossing(a, u8::MAX, b), crossing(b, u8::MAX, a)];
        if crossings
            .iter()
            .flatten()
            .any(|c| -c.radius <= target_distance)
        {
            self.overlap_at_start();
        }
        self.settle([a.len(), b.len()], path);
    }

    /// Notes that the bodies overlap at the start.
    pub fn overlap_at_start(&mut self) {
        self.status = ToiStatus::Overlapping;
        self.lower = S::zero();
        self.upper = S::zero();
    }
}
