//! The guarantee of the elementary queries, family by family, against the oracle.
//!
//! In both precisions, on straight paths and in rigid motion, for every pair of spheres, cones and
//! slabs: nothing missed, nothing late, nothing false, brackets as narrow as asked.

use crate::ccd::families::Family;
use crate::ccd::judge::{Tally, Truth};
use crate::ccd::motion::Query;
use crate::ccd::rng::Rng;
use crate::ccd::subject::Subject;
use rapier3d_medial::math::Real;

/// Queries per family; a multiple of 9 pairs × 2 motions.
const QUERIES: usize = 10_800;

/// Asks for the first time at the signed distance `target` and judges; panics on a broken
/// guarantee, with the query.
fn judge(
    subject: Subject,
    family: Family,
    query: &Query,
    target: Real,
    truth: &Truth,
    tally: &mut Tally,
) {
    let mut options = subject.options(family.size());
    options.target_distance = target;
    let Some(answer) = subject.answer(query, &options) else {
        return;
    };
    let verdict = truth.judge(&answer, options.time_tolerance.into());
    tally.add(truth, &answer, &verdict, subject.late_by());
    let guilty = verdict.missed
        || verdict.late > 0.0
        || verdict.false_hit
        || verdict.misnamed
        || verdict.wide;
    assert!(
        subject == Subject::Paper || !guilty,
        "{family:?} {subject:?} {target}\n{verdict:?}\n{answer:?}\n{:?}\n{query:?}",
        truth.contact
    );
}

/// The same query with the bodies exchanged and their spheres in reverse order.
fn permuted(query: &Query) -> Query {
    let mut query = query.clone();
    query.balls.reverse();
    query.balls.iter_mut().for_each(|balls| balls.reverse());
    if let crate::ccd::motion::Motion::Rigid(motions, _) = &mut query.motion {
        motions.reverse();
    }
    query
}

/// Returns the tallies of all subjects.
fn guarantee(family: Family) -> [Tally; 3] {
    let mut rng = Rng::new(1000 + family as u64);
    // The lanes are judged in batches, in `lanes.rs`.
    let subjects = [Subject::Single, Subject::Double, Subject::Paper];
    let mut tallies: [Tally; 3] = Default::default();
    for k in 0..QUERIES {
        let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
        let truth = Truth::new(&query, 0.0);
        for (subject, tally) in subjects.into_iter().zip(&mut tallies) {
            judge(subject, family, &query, 0.0, &truth, tally);
        }
        if k % 10 == 0 {
            let query = permuted(&query);
            let truth = Truth::new(&query, 0.0);
            for subject in [Subject::Single, Subject::Double] {
                judge(subject, family, &query, 0.0, &truth, &mut Tally::default());
            }
        }
    }
    let [single, double, _] = &mut tallies;
    for (subject, tally) in [
        (Subject::Single, &mut *single),
        (Subject::Double, &mut *double),
    ] {
        // `lower` stops where the tolerance is reached, or where the bracket is narrow enough.
        let width = subject.options(family.size()).time_tolerance;
        assert!(
            tally.early()[1] <= width && tally.width()[1] <= width,
            "{family:?} {tally:?}"
        );
        // Bodies that near each other slowly are within the tolerance for long before they touch.
        let is_slow = matches!(family, Family::Grazing | Family::NearEqual);
        assert!(is_slow || tally.before()[1] <= 1.0e-3, "{family:?}");
    }
    // Near-equal bodies that turn together, nearly touching: each one's own turning bounds the step,
    // and steps get short. Measured over 9,000 queries: 3 in single, 43 in double precision, at a
    // tolerance of 1e-9; in all other families 0 in single and at most 2 in double.
    let [per_single, per_double] = match family {
        Family::NearEqual => [1000, 100],
        _ => [usize::MAX, 1000],
    };
    assert!(
        single.unresolved <= QUERIES / per_single,
        "{family:?} single: {}",
        single.unresolved
    );
    assert!(
        double.unresolved <= QUERIES / per_double,
        "{family:?} double: {}",
        double.unresolved
    );
    tallies
}

macro_rules! families {
    ($($name:ident: $family:ident,)*) => {
        $(#[test]
        fn $name() {
            guarantee(Family::$family);
        })*
    };
}

families! {
    translation: Translation,
    small_rotation: SmallRotation,
    touch_approaching: TouchApproaching,
    overlapping: Overlapping,
    disparity: Disparity,
    parallel: Parallel,
    coincident: Coincident,
    contained: Contained,
    zero_size: ZeroSize,
    tiny: Tiny,
    huge: Huge,
    far_away: FarAway,
    still: Still,
    fast: Fast,
    near_equal: NearEqual,
    zero_step: ZeroStep,
}

/// The families in which the paper's iteration is known to miss hits, or to report a later
/// contact: the comparison is real. Here the certified query does neither.
#[test]
fn certified_query_finds_contacts_that_the_paper_misses() {
    let mut paper = Tally::default();
    for family in [
        Family::LargeRotation,
        Family::Grazing,
        Family::TouchSeparating,
        Family::Thin,
        Family::TwoContacts,
    ] {
        let [_, _, tally] = guarantee(family);
        assert!(tally.missed > 0, "{family:?}");
        paper.merge(tally);
    }
    assert!(paper.late > 0);
    // It is no straw man: nine of ten hits are found.
    assert!(
        10 * paper.missed < paper.hits,
        "{} of {}",
        paper.missed,
        paper.hits
    );
}

/// The guarantee holds for other distances than 0: kept apart, or let sink in, as deep as the
/// thinnest ends are thick.
#[test]
fn the_guarantee_holds_at_other_target_distances() {
    let families = [
        Family::LargeRotation,
        Family::Overlapping,
        Family::Parallel,
        Family::TwoContacts,
    ];
    for target in [0.05, -0.01, -0.2] {
        for family in families {
            let mut rng = Rng::new(2000 + family as u64);
            for k in 0..QUERIES / 3 {
                let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
                // The target is never deeper than the thinnest place of both.
                let thinnest = |body: usize| {
                    let radii = query.balls[body].iter().map(|ball| ball.radius);
                    radii.fold(f64::MAX, f64::min)
                };
                let raised = f64::from(target).max(-thinnest(0) - thinnest(1));
                let truth = Truth::new(&query, raised);
                for subject in [Subject::Single, Subject::Double] {
                    judge(
                        subject,
                        family,
                        &query,
                        target,
                        &truth,
                        &mut Tally::default(),
                    );
                }
            }
        }
    }
}
