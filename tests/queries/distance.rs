//! The signed distance at a fixed time, in both precisions, against the oracle.

use crate::ccd::contact::distance_at;
use crate::ccd::families::Family;
use crate::ccd::motion::{Ball, Paths};
use crate::ccd::rng::Rng;
use rapier3d_medial::elementary::distance::{self, signed_distance};
use rapier3d_medial::elementary::test_list::ElementaryTest;
use rapier3d_medial::math::lane::{Scalar, Vec3};
use rapier3d_medial::math::tolerance::SLACK_ULPS;

fn convert<S: Scalar>(balls: &[Ball]) -> Vec<distance::Ball<S>> {
    let convert = |ball: &Ball| {
        let [x, y, z] = [ball.center.x, ball.center.y, ball.center.z].map(S::splat);
        (Vec3::new(x, y, z), S::splat(ball.radius))
    };
    balls.iter().map(convert).collect()
}

/// Largest error, in the units of the slack that queries allow for: `EPSILON` times the largest
/// distance between two centres plus the largest radius sum.
fn worst<S: Scalar>(family: Family) -> f64 {
    let mut rng = Rng::new(500 + family as u64);
    let mut worst: f64 = 0.0;
    for k in 0..1800 {
        let query = family.query([1 + k % 3, 1 + k / 3 % 3], false, &mut rng);
        let paths = Paths::new(&query);
        let [a, b] = query.balls.each_ref().map(|balls| convert::<S>(balls));
        let found = signed_distance(&a, &b).to_f64();
        let (lower, upper) = distance_at(&paths, 0.0);
        let error = (found - upper).max(lower - found);
        worst = worst.max(error / (S::EPSILON * paths.at(0.0).scale()));
    }
    worst
}

/// Every query trusts the distance to the slack.
#[test]
fn errors_stay_below_the_slack() {
    for family in Family::ALL {
        let (single, double) = (worst::<f32>(family), worst::<f64>(family));
        assert!(
            single < SLACK_ULPS,
            "{family:?}: {single} in single precision"
        );
        assert!(
            double < SLACK_ULPS,
            "{family:?}: {double} in double precision"
        );
    }
}

/// Cones called further apart than a margin are, by the oracle; and most of those that are, are called so.
#[test]
fn cones_called_beyond_a_margin_are() {
    for family in Family::ALL {
        let mut rng = Rng::new(900 + family as u64);
        let (mut called, mut clear) = (0, 0);
        for k in 0..2000 {
            let query = family.query([1 + k % 2, 1 + k / 2 % 2], false, &mut rng);
            let paths = Paths::new(&query);
            let [a, b] = query.balls.each_ref().map(|balls| convert::<f64>(balls));
            let (lower, upper) = distance_at(&paths, 0.0);
            let scale = paths.at(0.0).scale();
            let ends = [a.len(), b.len()].map(|n| [0, n as u8 - 1]);
            let f = distance::family(&ElementaryTest::cone_cone(ends[0], ends[1]), &a, &b);
            // Just below, just above, and well below what is between them.
            for share in [1.0 - 1.0e-9, 1.0 + 1.0e-9, 0.5] {
                let margin = lower * share;
                let beyond = distance::is_beyond(&f, margin);
                assert!(
                    !beyond || upper > margin,
                    "{family:?} {k}: {upper} {margin}"
                );
                if lower - margin > 0.1 * scale {
                    clear += 1;
                    called += usize::from(beyond);
                }
            }
        }
        assert!(10 * called >= 9 * clear, "{family:?}: {called} of {clear}");
    }
}
