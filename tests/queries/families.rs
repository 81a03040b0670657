//! The families are what they claim to be: how many of their queries are hits, and of what kind.

use crate::ccd::contact::{distance_at, first_contact};
use crate::ccd::families::Family;
use crate::ccd::motion::{Motion, Paths};
use crate::ccd::rng::Rng;

const QUERIES: usize = 1800;

/// Percentages of queries in contact at the start, and later in the step.
fn shares(family: Family) -> [f64; 2] {
    let mut rng = Rng::new(100 + family as u64);
    let (mut start, mut later) = (0, 0);
    for k in 0..QUERIES {
        let query = family.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
        match first_contact(&Paths::new(&query), 0.0).contact_at {
            None => {}
            Some(0.0) => start += 1,
            Some(_) => later += 1,
        }
    }
    [start, later].map(|count| 100.0 * f64::from(count) / QUERIES as f64)
}

/// Hits and misses both come often enough to matter, and hits mostly begin within the step.
#[test]
fn hits_come_in_the_share_intended() {
    for family in Family::ALL {
        let [start, later] = shares(family);
        let within = |share: f64, low, high| (low..=high).contains(&share);
        let intended = match family {
            // In contact at the start, or never, by the sign of the gap.
            Family::TouchSeparating | Family::Still => within(start, 30.0, 70.0) && later < 5.0,
            Family::TouchApproaching => within(start, 30.0, 70.0) && within(later, 30.0, 70.0),
            Family::Overlapping => start > 99.0,
            Family::TwoContacts => start + later > 99.0 && later > 50.0,
            Family::ZeroStep => within(start, 30.0, 70.0) && later == 0.0,
            _ => within(start + later, 30.0, 75.0) && later > 20.0,
        };
        assert!(
            intended,
            "{family:?}: {start:.1} % at the start, {later:.1} % later"
        );
    }
}

/// A third at least of the queries that meet twice are apart in between.
#[test]
fn queries_made_to_meet_twice_come_apart_in_between() {
    let mut rng = Rng::new(200);
    let (mut twice, mut possible) = (0, 0);
    for k in 0..QUERIES {
        let query = Family::TwoContacts.query([1 + k % 3, 1 + k / 3 % 3], k / 9 % 2 == 1, &mut rng);
        if query.balls.iter().all(|b| b.len() == 1) && query.motion == Motion::Straight {
            continue;
        }
        possible += 1;
        let paths = Paths::new(&query);
        let touching = (0..=128).map(|i| distance_at(&paths, f64::from(i) / 128.0).1 < 0.0);
        let mut states: Vec<bool> = touching.collect();
        states.dedup();
        twice += usize::from(states.iter().filter(|touching| **touching).count() >= 2);
    }
    assert!(3 * twice > possible, "{twice} of {possible}");
}

/// Every number of a query is an `f32`, so that no precision under test rounds it.
#[test]
fn numbers_of_queries_need_no_more_than_f32() {
    let mut rng = Rng::new(300);
    for family in Family::ALL {
        let query = family.query([3, 3], true, &mut rng);
        let mut rounded = query.clone();
        rounded.map(&|x| f64::from(x as f32));
        assert_eq!(query, rounded, "{family:?}");
    }
}
