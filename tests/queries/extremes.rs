//! The families made to break a certificate, against the oracle: at the default tolerances and at 0, in
//! `f32`, in lanes of it and in `f64`, on straight paths and in rigid motion. Nothing missed, nothing late,
//! nothing false. `MEDIAL_EXTREMES` sets the queries of each family; the example `hard_cases` takes a
//! million.

use crate::ccd::families::Family;
use crate::ccd::judge::{Tally, Truth};
use crate::ccd::rng::Rng;
use crate::ccd::subject::Subject;

/// A multiple of 9 pairs × 2 motions.
fn queries() -> usize {
    let asked = std::env::var("MEDIAL_EXTREMES").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(1800)
}

/// Percent of the answers that may stay unresolved, with a safe lower bound: slivers of slabs and rods
/// nearly parallel, at a tolerance of 0. Measured 3 in `f32`, 1 in `f64`.
const UNRESOLVED: usize = 5;

fn guarantee(family: Family) {
    let mut rng = Rng::new(6000 + family as u64);
    let subjects = Subject::CERTIFIED;
    let mut tallies: [Tally; Subject::CERTIFIED.len()] = Default::default();
    for k in 0..queries() {
        let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
        let truth = Truth::new(&query, 0.0);
        for (subject, tally) in subjects.into_iter().zip(&mut tallies) {
            let mut options = subject.options(family.size());
            if k % 4 >= 2 {
                options.tolerance = 0.0;
            }
            let Some(answer) = subject.answer(&query, &options) else {
                continue;
            };
            let verdict = truth.convict(&answer, options.time_tolerance.into());
            tally.add(&truth, &answer, &verdict, 0.0);
            let guilty = verdict.missed
                || verdict.late > 0.0
                || verdict.false_hit
                || verdict.misnamed
                || verdict.wide;
            assert!(
                !guilty,
                "{family:?} {subject:?}\n{verdict:?}\n{answer:?}\n{:?}\n{query:?}",
                truth.contact
            );
        }
    }
    for (subject, tally) in subjects.into_iter().zip(&tallies) {
        let Tally {
            queries,
            hits,
            unresolved,
            ..
        } = tally;
        println!("{family:?} {subject:?}: {queries}, {hits} in contact, {unresolved} unresolved");
        assert!(
            (3 * queries..=7 * queries).contains(&(10 * hits)),
            "{hits} of {queries}"
        );
        assert!(100 * unresolved <= UNRESOLVED * queries, "{unresolved}");
    }
}

macro_rules! families {
    ($($name:ident: $family:ident,)*) => {
        $(#[test]
        fn $name() {
            guarantee(Family::$family);
        })*
        /// None is left out.
        #[test]
        fn every_extreme_is_judged() {
            assert_eq!([$(Family::$family),*], Family::EXTREME);
        }
    };
}

families! {
    near_parallel: NearParallel,
    needle: Needle,
    wire: Wire,
    far_origin: FarOrigin,
    bullet: Bullet,
    coaxial: Coaxial,
    long: Long,
}
