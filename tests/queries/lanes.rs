//! Eight lanes at once give the bits of the scalar kernel, on either path, whatever the others in
//! their group do; and whole queries in lanes keep the guarantee.

use crate::ccd::families::Family;
use crate::ccd::judge::{Tally, Truth};
use crate::ccd::rng::Rng;
use crate::ccd::subject::Subject;
use rapier3d_medial::elementary::bracket::{Bracket, Limits, bracket};
use rapier3d_medial::elementary::many::{Lanes, brackets, first_contacts};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, ElementaryTest};
use rapier3d_medial::elementary::{MovingSphere, ToiOptions, ToiStatus, first_contact};
use rapier3d_medial::math::lane::Vec3;
use rapier3d_medial::math::{Real, Vector};

/// One test of each straight query of the family that has spheres enough for it.
fn paths(family: Family, domain: Domain) -> Vec<LinearPath<f32>> {
    let mut rng = Rng::new(4000 + family as u64);
    let (counts, test) = match domain {
        Domain::Box => ([2, 2], ElementaryTest::cone_cone([0, 1], [0, 1])),
        Domain::Triangle => ([1, 3], ElementaryTest::sphere_slab(0)),
    };
    (0..203)
        .map(|_| {
            let query = family.query(counts, false, &mut rng);
            LinearPath::new(&test, 0.0, |second, i| {
                let ball = &query.balls[usize::from(second)][usize::from(i)];
                let [c, d] = [ball.center, ball.displacement]
                    .map(|v| Vec3::new(v.x as f32, v.y as f32, v.z as f32));
                (c, d, ball.radius as f32)
            })
        })
        .collect()
}

fn bits(b: &Bracket<f32>) -> (u32, u32, bool, bool, u32, u32) {
    let Bracket { lower, upper, .. } = *b;
    (
        lower.to_bits(),
        upper.to_bits(),
        b.contact,
        b.separated,
        b.nearest.distance.to_bits(),
        b.iterations,
    )
}

#[test]
fn lanes_give_the_bits_of_the_scalar_kernel() {
    let limits = Limits {
        tolerance: 1.0e-5,
        time_tolerance: 1.0e-6,
        start: 0.0,
        horizon: 1.0,
        max_iterations: 64,
    };
    let (mut contacts, mut separated) = (0, 0);
    for family in Family::ALL {
        for domain in [Domain::Box, Domain::Triangle] {
            let paths = paths(family, domain);
            let alone: Vec<_> = paths.iter().map(|p| bracket(p, domain, &limits)).collect();
            contacts += alone.iter().filter(|b| b.contact).count();
            separated += alone.iter().filter(|b| b.separated).count();
            for lanes in [Lanes::Baseline, Lanes::Fastest] {
                let together = brackets(&paths, domain, &limits, lanes);
                assert_eq!(together.len(), alone.len());
                for (k, (a, b)) in alone.iter().zip(&together).enumerate() {
                    assert_eq!(bits(a), bits(b), "{family:?} {domain:?} {lanes:?} {k}");
                }
            }
        }
    }
    assert!(
        contacts > 2000 && separated > 2000,
        "{contacts} {separated}"
    );
    assert!(brackets(&[], Domain::Box, &limits, Lanes::Fastest).is_empty());
}

/// Many queries at once, judged by the oracle like the others.
#[test]
fn many_keep_the_guarantee() {
    for family in Family::ALL {
        let mut rng = Rng::new(5000 + family as u64);
        let queries: Vec<_> = (0..900)
            .map(|k| family.query([1 + k % 3, 1 + k / 3 % 3], false, &mut rng))
            .collect();
        let options = Subject::Lanes.options(family.size());
        let answers = Subject::Lanes.answers(&queries, &options);
        let mut tally = Tally::default();
        for (query, answer) in queries.iter().zip(answers) {
            let (truth, answer) = (Truth::new(query, 0.0), answer.unwrap());
            let verdict = truth.judge(&answer, options.time_tolerance.into());
            tally.add(&truth, &answer, &verdict, 0.0);
        }
        let guilty = [
            tally.missed,
            tally.late,
            tally.false_hits,
            tally.misnamed,
            tally.wide,
        ];
        assert_eq!(guilty, [0; 5], "{family:?}");
        assert_eq!((tally.queries, tally.unresolved), (900, 0), "{family:?}");
    }
}

/// Refused input is told for its own pair only.
#[test]
fn bad_pairs_leave_the_others_alone() {
    let sphere = |x, radius| MovingSphere {
        center: Vector::new(x, 0.0, 0.0),
        radius,
        displacement: Vector::new(-x, 0.0, 0.0),
    };
    let (still, flying) = ([sphere(0.0, 1.0)], [sphere(4.0, 1.0)]);
    let (negative, nan) = ([sphere(4.0, -1.0)], [sphere(Real::NAN, 1.0)]);
    let pairs = [
        [&still[..], &flying[..]],
        [&still, &negative],
        [&nan, &flying],
        [&still, &[]],
        [&flying, &still],
    ];
    let options = ToiOptions::default();
    let answers = first_contacts(&pairs, &options, Lanes::Fastest);
    for (k, (answer, [a, b])) in answers.iter().zip(pairs).enumerate() {
        let alone = first_contact(a, b, &options);
        assert_eq!(*answer, alone, "{k}");
        let bad = (1..=3).contains(&k);
        let lower = if bad { 0.0 } else { 0.5 };
        assert_eq!(answer.status == ToiStatus::Unresolved, bad, "{k}");
        assert!((answer.lower - lower).abs() < 1.0e-4, "{k}: {answer:?}");
    }
    assert!(first_contacts(&[], &options, Lanes::Fastest).is_empty());
}
